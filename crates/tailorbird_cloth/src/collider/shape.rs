//! The shapes of colliders.

use std::sync::Arc;

use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;

use super::{ConvexHull, HeightField, TriMesh};
use crate::error::ClothErrorKind;

/// The shape of a collider, around its entity's origin. Cloning one is cheap.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[non_exhaustive]
pub enum ClothColliderShape {
    /// A ball. Where the entity is scaled, the largest factor counts, as for all round shapes.
    Sphere {
        /// Radius \[m\].
        radius: f32,
    },
    /// A capsule: all points within a radius of a line along y.
    Capsule {
        /// Radius \[m\].
        radius: f32,
        /// Half of the line's length \[m\].
        half_length: f32,
    },
    /// The hull of two balls on the y axis.
    TaperedCapsule {
        /// Radius of the ball at −`half_length` \[m\].
        bottom_radius: f32,
        /// Radius of the ball at +`half_length` \[m\].
        top_radius: f32,
        /// Half of the distance between their centres \[m\].
        half_length: f32,
    },
    /// A half-space, the ground: everything below the entity's x-z plane.
    HalfSpace,
    /// A box. Scale counts along each of its axes.
    Cuboid {
        /// Its sides \[m\].
        size: Vec3,
    },
    /// A cylinder along y.
    Cylinder {
        /// Radius \[m\].
        radius: f32,
        /// Half of its height \[m\].
        half_height: f32,
    },
    /// The convex hull of points. Scale counts along each axis.
    ConvexHull(ConvexHull),
    /// Triangles. Scale counts along each axis.
    TriMesh(TriMesh),
    /// Terrain. Scale counts along each axis.
    HeightField(HeightField),
    /// Several shapes.
    Compound(Compound),
}

/// Shapes with their places in a whole. A clone shares them.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Compound(Arc<[(Isometry3d, ClothColliderShape)]>);

impl Compound {
    /// These shapes at these places \[m\]. Compounds among them are taken apart.
    ///
    /// # Errors
    /// [`ClothErrorKind::EmptyCompound`]; [`ClothErrorKind::Vector`] where a place is not finite.
    pub fn new(
        parts: impl IntoIterator<Item = (Isometry3d, ClothColliderShape)>,
    ) -> Result<Self, ClothErrorKind> {
        let mut flat = Vec::new();
        for (at, shape) in parts {
            let place = Vec3::from(at.translation);
            if !place.is_finite() || !at.rotation.is_finite() {
                return Err(ClothErrorKind::Vector {
                    field: "Compound part place".into(),
                    value: place,
                });
            }
            match shape {
                ClothColliderShape::Compound(inner) => {
                    flat.extend(inner.0.iter().map(|(to, shape)| (at * *to, shape.clone())));
                }
                shape => flat.push((at, shape)),
            }
        }
        if flat.is_empty() {
            return Err(ClothErrorKind::EmptyCompound);
        }
        Ok(Self(flat.into()))
    }

    /// The shapes and their places \[m\].
    pub fn parts(&self) -> &[(Isometry3d, ClothColliderShape)] {
        &self.0
    }
}

impl ClothColliderShape {
    /// Errors in its measures.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let positive = |field, value| ClothErrorKind::positive(field, value, "m");
        let length = |field, value| ClothErrorKind::not_negative(field, value, "m");
        let found = match self {
            Self::Sphere { radius } => [positive("ClothCollider radius", *radius), None, None],
            Self::Capsule {
                radius,
                half_length,
            } => [
                positive("ClothCollider radius", *radius),
                length("ClothCollider half_length", *half_length),
                None,
            ],
            Self::TaperedCapsule {
                bottom_radius,
                top_radius,
                half_length,
            } => [
                positive("ClothCollider bottom_radius", *bottom_radius),
                positive("ClothCollider top_radius", *top_radius),
                length("ClothCollider half_length", *half_length),
            ],
            Self::Cuboid { size } => size
                .to_array()
                .map(|side| positive("ClothCollider size", side)),
            Self::Cylinder {
                radius,
                half_height,
            } => [
                positive("ClothCollider radius", *radius),
                positive("ClothCollider half_height", *half_height),
                None,
            ],
            Self::Compound(compound) => {
                let parts = compound.parts().iter();
                return parts.flat_map(|(_, shape)| shape.errors()).collect();
            }
            // Their constructors checked them.
            Self::HalfSpace | Self::ConvexHull(_) | Self::TriMesh(_) | Self::HeightField(_) => {
                return Vec::new();
            }
        };
        found.into_iter().flatten().collect()
    }
}
