//! Begins a step, and plans its substeps.

use bevy_ecs::prelude::*;
use bevy_time::Time;
use tracing::error;

use super::{ClothStep, SimdLevel, more_substeps};
use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    runner::OwnStages,
    settings::ClothSettings,
    sleep::ClothSleepState,
    solver::{ClothSolver, ClothSubsteps},
    topology::ClothTopology,
};

/// Number of particles of a sheet that take as much time as a particle of a mesh.
const MESH: f32 = 8.0;

/// Number of particles (over all cloths) from which on cloths are shared out to threads.
///
/// Sharing out costs 15 to 30 µs for each system, about what 4,000 particles cost in the cheapest one.
const PARALLEL_FROM: usize = 16_384;

/// Prepares the step from the settings and the clock of the schedule.
///
/// Invalid settings are logged once, and the last valid ones stay in force.
pub fn begin_step(
    mut step: ResMut<ClothStep>,
    mut settings: ResMut<ClothSettings>,
    time: Res<Time>,
    (schedules, own): (Res<Schedules>, Res<OwnStages>),
    cloths: Query<(&ClothSleepState, &ClothParticles), With<Cloth>>,
) {
    if settings.is_changed() {
        let errors = settings.errors();
        for kind in &errors {
            error!("{kind}; the last valid settings stay in force");
        }
        if errors.is_empty() {
            step.settings.clone_from(&settings);
        } else {
            step.settings.paused = settings.paused;
        }
    }

    let single_step = settings.paused && settings.pending_steps > 0;
    if single_step {
        settings.bypass_change_detection().pending_steps -= 1;
    }

    if step.running {
        step.elapsed += f64::from(step.seconds);
    }
    step.world_seconds = time.delta_secs();
    step.seconds = step.settings.time_scale * step.world_seconds;
    step.substep = 0;
    step.level = SimdLevel(step.settings.instruction_set.level());
    step.running = step.seconds > 0.0 && (!settings.paused || single_step);
    step.steps += u64::from(step.running);
    step.whole = step.running && own.are_all(&schedules);

    let (mut count, mut particles) = (0, 0);
    for (rest, cloth) in &cloths {
        if !rest.is_asleep() {
            count += 1;
            particles += cloth.len();
        }
    }
    step.parallel = count > 1 && particles >= PARALLEL_FROM;
}

/// Notes where the step starts, of all cloths that are awake, those that have just woken included; also while paused: then both ends of the
/// interpolation agree.
pub(crate) fn begin_cloths(
    mut cloths: Query<(&ClothSleepState, &mut ClothParticles), With<Cloth>>,
) {
    for (rest, mut cloth) in &mut cloths {
        if !rest.is_asleep() {
            cloth.0.begin_step();
        }
    }
}

/// Chooses the number of substeps: the one that is set, or as many as the cloth needs that needs most. Shares out the budget for
/// storms.
pub fn plan_substeps(
    mut step: ResMut<ClothStep>,
    cloths: Query<
        (
            &ClothSolver,
            Option<&ClothSubsteps>,
            &ClothTopology,
            &ClothParticles,
            &ClothSleepState,
        ),
        With<Cloth>,
    >,
) {
    let awake = cloths.iter().filter(|(.., rest)| !rest.is_asleep());
    let wanted = awake.map(|(solver, _, topology, particles, _)| {
        let weight = if topology.fabric().is_some() {
            MESH
        } else {
            1.0
        };
        let unstretched = solver.substeps(topology) as f32;
        weight * particles.len() as f32 * unstretched * more_substeps(*solver, particles)
    });
    let wanted: f32 = wanted.sum();
    step.granted_substeps = (step.settings.substep_budget as f32 / wanted.max(1.0)).min(1.0);
    let needed = cloths.iter().map(|(solver, own, topology, particles, _)| {
        step.substeps_of((*solver, own), topology, particles)
    });
    step.substeps = needed.max().or(step.settings.substeps).unwrap_or(1);
}
