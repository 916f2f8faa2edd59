//! Errors of a rest shape.

use bevy_math::{UVec2, Vec2, Vec3};
use bevy_reflect::prelude::*;
use thiserror::Error;

/// A rest shape is wrong: the field, its value, and what is allowed.
#[derive(Clone, Debug, PartialEq, Error, Reflect)]
#[non_exhaustive]
pub enum ClothShapeError {
    /// A grid's size is zero, negative or not finite.
    #[error("Cloth grid size is {value} m, must be positive and finite in both directions")]
    Size {
        /// The size \[m\].
        value: Vec2,
    },
    /// A grid has too few or too many particles.
    #[error(
        "Cloth grid resolution is {value} particles, must be at least 2 × 2 and at most 16,777,216 in all"
    )]
    Resolution {
        /// Columns and rows.
        value: UVec2,
    },
    /// A grid's origin is not finite.
    #[error("Cloth grid origin is {value}, must be finite")]
    Origin {
        /// The fractions of width and height.
        value: Vec2,
    },
    /// A mesh has no triangle (left).
    #[error(
        "Cloth mesh has {vertices} vertices and {triangles} usable triangles, must have at least one triangle"
    )]
    NoTriangles {
        /// The number of vertices.
        vertices: usize,
        /// The number of triangles that are not degenerate.
        triangles: usize,
    },
    /// The distance at which vertices are welded is negative or not finite.
    #[error("Cloth mesh weld_distance is {value}, must be at least 0 and finite [m]")]
    WeldDistance {
        /// The distance \[m\].
        value: f32,
    },
    /// There are texture coordinates, but not one for each vertex.
    #[error("Cloth mesh has {value} uvs, must be none or one for each of {vertices} vertices")]
    UvCount {
        /// The number of texture coordinates.
        value: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// The number of indices is not a multiple of three.
    #[error("Cloth mesh has {value} indices, must be a multiple of 3")]
    IndexCount {
        /// The number of indices.
        value: usize,
    },
    /// An index names no vertex.
    #[error(
        "Cloth mesh indices[{at}] is {value}, must be below the number of vertices, {vertices}"
    )]
    IndexOutOfRange {
        /// Position in the index list.
        at: usize,
        /// The index.
        value: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A rest position is not finite.
    #[error("Cloth mesh positions[{vertex}] is {value}, must be finite")]
    NonFinitePosition {
        /// The vertex.
        vertex: usize,
        /// Its position.
        value: Vec3,
    },
    /// A rest position, scaled, is too far away to count in f32.
    #[error(
        "Cloth mesh positions[{vertex}] is {value} m, must be within 1,000,000 m of the origin in each direction"
    )]
    PositionTooFar {
        /// The vertex.
        vertex: usize,
        /// Its position \[m\].
        value: Vec3,
    },
    /// Triangles without area were left out; the cloth works without them.
    #[error(
        "Cloth mesh has {count} triangles without area, the first is triangle {first}; triangles must have three distinct corners that are not in a line: dropped"
    )]
    DegenerateTriangles {
        /// Number of triangles.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// Triangles with the same three corners were left out; the cloth works without them.
    #[error(
        "Cloth mesh has {count} triangles twice, the first is triangle {first}; each must be there once: dropped"
    )]
    DuplicateTriangles {
        /// Number of triangles.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// The shape is scaled to nothing.
    #[error("Cloth scale is {value}, must be finite and not zero in any direction")]
    Scale {
        /// The scale.
        value: Vec3,
    },
}
