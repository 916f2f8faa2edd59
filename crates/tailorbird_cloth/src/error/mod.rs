//! Errors of users, as typed errors that name the entity, the field, the value and the allowed range.
//!
#![doc = include_str!("README.md")]

mod status;

use std::fmt::Display;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use thiserror::Error;

pub use status::{ClothErrorSource, ClothStatus, ClothStatusOf, ClothStatusOfItem};
pub use tailorbird_solver::error::ClothShapeError;

/// Something is wrong with a cloth or a collider.
///
/// Logged once, kept in [`ClothStatus`] while it lasts, and triggered for observers:
///
/// ```
/// # use bevy_ecs::prelude::*;
/// # use tailorbird_cloth::prelude::*;
/// fn on_error(error: On<ClothError>) {
///     eprintln!("{} is wrong: {}", error.entity, error.kind);
/// }
/// ```
#[derive(EntityEvent, Clone, Debug, PartialEq, Error, Reflect)]
#[error("{entity}: {kind}")]
pub struct ClothError {
    /// The cloth or collider that is wrong.
    pub entity: Entity,
    /// Kind of the error.
    pub kind: ClothErrorKind,
}

/// Kind of an error: the field, its value, and the allowed range.
#[derive(Clone, Debug, PartialEq, Error, Reflect)]
#[non_exhaustive]
pub enum ClothErrorKind {
    /// The rest shape is wrong.
    #[error(transparent)]
    Shape(#[from] ClothShapeError),
    /// A mesh asset cannot become a cloth.
    #[error(
        "Mesh3d {reason}, must be a triangle list with positions that is kept in the main world"
    )]
    UnusableMesh {
        /// Reason.
        reason: String,
    },
    /// An asset that a cloth is to be made of did not load.
    #[error("{asset} did not load: {reason}; must be a mesh, or a scene with meshes, that loads")]
    AssetNotLoaded {
        /// The asset.
        asset: String,
        /// Reason.
        reason: String,
    },
    /// The vertices have no attribute that names the pins.
    #[error(
        "ClothFromMesh.pins are named by {attribute}, must be an attribute of the mesh with a number for each vertex"
    )]
    MissingAttribute {
        /// The attribute.
        attribute: String,
    },
    /// A number is out of its range.
    #[error("{field} is {value}, must be {allowed}")]
    Value {
        /// The type and field.
        field: String,
        /// Its value.
        value: f32,
        /// Allowed range, with the unit.
        allowed: String,
    },
    /// A vector is not finite.
    #[error("{field} is {value}, must be finite")]
    Vector {
        /// The type and field.
        field: String,
        /// Its value.
        value: Vec3,
    },
    /// The entity's place in the world has a translation or rotation that is not finite.
    #[error("GlobalTransform is {value}, must be finite")]
    Transform {
        /// The matrix, written out.
        value: String,
    },
    /// The entity is scaled to nothing.
    #[error("Transform scale is {value}, must be finite and not zero in any direction")]
    Scale {
        /// The scale.
        value: Vec3,
    },
    /// The entity's axes are not at right angles in the world: it is turned below a parent that is scaled unevenly.
    #[error(
        "Transform is sheared by {value}, must be at most {most}: its axes are not at right angles in the world, since it is turned below a \
         parent that is scaled unevenly. The cloth is simulated without the shear, so it is drawn beside what holds it"
    )]
    Shear {
        /// The largest cosine of the angle between two axes [-].
        value: f32,
        /// The largest that is allowed [-].
        most: f32,
    },
    /// A pin, a grab or a force names a particle that is not there.
    #[error("{field} names particle {value}, must be below the number of particles, {particles}")]
    ParticleOutOfRange {
        /// The type and field.
        field: String,
        /// The particle.
        value: u32,
        /// Number of particles of the cloth.
        particles: usize,
    },
    /// Pins say "corner" or "edge" of a cloth that is no grid.
    #[error(
        "{field} is {value}, must name particles or a region: this cloth is a mesh, it has no grid corners or edges"
    )]
    NotAGrid {
        /// The type and field.
        field: String,
        /// Selection.
        value: String,
    },
    /// A point of a collider's shape is not finite.
    #[error("ClothCollider {shape} points[{index}] is {value}, must be finite")]
    ColliderPoint {
        /// Name of the shape.
        shape: String,
        /// The point.
        index: usize,
        /// Position of the point.
        value: Vec3,
    },
    /// An index of a triangle mesh names no position.
    #[error(
        "ClothCollider triangle mesh indices[{at}] is {value}, must be below the number of positions, {vertices}"
    )]
    ColliderIndex {
        /// Position in the list, three for each triangle.
        at: usize,
        /// The index.
        value: u32,
        /// The number of positions.
        vertices: usize,
    },
    /// A triangle mesh has no triangle with an area.
    #[error(
        "ClothCollider triangle mesh has {triangles} triangles, must have one with an area at least"
    )]
    NoColliderTriangles {
        /// The number of triangles that were given.
        triangles: usize,
    },
    /// The points of a convex hull lie in a plane, or are too few.
    #[error("ClothCollider convex hull of {points} points has no volume, must not be flat")]
    FlatHull {
        /// The number of points.
        points: usize,
    },
    /// Heights do not make a grid.
    #[error(
        "ClothCollider height field has {heights} heights in {columns} columns, must be 2 or more full rows of 2 or more"
    )]
    HeightField {
        /// The number of heights.
        heights: usize,
        /// The number of columns.
        columns: u32,
    },
    /// A compound has no parts.
    #[error("ClothCollider compound has 0 parts, must have at least one")]
    EmptyCompound,
    /// The mass of a body that cloth is to push is wrong.
    #[error("ClothColliderBody {field} is {value}, must be {allowed}")]
    Body {
        /// Name of the field.
        field: String,
        /// The value, written out.
        value: String,
        /// Allowed range, with the unit.
        allowed: String,
    },
    /// A list has the wrong number of entries.
    #[error("{field} has {value} entries, must have {allowed}")]
    Count {
        /// The type and field.
        field: String,
        /// Number of values.
        value: usize,
        /// Allowed numbers.
        allowed: String,
    },
    /// An attachment belongs to no cloth, or is held by nobody.
    #[error("ClothAttachment has no {missing}, must have one: nothing is held")]
    Unrelated {
        /// The component that is not there.
        missing: String,
    },
    /// An attachment's target, or one of its parents, has no transform.
    #[error("ClothAttachedTo names {value}, which has no Transform, must have one")]
    NoTransform {
        /// The entity without.
        value: Entity,
    },
    /// The state of the cloth became infinite or NaN and was reset.
    #[error(
        "ClothParticles became non-finite at particle {particle}, positions must be finite: reset to the last finite state"
    )]
    NonFiniteState {
        /// The first particle that was not finite.
        particle: usize,
    },
}

impl ClothErrorKind {
    /// An error about a number that is not ok. Names are put together for wrong values alone: some are asked for in every step.
    pub(crate) fn number(
        field: impl Display,
        value: f32,
        ok: bool,
        allowed: impl Display,
    ) -> Option<Self> {
        (!ok).then(|| Self::Value {
            field: field.to_string(),
            value,
            allowed: allowed.to_string(),
        })
    }

    /// An error about a number that is not above 0 and finite.
    pub(crate) fn positive(field: impl Display, value: f32, unit: &str) -> Option<Self> {
        let ok = value > 0.0 && value.is_finite();
        Self::number(
            field,
            value,
            ok,
            format_args!("above 0 and finite [{unit}]"),
        )
    }

    /// An error about a number that is not at least 0 and finite.
    pub(crate) fn not_negative(field: impl Display, value: f32, unit: &str) -> Option<Self> {
        let ok = value >= 0.0 && value.is_finite();
        Self::number(
            field,
            value,
            ok,
            format_args!("at least 0 and finite [{unit}]"),
        )
    }

    /// An error about a number that is not at least 0; infinity is no limit.
    pub(crate) fn limit(field: impl Display, value: f32, unit: &str) -> Option<Self> {
        Self::number(
            field,
            value,
            value >= 0.0,
            format_args!("at least 0 [{unit}]"),
        )
    }

    /// An error about an attachment without this relationship.
    pub(crate) fn unrelated(missing: &str) -> Self {
        Self::Unrelated {
            missing: missing.into(),
        }
    }

    /// An error about a vector that is not finite.
    pub(crate) fn vector(field: impl Display, value: Vec3) -> Option<Self> {
        (!value.is_finite()).then(|| Self::Vector {
            field: field.to_string(),
            value,
        })
    }
}
