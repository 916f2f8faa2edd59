//! Air whose velocity differs from place to place.

mod turbulence;

use bevy_math::Vec3;

pub use turbulence::{ClothTurbulence, WAVES, Wave, sine};

/// Region in which a wind blows, in the axes of its entity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WindRegion {
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

impl WindRegion {
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
