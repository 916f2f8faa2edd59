//! Takes cloths through a step, one by one.
//!
//! If this crate alone has systems in [`ClothSubstep`], nothing has to happen between the stages of a step, and a cloth can go through all
//! of them while it is in the cache. Many small cloths are shared out to threads; a large one has all threads to itself.

use bevy_ecs::{
    prelude::*,
    schedule::{NodeId, SystemKey},
};
use tailorbird_solver::{
    step as solver_step,
    wall_clock::WallClock,
    workers::{Queue, Workers},
};

use crate::{
    collider::ClothColliders,
    diagnostics::ClothStepTime,
    schedule::ClothSubstep,
    stages::{ClothStagesItem, StagedCloths},
    step::ClothStep,
    wind::ClothWindState,
};

/// Number of particles from which on a cloth is worked on by all threads, and not shared out with others.
pub(crate) const LARGE: usize = 16_384;

/// The systems that this crate has in [`ClothSubstep`].
#[derive(Resource, Debug, Default)]
pub struct OwnStages(Vec<SystemKey>);

impl OwnStages {
    /// Systems of a schedule at this time.
    pub fn new(schedule: &Schedule) -> Self {
        Self(systems(schedule).collect())
    }
}

fn systems(schedule: &Schedule) -> impl Iterator<Item = SystemKey> {
    let nodes = schedule.graph().hierarchy().nodes();
    nodes.filter_map(|node| match node {
        NodeId::System(key) => Some(key),
        NodeId::Set(_) => None,
    })
}

impl OwnStages {
    /// Returns whether [`ClothSubstep`] has these alone: no game put systems or conditions into it, or took any out.
    pub fn are_all(&self, schedules: &Schedules) -> bool {
        let Some(schedule) = schedules.get(ClothSubstep) else {
            return false;
        };
        let graph = schedule.graph();
        let mut sets = graph.system_sets.iter();
        systems(schedule).eq(self.0.iter().copied())
            && !systems(schedule).any(|key| graph.systems.has_conditions(key))
            && !sets.any(|(_, _, conditions)| !conditions.is_empty())
    }
}

/// Takes each cloth through a whole step.
pub(crate) fn simulate_cloths(
    mut all: StagedCloths,
    wind: Res<ClothWindState>,
    mut time: ResMut<ClothStepTime>,
    commands: ParallelCommands,
) {
    let start = WallClock::start();
    let simulate = |cloth: &mut ClothStagesItem,
                    step: &ClothStep,
                    colliders: &ClothColliders,
                    workers: Workers| {
        cloth.particles.0.begin_step();
        wind.blow(step, workers, cloth);
        let count = step.substeps_of(
            (*cloth.solver, cloth.substeps),
            cloth.topology,
            &cloth.particles,
        );
        let nth = |index| step.nth_of(index, count, workers);
        cloth.with_cloth(|cloth| {
            let group = std::slice::from_mut(cloth);
            solver_step::step(count, nth, &colliders.list, group);
        });
        cloth.guard(step.level(), &commands);
        cloth.settle(step, colliders);
        cloth.recompute_normals(step.level(), workers);
        cloth.update_bounds(step.level());
        cloth.rest(step, &wind, colliders);
    };
    let is_large = |cloth: &ClothStagesItem| cloth.particles.len() >= LARGE;
    let mut large = 0;
    for mut cloth in &mut all.cloths {
        if cloth.rest.is_asleep() {
            cloth.renew(all.step.level());
        } else if is_large(&cloth) {
            large += 1;
        }
    }
    all.for_each_awake(&|mut cloth, step, colliders| {
        if !is_large(&cloth) {
            simulate(&mut cloth, step, colliders, Workers::ALONE);
        }
    });
    if large > 0 {
        Queue::open(|workers| {
            for mut cloth in &mut all.cloths {
                if is_large(&cloth) && !cloth.rest.is_asleep() {
                    simulate(&mut cloth, &all.step, &all.colliders, workers);
                }
            }
        });
    }
    time.simulate = start.elapsed();
}
