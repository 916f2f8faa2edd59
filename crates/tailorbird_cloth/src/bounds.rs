//! The box around a cloth.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tailorbird_solver::bounds::Bounds;

use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
};

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
}

/// Computes the boxes of all cloths.
pub fn update_bounds(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.update_bounds(step.level());
    });
}

impl ClothStagesItem<'_, '_> {
    /// Runs [`update_bounds`] for one cloth.
    pub(crate) fn update_bounds(&mut self, level: Level) {
        if let Some(bounds) = ClothBounds::around(level, &self.particles) {
            self.bounds.set_if_neq(bounds);
        }
    }
}

impl ClothBounds {
    /// The box around all particles, now and a step ago; `None` where there are none.
    pub(crate) fn around(level: Level, particles: &ClothParticles) -> Option<Self> {
        let Bounds { min, max } = Bounds::around(level, particles)?;
        Some(Self { min, max })
    }

    /// Box in the form of the solver.
    pub(crate) fn bounds(self) -> Bounds {
        let Self { min, max } = self;
        Bounds { min, max }
    }
}
