//! The box around a cloth.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    sleep::ClothRest,
    solver::kernels::range::range,
    step::{ClothStep, for_each_cloth},
};

/// The box, in the cloth's frame, around all particles after the last two steps, and so around everything interpolated
/// between. Written by [`update_bounds`] alone.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothBounds {
    /// Lowest coordinates \[m\].
    pub min: Vec3,
    /// Highest coordinates \[m\].
    pub max: Vec3,
}

impl ClothBounds {
    /// Whether a point lies inside or on the box.
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }
}

/// Computes the boxes of all cloths.
pub fn update_bounds(
    step: Res<ClothStep>,
    mut cloths: Query<(&ClothRest, &ClothParticles, &mut ClothBounds), With<Cloth>>,
) {
    for_each_cloth!(step, cloths, |(rest, particles, mut bounds): (
        &ClothRest,
        &ClothParticles,
        Mut<ClothBounds>
    )| {
        if rest.is_asleep() || particles.is_empty() {
            return;
        }
        let range = |values: &[f32], ends| range(step.level(), values, ends);
        let (now, before) = (&particles.position, &particles.step_position);
        let empty = (f32::INFINITY, f32::NEG_INFINITY);
        let x = range(&before.x, range(&now.x, empty));
        let y = range(&before.y, range(&now.y, empty));
        let z = range(&before.z, range(&now.z, empty));
        bounds.set_if_neq(ClothBounds {
            min: Vec3::new(x.0, y.0, z.0),
            max: Vec3::new(x.1, y.1, z.1),
        });
    });
}
