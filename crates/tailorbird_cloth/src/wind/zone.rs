//! Wind in a part of the world.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::Transform;
use tailorbird_solver::wind::WindRegion;

use super::{ClothGusts, ClothTurbulence, variation_errors};
use crate::{
    error::{ClothErrorKind, ClothStatus},
    sampling::ClothSampledMotion,
};

/// Air that moves in a part of the world, which is added to [`ClothWind`](super::ClothWind) and to other zones there. It moves, turns and grows with its
/// entity, and `velocity` and turbulence turn with it.
///
/// ```
/// # use bevy_ecs::prelude::*;
/// # use bevy_math::Vec3;
/// # use bevy_transform::components::Transform;
/// # use tailorbird_cloth::prelude::*;
/// fn fan(mut commands: Commands) {
///     commands.spawn((
///         ClothWindZone {
///             falloff: 0.5,
///             turbulence: ClothTurbulence { speed: 1.0, scale: 0.5, ..ClothTurbulence::default() },
///             ..ClothWindZone::cuboid(Vec3::new(2.0, 2.0, 6.0), Vec3::Z * 6.0)
///         },
///         Transform::from_xyz(0.0, 1.0, -3.0),
///     ));
/// }
/// ```
///
/// One that is wrong is reported in [`ClothStatus`] and blows not.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
#[require(Transform, ClothStatus, ClothSampledMotion)]
pub struct ClothWindZone {
    /// Region in which it blows.
    pub shape: ClothWindShape,
    /// Mean velocity of the air, along the entity's axes [m/s].
    pub velocity: Vec3,
    /// Width inside the border over which the wind rises from nothing to its full speed \[m\]; 0 is at once. Nothing outside moves.
    pub falloff: f32,
    /// Variation in time.
    pub gusts: ClothGusts,
    /// Turbulence.
    pub turbulence: ClothTurbulence,
}

impl Default for ClothWindZone {
    /// No wind in a sphere of 1 m.
    fn default() -> Self {
        Self {
            shape: ClothWindShape::default(),
            velocity: Vec3::ZERO,
            falloff: 0.0,
            gusts: ClothGusts::default(),
            turbulence: ClothTurbulence::default(),
        }
    }
}

impl ClothWindZone {
    /// A steady wind in a box with these sides \[m\] [m/s]. Wind in the whole world is [`ClothWind`](super::ClothWind).
    pub fn cuboid(size: Vec3, velocity: Vec3) -> Self {
        Self {
            shape: ClothWindShape::Cuboid { size },
            velocity,
            ..Self::default()
        }
    }

    /// A steady wind in a sphere of this radius \[m\] [m/s].
    pub fn sphere(radius: f32, velocity: Vec3) -> Self {
        Self {
            shape: ClothWindShape::Sphere { radius },
            velocity,
            ..Self::default()
        }
    }

    /// Errors of this zone.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let size = |field, value| ClothErrorKind::positive(field, value, "m");
        let shape = match self.shape {
            ClothWindShape::Cuboid { size: sides } => {
                let (least, most) = (sides.min_element(), sides.max_element());
                let worst = if most.is_finite() { least } else { most };
                size("ClothWindZone.shape.size", worst)
            }
            ClothWindShape::Sphere { radius } => size("ClothWindZone.shape.radius", radius),
        };
        let checks = [
            shape,
            ClothErrorKind::vector("ClothWindZone.velocity", self.velocity),
            ClothErrorKind::not_negative("ClothWindZone.falloff", self.falloff, "m"),
        ];
        let varies = variation_errors("ClothWindZone", &self.gusts, &self.turbulence);
        checks.into_iter().chain(varies).flatten().collect()
    }
}

/// Region in which a wind blows, in the entity's axes.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
pub enum ClothWindShape {
    /// In a box around the entity.
    Cuboid {
        /// Its sides \[m\].
        size: Vec3,
    },
    /// In a sphere around the entity.
    Sphere {
        /// \[m\]
        radius: f32,
    },
}

impl Default for ClothWindShape {
    /// A sphere of 1 m.
    fn default() -> Self {
        Self::Sphere { radius: 1.0 }
    }
}

impl ClothWindShape {
    /// The same for the solver, as large as an entity of this scale makes it.
    pub(super) fn region(self, scale: Vec3) -> WindRegion {
        let scale = scale.abs();
        match self {
            Self::Cuboid { size } => WindRegion::Cuboid {
                half_size: 0.5 * size * scale,
            },
            Self::Sphere { radius } => WindRegion::Sphere {
                radius: radius * scale.max_element(),
            },
        }
    }
}

/// Overlap of a wind of this shape with a ball: none (`None`), the same wind everywhere, or a varying one.
pub(super) fn is_whole_in(
    shape: WindRegion,
    falloff: f32,
    at: Isometry3d,
    (center, radius): (Vec3, f32),
) -> Option<bool> {
    let depth = shape.depth(at.inverse() * center);
    // Outside a corner of a box this is less than the distance: it may count a ball as met that is not.
    (depth > -radius).then_some(depth - radius >= falloff)
}
