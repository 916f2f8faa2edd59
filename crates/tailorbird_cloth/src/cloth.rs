//! The component that a user spawns.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::prelude::Transform;

use crate::{
    attachment::AttachedParticles,
    bounds::ClothBounds,
    error::{ClothErrorKind, ClothStatus},
    forces::ClothForces,
    frame::ClothFrame,
    grab::ClothGrab,
    inertia::ClothInertia,
    material::ClothMaterial,
    normals::{ClothNormals, ClothShading},
    particles::ClothParticles,
    pins::ClothPins,
    sampling::SampledMotion,
    sleep::{ClothRest, ClothSeen, ClothSleep},
    solver::ClothSolver,
    tethers::ClothTethers,
    topology::{ClothTopology, Topology, repair::Repaired},
    validate,
};

/// A cloth: its rest shape, in the entity's own space. Brings every other component it needs.
///
/// Change it at run time and the cloth is rebuilt; a grid that stays a grid keeps the shape it has. A cloth whose entity's scale changes
/// keeps its shape and its motion, scaled, whatever it is.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
#[require(
    ClothMaterial,
    ClothPins,
    ClothGrab,
    ClothForces,
    ClothShading,
    ClothStatus,
    ClothSolver,
    ClothInertia,
    ClothSleep,
    ClothRest,
    ClothSeen,
    ClothTethers,
    AttachedParticles,
    ClothTopology,
    ClothFrame,
    ClothParticles,
    ClothNormals,
    ClothBounds,
    SampledMotion,
    Transform
)]
pub struct Cloth {
    /// The rest shape.
    pub shape: ClothShape,
}

/// The rest shape of a cloth.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
#[non_exhaustive]
pub enum ClothShape {
    /// A rectangle in the x-y plane that faces +z. Columns run along +x, rows along −y: row 0 is the top.
    Grid {
        /// Width and height \[m\].
        size: Vec2,
        /// Columns and rows of particles, at least 2 × 2.
        resolution: UVec2,
        /// Which point of the rectangle lies at the entity's origin, as fractions of the width from the left and of
        /// the height from the top. (0, 0), the default, is the top left corner: particle (0, 0).
        #[cfg_attr(feature = "serialize", serde(default))]
        origin: Vec2,
    },
    /// Triangles.
    Mesh {
        /// Vertices \[m\].
        positions: Vec<Vec3>,
        /// Three for each triangle, counter-clockwise seen from the front.
        indices: Vec<u32>,
        /// Vertices that are no further apart than this \[m\] become one particle, so that seams of UVs or normals
        /// hold together.
        #[cfg_attr(feature = "serialize", serde(default = "weld_distance"))]
        weld_distance: f32,
    },
}

/// Of a file that does not say.
#[cfg(feature = "serialize")]
fn weld_distance() -> f32 {
    Cloth::WELD_DISTANCE
}

impl Cloth {
    /// The distance \[m\] at which the vertices of a mesh are welded, unless another is given.
    pub const WELD_DISTANCE: f32 = 1e-5;

    /// A rectangle of `size` \[m\] with `resolution` columns and rows of particles, whose top left corner lies at the
    /// entity's origin. What is wrong with the values is reported when the cloth is built; [`Cloth::try_grid`] tells
    /// at once.
    pub fn grid(size: Vec2, resolution: UVec2) -> Self {
        Self {
            shape: ClothShape::Grid {
                size,
                resolution,
                origin: Vec2::ZERO,
            },
        }
    }

    /// As [`Cloth::grid`], checked.
    ///
    /// # Errors
    /// [`ClothErrorKind::Size`], [`ClothErrorKind::Resolution`].
    pub fn try_grid(size: Vec2, resolution: UVec2) -> Result<Self, ClothErrorKind> {
        let cloth = Self::grid(size, resolution);
        validate::check_shape(&cloth.shape)?;
        Ok(cloth)
    }

    /// Triangles, given as vertices \[m\] and three indices for each triangle. Vertices at the same place become one
    /// particle. What is wrong is reported when the cloth is built; [`Cloth::try_mesh`] tells at once.
    pub fn mesh(positions: impl Into<Vec<Vec3>>, indices: impl Into<Vec<u32>>) -> Self {
        Self {
            shape: ClothShape::Mesh {
                positions: positions.into(),
                indices: indices.into(),
                weld_distance: Self::WELD_DISTANCE,
            },
        }
    }

    /// As [`Cloth::mesh`], checked.
    ///
    /// # Errors
    /// [`ClothErrorKind::NoTriangles`], [`ClothErrorKind::IndexCount`], [`ClothErrorKind::IndexOutOfRange`],
    /// [`ClothErrorKind::NonFinitePosition`], [`ClothErrorKind::PositionTooFar`].
    pub fn try_mesh(
        positions: impl Into<Vec<Vec3>>,
        indices: impl Into<Vec<u32>>,
    ) -> Result<Self, ClothErrorKind> {
        let cloth = Self::mesh(positions, indices);
        Topology::build(&cloth.shape, Vec3::ONE)?;
        Ok(cloth)
    }

    /// Puts another point of a grid at the entity's origin, as fractions of the width from the left and of the height
    /// from the top: (0.5, 0) is the middle of the top edge. Does nothing to a mesh.
    pub fn with_origin(mut self, fractions: Vec2) -> Self {
        if let ClothShape::Grid { origin, .. } = &mut self.shape {
            *origin = fractions;
        }
        self
    }

    /// Puts the middle of a grid at the entity's origin.
    pub fn centered(self) -> Self {
        self.with_origin(Vec2::splat(0.5))
    }

    /// Width and height at rest \[m\], where the cloth is a grid.
    pub fn size(&self) -> Option<Vec2> {
        match self.shape {
            ClothShape::Grid { size, .. } => Some(size),
            ClothShape::Mesh { .. } => None,
        }
    }

    /// Columns and rows, where the cloth is a grid.
    pub fn resolution(&self) -> Option<UVec2> {
        match self.shape {
            ClothShape::Grid { resolution, .. } => Some(resolution),
            ClothShape::Mesh { .. } => None,
        }
    }

    /// Where the particles lie at rest, in the entity's own space \[m\]: their order is that of the particles.
    ///
    /// For a grid particle `row · columns + column`; for a mesh in order of first appearance of each welded
    /// vertex, without those of no triangle. Empty when the shape is invalid.
    pub fn rest_positions(&self) -> Vec<Vec3> {
        self.shape.rest_positions()
    }
}

impl ClothShape {
    pub(crate) fn rest_positions(&self) -> Vec<Vec3> {
        if validate::check_shape(self).is_err() {
            return Vec::new();
        }
        match self {
            Self::Grid {
                size,
                resolution,
                origin,
            } => {
                let last = (resolution - 1).as_vec2();
                let mut positions = Vec::with_capacity((resolution.x * resolution.y) as usize);
                positions.extend(
                    (0..resolution.y)
                        .flat_map(|row| {
                            (0..resolution.x).map(move |column| UVec2::new(column, row))
                        })
                        .map(|at| (at.as_vec2() / last - *origin) * *size)
                        .map(|p| Vec3::new(p.x, -p.y, 0.0)),
                );
                positions
            }
            Self::Mesh {
                positions,
                indices,
                weld_distance,
            } => Repaired::new(positions, indices, *weld_distance, Vec3::ONE).positions,
        }
    }
}
