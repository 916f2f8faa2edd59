//! Air whose velocity differs from place to place.

mod turbulence;

use bevy_math::Vec3;
use bevy_reflect::prelude::*;

pub use turbulence::{Turbulence, WAVES, Wave, sine};

/// Region in which a wind blows, in the entity's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
pub enum WindShape {
    /// In the whole world.
    #[default]
    Everywhere,
    /// In a box around the entity.
    Cuboid {
        /// Half its sides \[m\].
        half_size: Vec3,
    },
    /// In a sphere around the entity.
    Sphere {
        /// Radius \[m\].
        radius: f32,
    },
}

impl WindShape {
    /// Region scaled with its entity.
    pub fn scaled(self, scale: Vec3) -> Self {
        let scale = scale.abs();
        match self {
            Self::Everywhere => self,
            Self::Cuboid { half_size } => Self::Cuboid {
                half_size: half_size * scale,
            },
            Self::Sphere { radius } => Self::Sphere {
                radius: radius * scale.max_element(),
            },
        }
    }

    /// Distance of a point in the shape's axes from its border, inwards \[m\]; negative outside.
    pub fn depth(self, point: Vec3) -> f32 {
        match self {
            Self::Everywhere => f32::INFINITY,
            Self::Cuboid { half_size } => (half_size - point.abs()).min_element(),
            Self::Sphere { radius } => radius - point.length(),
        }
    }
}

/// Strength of a wind at a depth inside its border, over which it rises within `falloff` \[m\]: 0 to 1, smoothly.
pub fn strength(depth: f32, falloff: f32) -> f32 {
    if falloff > 0.0 {
        let t = (depth / falloff).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    } else {
        f32::from(u8::from(depth >= 0.0))
    }
}
