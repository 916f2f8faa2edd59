//! The box around particles.

use bevy_math::Vec3;
use fearless_simd::Level;

use crate::{kernels::range::range, particles::Particles};

/// A box: lowest and highest coordinates \[m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates \[m\].
    pub min: Vec3,
    /// Highest coordinates \[m\].
    pub max: Vec3,
}

impl Bounds {
    /// Box around all particles, now and a step ago; `None` without particles.
    pub fn around(level: Level, particles: &Particles) -> Option<Self> {
        if particles.is_empty() {
            return None;
        }
        let range = |values: &[f32], ends| range(level, values, ends);
        let (now, before) = (&particles.state.position, &particles.state.step_position);
        let empty = (f32::INFINITY, f32::NEG_INFINITY);
        let x = range(&before.x, range(&now.x, empty));
        let y = range(&before.y, range(&now.y, empty));
        let z = range(&before.z, range(&now.z, empty));
        Some(Self {
            min: Vec3::new(x.0, y.0, z.0),
            max: Vec3::new(x.1, y.1, z.1),
        })
    }
}
