//! Sets, and the schedule that runs once per substep.

use bevy_ecs::{prelude::*, schedule::ScheduleLabel};
use tailorbird_solver::wall_clock::WallClock;

use crate::{diagnostics::ClothStepTime, step::ClothStep};

/// The parts of a step, in order, in the schedule that was given to [`ClothPlugin::new`](crate::plugin::ClothPlugin::new).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClothSystems {
    /// Builds new cloths, reads transforms, colliders, pins, wind and forces.
    Prepare,
    /// Runs [`ClothSubstep`] once per substep, and guards the state.
    Simulate,
    /// Computes normals and bounds; lets cloths fall asleep.
    Writeback,
}

/// Schedules of this crate, each of systems that run one after the other.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Part {
    /// Systems of [`ClothSystems::Prepare`].
    Prepare,
    /// Systems of [`ClothSystems::Simulate`].
    Simulate,
    /// Systems of [`ClothSystems::Writeback`].
    Writeback,
    /// Runs when each step of the fixed loop begins, before all that moves things in it.
    FixedLoopBegins,
    /// Runs when each step of the fixed loop ends.
    FixedLoopEnds,
}

/// Runs once per substep. [`ClothStep`] tells which it is and how long it lasts.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClothSubstep;

/// The parts of a substep, in order, in [`ClothSubstep`]. A game puts its own systems between them.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClothSubstepSystems {
    /// Moves the cloths' frames, pins and particles.
    Integrate,
    /// Pushes particles out of colliders and notes where they touch.
    Approach,
    /// Holds the constraints.
    Solve,
    /// Keeps particles out of colliders.
    Collide,
}

/// Runs [`ClothSubstep`] as often as the step has substeps, and measures it.
pub fn run_substeps(world: &mut World) {
    let substeps = world.resource::<ClothStep>().substeps;
    let start = WallClock::start();
    for substep in 0..substeps {
        world.resource_mut::<ClothStep>().substep = substep;
        world.run_schedule(ClothSubstep);
    }
    world.resource_mut::<ClothStepTime>().simulate = start.elapsed();
}
