//! What holds for all cloths.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

use crate::error::ClothErrorKind;

/// What holds for all cloths. Insert or change it at any time.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothSettings {
    /// Acceleration of every particle [m/s²].
    pub gravity: Vec3,
    /// Into how many substeps of equal length a step is divided, at least 1. More substeps make cloth stiffer and its
    /// motion finer, at proportional cost.
    pub substeps: u32,
    /// How often the constraints are passed over in each substep. One pass in many substeps stretches less than many passes
    /// in few.
    pub iterations: u32,
    /// Stops the simulation. Cloths stay as they are.
    pub paused: bool,
    /// While paused: how many steps to do all the same. Counts down.
    pub pending_steps: u32,
}

impl Default for ClothSettings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            substeps: 16,
            iterations: 1,
            paused: false,
            pending_steps: 0,
        }
    }
}

impl ClothSettings {
    /// While paused: does one step.
    pub fn step_once(&mut self) {
        self.pending_steps += 1;
    }

    /// The largest number of substeps and of iterations.
    pub const MOST_PASSES: u32 = 1000;

    /// What is wrong with these settings.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let most = Self::MOST_PASSES as f32;
        [
            ClothErrorKind::vector("ClothSettings.gravity", self.gravity),
            ClothErrorKind::number(
                "ClothSettings.substeps",
                self.substeps as f32,
                |v| (1.0..=most).contains(&v),
                "1 to 1000",
            ),
            ClothErrorKind::number(
                "ClothSettings.iterations",
                self.iterations as f32,
                |v| v <= most,
                "0 to 1000",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
