//! The component that a user spawns.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::prelude::Transform;
use tailorbird_solver::topology::Topology;

use crate::{
    attachment::ClothAttachedParticles,
    bounds::ClothBounds,
    error::{ClothShapeError, ClothStatus},
    forces::ClothForces,
    frame::ClothFrame,
    grab::ClothGrab,
    inertia::ClothInertia,
    material::ClothMaterial,
    normals::{ClothNormals, ClothShading},
    particles::ClothParticles,
    pins::ClothPins,
    sampling::ClothSampledMotion,
    sleep::{ClothSeen, ClothSleep, ClothSleepState},
    solver::ClothSolver,
    tethers::ClothTethers,
    topology::ClothTopology,
};

pub use tailorbird_solver::shape::ClothShape;

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
    ClothSleepState,
    ClothSeen,
    ClothTethers,
    ClothAttachedParticles,
    ClothTopology,
    ClothFrame,
    ClothParticles,
    ClothNormals,
    ClothBounds,
    ClothSampledMotion,
    Transform
)]
pub struct Cloth {
    /// The rest shape.
    pub shape: ClothShape,
}

impl Cloth {
    /// Distance \[m\] at which the vertices of a mesh are welded, unless another is set.
    pub const WELD_DISTANCE: f32 = ClothShape::WELD_DISTANCE;

    /// A rectangle of `size` \[m\] with `resolution` columns and rows of particles, whose top left corner lies at the
    /// entity's origin: it extends along +x and −y, and its front is seen from +z. [`Cloth::centered`] puts its middle there. What is wrong with the values is reported when the cloth is built; [`Cloth::try_grid`] tells
    /// at once.
    pub fn grid(size: Vec2, resolution: UVec2) -> Self {
        Self {
            shape: ClothShape::grid(size, resolution),
        }
    }

    /// Checked form of [`Cloth::grid`].
    ///
    /// # Errors
    /// [`ClothShapeError::Size`], [`ClothShapeError::Resolution`].
    pub fn try_grid(size: Vec2, resolution: UVec2) -> Result<Self, ClothShapeError> {
        let cloth = Self::grid(size, resolution);
        cloth.shape.check()?;
        Ok(cloth)
    }

    /// Triangles, given as vertices \[m\] and three indices for each triangle. Vertices at the same place become one
    /// particle. What is wrong is reported when the cloth is built; [`Cloth::try_mesh`] tells at once.
    pub fn mesh(positions: impl Into<Vec<Vec3>>, indices: impl Into<Vec<u32>>) -> Self {
        Self {
            shape: ClothShape::mesh(positions, indices),
        }
    }

    /// Checked form of [`Cloth::mesh`].
    ///
    /// # Errors
    /// [`ClothShapeError::NoTriangles`], [`ClothShapeError::IndexCount`], [`ClothShapeError::IndexOutOfRange`], [`ClothShapeError::NonFinitePosition`],
    /// [`ClothShapeError::PositionTooFar`].
    pub fn try_mesh(
        positions: impl Into<Vec<Vec3>>,
        indices: impl Into<Vec<u32>>,
    ) -> Result<Self, ClothShapeError> {
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
        self.shape.size()
    }

    /// Columns and rows, where the cloth is a grid.
    pub fn resolution(&self) -> Option<UVec2> {
        self.shape.resolution()
    }

    /// Positions of the particles at rest, in the entity's own space \[m\], in the order of the particles.
    ///
    /// For a grid particle `row · columns + column`; for a mesh in order of first appearance of each welded vertex, without those of no
    /// triangle. Empty when the shape is invalid.
    pub fn rest_positions(&self) -> Vec<Vec3> {
        self.shape.rest_positions()
    }
}

impl ClothPins {
    /// Every particle of `cloth` for whose rest position (in the entity's own space \[m\]) `held` is true.
    pub fn matching(cloth: &Cloth, mut held: impl FnMut(Vec3) -> bool) -> Self {
        let rest = cloth.rest_positions();
        Self::particles((0..rest.len() as u32).filter(|&i| held(rest[i as usize])))
    }
}
