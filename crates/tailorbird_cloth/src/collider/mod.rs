//! Solid things that cloth collides with.
//!
//! ![A tablecloth falls over a ball](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/tablecloth.gif)
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
//! # use bevy_transform::components::Transform;
//! # use tailorbird_cloth::prelude::*;
//! fn spawn(mut commands: Commands) -> Result<(), ClothErrorKind> {
//!     commands.spawn(ClothCollider::half_space().with_friction(0.8));
//!     commands.spawn((ClothCollider::capsule(0.1, 0.5), Transform::from_xyz(0.0, 1.0, 0.0)));
//!     commands.spawn((ClothCollider::cuboid(1.0, 0.8, 1.0).with_margin(0.005), ClothLayers::new(1, 1)));
//!     let hills = vec![0.0, 0.2, 0.1, 0.3];
//!     commands.spawn(ClothCollider::height_field(hills, 2, Vec2::splat(50.0))?);
//!     let arm = ClothColliderShape::Capsule { radius: 0.05, half_length: 0.2 };
//!     let head = ClothColliderShape::Sphere { radius: 0.12 };
//!     let above = Isometry3d::new(Vec3::Y * 0.5, Quat::IDENTITY);
//!     commands.spawn(ClothCollider::compound([(Isometry3d::IDENTITY, arm), (above, head)])?);
//!     Ok(())
//! }
//! ```
//!
//! # Which shape
//!
//! | shape | margin | cost of a particle in contact, that with a half-space being 1 |
//! | --- | --- | --- |
//! | half-space | exact | 1 |
//! | sphere, capsule, tapered capsule | exact | 1.8 to 2 |
//! | cylinder | sharp edges | 2.7 |
//! | cuboid | sharp edges | 1.7 |
//! | convex hull | sharp edges, bevelled where they are acute | grows with its faces: 38 for a hull of 200 points |
//! | height field | along the normal | 7 |
//! | triangle mesh | along the normal | 2 while nothing moves, a search where something does |
//! | compound | as its parts | that of its parts |
//!
//! The numbers are from `bench -- colliders` (128² particles, AVX-512; a half-space takes 0.45 of what the constraints take, which is 7
//! to 13 ns for each particle and substep on a shared machine).
//!
//! The distance kept is the margin of the collider and [`ClothMaterial::thickness`](crate::material::ClothMaterial::thickness)
//! together. Particles keep it, edges and triangles of the cloth do not: a thing smaller than a cell of the cloth may show through.
//!
//! # What does not tunnel
//!
//! A particle's path through a substep, relative to the shape as it moves and turns, is stopped where it enters a convex shape or a
//! triangle, at any speed. A triangle mesh that is closed, with triangles that are counter-clockwise seen from outside, is solid: what
//! starts inside is pushed out, to the nearest side. Any other mesh is a sheet with two sides. A height field is solid below,
//! however deep. A collider that [hops](crate::sampling#hops) sweeps nothing along.
//!
//! # Bodies
//!
//! A [`ClothCollider`] is moved by its `Transform` alone. Bodies of a physics engine are pushed to [`ClothExternalColliders`] in each step, and
//! get back what cloth did to them from [`ClothReactions`].

mod colliders;
#[cfg(feature = "serialize")]
mod description;
mod external;
mod height_field;
mod hull;
mod layers;
mod mesh;
mod reactions;
mod shape;
mod snapshot;
mod solids;
mod stages;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec2, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::Transform;

pub use self::{
    colliders::{ClothColliderState, ClothColliders},
    external::{ClothColliderBody, ClothExternalCollider, ClothExternalColliders},
    height_field::HeightField,
    hull::ConvexHull,
    layers::ClothLayers,
    mesh::TriMesh,
    reactions::{ClothReaction, ClothReactions, gather_reactions},
    shape::{ClothColliderShape, Compound},
    snapshot::snapshot_colliders,
    stages::{
        collide_capsule, collide_cuboid, collide_half_space, collide_shape, collide_sphere,
        find_contacts,
    },
};
use crate::{
    error::{ClothErrorKind, ClothStatus},
    sampling::ClothSampledMotion,
};

/// A solid thing that cloths collide with. It follows the entity's `Transform`, from step to step without gaps, and
/// takes cloth along by friction. [`ClothLayers`] says which cloths, if not all.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, ClothStatus, ClothColliderState, ClothSampledMotion)]
pub struct ClothCollider {
    /// Its shape, around the entity's origin.
    pub shape: ClothColliderShape,
    /// Coulomb friction [-]. The geometric mean with the material's counts.
    pub friction: f32,
    /// Distance that cloth keeps from the shape besides its own thickness \[m\]; 0 unless set.
    pub margin: f32,
}

impl From<ClothColliderShape> for ClothCollider {
    fn from(shape: ClothColliderShape) -> Self {
        Self {
            shape,
            friction: Self::FRICTION,
            margin: 0.0,
        }
    }
}

impl ClothCollider {
    /// The friction of a collider unless another is given [-].
    pub const FRICTION: f32 = 0.5;

    /// A ball of this radius \[m\].
    pub fn sphere(radius: f32) -> Self {
        ClothColliderShape::Sphere { radius }.into()
    }

    /// A capsule: all points within `radius` \[m\] of a line of `length` \[m\] along y: `length + 2 · radius` from end to end.
    pub fn capsule(radius: f32, length: f32) -> Self {
        ClothColliderShape::Capsule {
            radius,
            half_length: 0.5 * length,
        }
        .into()
    }

    /// The hull of two balls of these radii \[m\], `length` \[m\] apart along y.
    pub fn tapered_capsule(bottom_radius: f32, top_radius: f32, length: f32) -> Self {
        ClothColliderShape::TaperedCapsule {
            bottom_radius,
            top_radius,
            half_length: 0.5 * length,
        }
        .into()
    }

    /// A half-space: everything below the entity's x-z plane.
    pub fn half_space() -> Self {
        ClothColliderShape::HalfSpace.into()
    }

    /// A box with these sides \[m\].
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        let size = Vec3::new(x, y, z);
        ClothColliderShape::Cuboid { size }.into()
    }

    /// A cylinder of this radius and height \[m\] along y.
    pub fn cylinder(radius: f32, height: f32) -> Self {
        ClothColliderShape::Cylinder {
            radius,
            half_height: 0.5 * height,
        }
        .into()
    }

    /// The convex hull of points \[m\].
    ///
    /// # Errors
    /// The errors of [`ConvexHull::new`].
    pub fn convex_hull(points: &[Vec3]) -> Result<Self, ClothErrorKind> {
        Ok(ClothColliderShape::ConvexHull(ConvexHull::new(points)?).into())
    }

    /// A mesh of triangles between these positions \[m\].
    ///
    /// # Errors
    /// The errors of [`TriMesh::new`].
    pub fn trimesh(
        positions: impl Into<Vec<Vec3>>,
        triangles: impl Into<Vec<[u32; 3]>>,
    ) -> Result<Self, ClothErrorKind> {
        Ok(ClothColliderShape::TriMesh(TriMesh::new(positions, triangles)?).into())
    }

    /// Terrain: see [`HeightField::new`].
    ///
    /// # Errors
    /// The errors of [`HeightField::new`].
    pub fn height_field(
        heights: Vec<f32>,
        columns: u32,
        size: Vec2,
    ) -> Result<Self, ClothErrorKind> {
        Ok(ClothColliderShape::HeightField(HeightField::new(heights, columns, size)?).into())
    }

    /// Several shapes that move as one.
    ///
    /// # Errors
    /// The errors of [`Compound::new`].
    pub fn compound(
        parts: impl IntoIterator<Item = (Isometry3d, ClothColliderShape)>,
    ) -> Result<Self, ClothErrorKind> {
        Ok(ClothColliderShape::Compound(Compound::new(parts)?).into())
    }

    /// Sets the Coulomb friction [-].
    pub fn with_friction(self, friction: f32) -> Self {
        Self { friction, ..self }
    }

    /// Sets the margin \[m\].
    pub fn with_margin(self, margin: f32) -> Self {
        Self { margin, ..self }
    }

    /// Errors of this collider.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        check(&self.shape, self.friction, self.margin)
    }
}

/// Errors of a collider.
fn check(shape: &ClothColliderShape, friction: f32, margin: f32) -> Vec<ClothErrorKind> {
    let mut errors = shape.errors();
    let not_negative = ClothErrorKind::not_negative;
    errors.extend(not_negative("ClothCollider.friction", friction, "-"));
    errors.extend(not_negative("ClothCollider.margin", margin, "m"));
    errors
}
