//! The box around a cloth.

mod update;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tailorbird_solver::kernels::range::bounds;

pub use update::update_bounds;

use crate::particles::ClothParticles;

/// The box, in the cloth's frame, around all particles after the last two steps, and so around everything interpolated
/// between. Written by [`update_bounds`], and where nobody sees the
/// cloth by [`carry_unseen`](crate::sleep::carry_unseen).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothBounds {
    /// Lowest coordinates \[m\].
    pub min: Vec3,
    /// Highest coordinates \[m\].
    pub max: Vec3,
}

impl ClothBounds {
    /// Returns whether a point lies inside or on the box.
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// Box around all particles, now and a step ago; `None` without particles.
    pub(crate) fn around(level: Level, particles: &ClothParticles) -> Option<Self> {
        let (state, all) = (&particles.0.state, 0..particles.len());
        let times = [&state.position, &state.step_position];
        let (min, max) = (!all.is_empty()).then(|| bounds(level, times, all))?;
        Some(Self { min, max })
    }
}
