//! Settings of all cloths: gravity, accuracy, time.
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::Vec3;
//! # use tailorbird_cloth::prelude::*;
//! fn on_the_moon(mut settings: ResMut<ClothSettings>) {
//!     settings.gravity = Vec3::NEG_Y * 1.62;
//! }
//!
//! /// A menu is open: cloth stands still, and goes on as if nothing had been.
//! fn pause(mut settings: ResMut<ClothSettings>) {
//!     settings.paused = true;
//! }
//!
//! /// While it stands still: one step after the other, to look at.
//! fn step(mut settings: ResMut<ClothSettings>) {
//!     settings.step_once();
//! }
//! ```
//!
//! | setting | default | cost |
//! | --- | --- | --- |
//! | [`gravity`](ClothSettings::gravity) | 9.81 m/s² down | nothing |
//! | [`substeps`](ClothSettings::substeps) | `None`: by the resolution, storms and blows, for each cloth its own; [`ClothSubsteps`](crate::solver::ClothSubsteps) sets those of one | in proportion to their number |
//! | [`substep_budget`](ClothSettings::substep_budget) | 500,000 | 3 ms (sheets) to 8 ms (meshes) in a storm, or for meshes that are asked for more than they have, one core, AVX-512; else nothing |
//! | [`most_substeps`](ClothSettings::most_substeps) | 64 | nothing until a load needs them |
//! | [`overlap_speed`](ClothSettings::overlap_speed) | 1 m/s | nothing |
//! | [`iterations`](ClothSettings::iterations) | 1 | nearly in proportion; substeps are the better use of it |
//! | [`instruction_set`](ClothSettings::instruction_set) | the best of the machine | 128²: 1.5 ms with AVX-512, 2.6 AVX2, 5.0 SSE2, 5.5 scalar; the same bits |
//! | [`time_scale`](ClothSettings::time_scale) | 1 | beyond 1 as many times as many substeps |
//! | [`teleport_speed`](ClothSettings::teleport_speed) | 30 m/s | nothing |
//! | [`paused`](ClothSettings::paused) | no | a pause costs nothing to speak of |
//!
//! The length of a step is not set here but by the schedule: `Time::<Fixed>::from_hz(60.0)`; Bevy's own default is 64 Hz. Steps of half
//! the length with half as many substeps cost about the same, and answer to holders, colliders and wind twice as often.
//!
//! # Traps
//!
//! - **[`time_scale`](ClothSettings::time_scale)** is for cloth alone. Slow motion of a whole game is `Time<Virtual>::set_relative_speed`.
//! - **A system in [`ClothSubstep`](crate::schedule::ClothSubstep)** makes all cloths take as many substeps as the one that needs most.
//! - Gravity, substeps and iterations that change **wake** all cloths.
//! - Errors are logged once, and the last valid settings stay in force.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

pub use tailorbird_solver::instruction_set::ClothInstructionSet;

use crate::error::ClothErrorKind;

/// Settings of all cloths. Insert or change it at any time.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothSettings {
    /// Acceleration of every particle [m/s²].
    pub gravity: Vec3,
    /// Into how many substeps of equal length a step is divided, at least 1. More substeps make cloth stiffer and its
    /// motion finer, at proportional cost. `None` is as many as each cloth needs: see
    /// [`ClothSolver::substeps`](crate::solver::ClothSolver::substeps).
    pub substeps: Option<u32>,
    /// The most substeps that a cloth takes where [`substeps`](Self::substeps) is `None`, at rest as well. It takes more than at rest in a
    /// hand, under bodies, where air, forces or its entity's motion of more than 5 m/s stretch it, where it is struck, and as a mesh that is
    /// asked for more than it has.
    pub most_substeps: u32,
    /// Largest number of additional substeps, times particles, that all cloths together take in a step for storms, blows and meshes that
    /// are asked for more than they have; each gets its part of what it needs. A particle of a mesh that is no grid counts as eight. 0
    /// never changes the number.
    pub substep_budget: u32,
    /// Number of passes over the constraints in each substep. One pass in many substeps stretches less than many passes in few.
    pub iterations: u32,
    /// The instructions that the kernels use. The result has the same bits with any.
    pub instruction_set: ClothInstructionSet,
    /// Speed of time for cloth, compared with the clock of its schedule, 0 to 10 [-]. 0 is a pause. Beyond 1 a step has that many times as
    /// many substeps, if their number is not set.
    ///
    /// It acts on cloth alone: entities and colliders move as they do, and seem the faster to a slow cloth. `Time<Virtual>` slows
    /// everything.
    pub time_scale: f32,
    /// Speed at which particles inside a collider are pushed out of it, if they did not go in by their own motion: because cloth or
    /// collider appeared there, or was put there [m/s]. They get no velocity of that.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub overlap_speed: f32,
    /// Speed that separates motion from hops [m/s]; 30 by default, infinity for no hops. A displacement whose velocity differs from the one
    /// before by more than that one's magnitude and this is a hop, of a cloth's entity, of a holder, of a collider, of a target of a motion
    /// constraint: cloth is taken along, and feels the motion before it alone. See [`sampling`](crate::sampling#hops).
    ///
    /// Lower values see shorter hops, and take motion that begins at once for one: a blow, a kick. The length of a hop is that much times
    /// the length of a frame, or of a step for motion in the fixed loop: at 60 a second half a metre.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub teleport_speed: f32,
    /// Stops the simulation. Cloths stay as they are, and are carried along by what holds them.
    pub paused: bool,
    /// Number of steps to do while paused. Counts down.
    pub pending_steps: u32,
}

impl Default for ClothSettings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            substeps: None,
            most_substeps: 64,
            substep_budget: 500_000,
            iterations: 1,
            instruction_set: ClothInstructionSet::Auto,
            time_scale: 1.0,
            overlap_speed: 1.0,
            teleport_speed: Self::TELEPORT_SPEED,
            paused: false,
            pending_steps: 0,
        }
    }
}

impl ClothSettings {
    /// Does one step while paused.
    pub fn step_once(&mut self) {
        self.pending_steps += 1;
    }

    /// The largest number of substeps and of iterations.
    pub const MOST_PASSES: u32 = 1000;

    /// The largest time scale [-].
    pub const LARGEST_TIME_SCALE: f32 = 10.0;

    /// [`teleport_speed`](Self::teleport_speed) unless set [m/s].
    pub const TELEPORT_SPEED: f32 = 30.0;

    /// The teleport speed, or the default where it is wrong [m/s].
    pub(crate) fn valid_teleport_speed(&self) -> f32 {
        if self.teleport_speed >= 0.0 {
            self.teleport_speed
        } else {
            Self::TELEPORT_SPEED
        }
    }

    /// Errors in these settings.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let passes = |field, value: u32, least| {
            let ok = (least..=Self::MOST_PASSES).contains(&value);
            let allowed = format_args!("{least} to {}", Self::MOST_PASSES);
            ClothErrorKind::number(field, value as f32, ok, allowed)
        };
        let limit = ClothErrorKind::limit;
        let most = Self::LARGEST_TIME_SCALE;
        let checks = [
            ClothErrorKind::vector("ClothSettings.gravity", self.gravity),
            passes("ClothSettings.substeps", self.substeps.unwrap_or(1), 1),
            passes("ClothSettings.most_substeps", self.most_substeps, 1),
            limit("ClothSettings.overlap_speed", self.overlap_speed, "m/s"),
            passes("ClothSettings.iterations", self.iterations, 0),
            ClothErrorKind::number(
                "ClothSettings.time_scale",
                self.time_scale,
                (0.0..=most).contains(&self.time_scale),
                format_args!("0 to {most} [-]"),
            ),
            limit("ClothSettings.teleport_speed", self.teleport_speed, "m/s"),
        ];
        checks.into_iter().flatten().collect()
    }
}
