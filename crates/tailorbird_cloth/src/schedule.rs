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

/// The systems of [`ClothSystems::Prepare`].
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Prepare;

/// The systems of [`ClothSystems::Simulate`].
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Simulate;

/// The systems of [`ClothSystems::Writeback`].
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Writeback;

/// Runs the systems of a part of the step.
pub(crate) fn run_part<L: ScheduleLabel + Default>(world: &mut World) {
    world.run_schedule(L::default());
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
