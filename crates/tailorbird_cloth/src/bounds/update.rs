//! Keeps the boxes around cloths.

use bevy_ecs::prelude::*;
use fearless_simd::Level;

use super::ClothBounds;
use crate::{
    cloth::Cloth,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
};

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
