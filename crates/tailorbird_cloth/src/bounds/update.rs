//! Keeps the boxes around cloths.

use bevy_ecs::prelude::*;
use fearless_simd::Level;

use super::ClothBounds;
use crate::stages::{ClothStagesItem, StagedCloths};

/// Computes the boxes of all cloths.
pub fn update_bounds(mut cloths: StagedCloths) {
    cloths.for_each_awake(&|mut cloth, step, _| cloth.update_bounds(step.level()));
}

impl ClothStagesItem<'_, '_> {
    /// Runs [`update_bounds`] for one cloth.
    pub(crate) fn update_bounds(&mut self, level: Level) {
        if let Some(bounds) = ClothBounds::around(level, &self.particles) {
            self.bounds.set_if_neq(bounds);
        }
    }
}
