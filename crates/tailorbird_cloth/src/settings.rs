//! What holds for all cloths.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use fearless_simd::Level;

use crate::error::ClothErrorKind;

/// What holds for all cloths. Insert or change it at any time.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothSettings {
    /// Acceleration of every particle [m/s²].
    pub gravity: Vec3,
    /// Into how many substeps of equal length a step is divided, at least 1. More substeps make cloth stiffer and its
    /// motion finer, at proportional cost. `None` is as many as the finest cloth needs: see
    /// [`ClothSolver::substeps`](crate::solver::ClothSolver::substeps).
    pub substeps: Option<u32>,
    /// The most substeps that a cloth takes where their number is not set. It takes up to two and a half times as many as at rest
    /// while it is asked for more than its fabric has: see [`ClothStatus::strained`](crate::error::ClothStatus::strained).
    pub most_substeps: u32,
    /// How often the constraints are passed over in each substep. One pass in many substeps stretches less than many passes
    /// in few.
    pub iterations: u32,
    /// The instructions that the kernels use. The result has the same bits with any.
    pub instruction_set: InstructionSet,
    /// How fast time passes for cloth, compared with the clock of its schedule, 0 to 10 [-]. 0 is a pause. Beyond 1 a step has
    /// that many times as many substeps, where their number is not set.
    ///
    /// For cloth alone: entities and colliders move as they do, and seem the faster to a slow cloth. `Time<Virtual>` slows
    /// everything.
    pub time_scale: f32,
    /// How fast what is inside a collider is pushed out of it, where it did not go in by its own motion: because one of the two
    /// appeared there, or was put there [m/s]. It gets no velocity of that.
    pub overlap_speed: f32,
    /// Stops the simulation. Cloths stay as they are.
    pub paused: bool,
    /// While paused: how many steps to do all the same. Counts down.
    pub pending_steps: u32,
}

/// The instructions that the kernels use. What the machine does not have is replaced by the best that it has below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
pub enum InstructionSet {
    /// The best of this machine.
    #[default]
    Auto,
    /// One number at a time.
    Scalar,
    /// 4 numbers at a time; every x86-64 processor.
    Sse2,
    /// 8 numbers at a time; x86-64-v3.
    Avx2,
    /// 16 numbers at a time; from Ice Lake and Zen 4 on.
    Avx512,
}

impl InstructionSet {
    /// The level of the vector library.
    pub(crate) fn level(self) -> Level {
        let best = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            let sse2 = || best.as_sse2().map(Level::Sse2);
            let avx2 = || best.as_avx2().map(Level::Avx2);
            match self {
                Self::Scalar => Some(Level::fallback()),
                Self::Sse2 => sse2(),
                Self::Avx2 => avx2().or_else(sse2),
                Self::Auto | Self::Avx512 => None,
            }
            .unwrap_or(best)
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        match self {
            Self::Scalar => Level::fallback(),
            _ => best,
        }
    }
}

impl Default for ClothSettings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            substeps: None,
            most_substeps: 64,
            iterations: 1,
            instruction_set: InstructionSet::Auto,
            time_scale: 1.0,
            overlap_speed: 1.0,
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

    /// The largest time scale [-].
    pub const LARGEST_TIME_SCALE: f32 = 10.0;

    /// What is wrong with these settings.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let most = Self::MOST_PASSES as f32;
        [
            ClothErrorKind::vector("ClothSettings.gravity", self.gravity),
            ClothErrorKind::number(
                "ClothSettings.substeps",
                self.substeps.unwrap_or(1) as f32,
                |v| (1.0..=most).contains(&v),
                "1 to 1000",
            ),
            ClothErrorKind::number(
                "ClothSettings.most_substeps",
                self.most_substeps as f32,
                |v| (1.0..=most).contains(&v),
                "1 to 1000",
            ),
            ClothErrorKind::number(
                "ClothSettings.overlap_speed",
                self.overlap_speed,
                |v| v >= 0.0,
                "at least 0 [m/s]",
            ),
            ClothErrorKind::number(
                "ClothSettings.iterations",
                self.iterations as f32,
                |v| v <= most,
                "0 to 1000",
            ),
            ClothErrorKind::number(
                "ClothSettings.time_scale",
                self.time_scale,
                |v| (0.0..=Self::LARGEST_TIME_SCALE).contains(&v),
                "0 to 10 [-]",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
