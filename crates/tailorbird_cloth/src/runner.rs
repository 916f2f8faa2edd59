//! Takes cloths through all substeps of a step, one by one.
//!
//! Where nobody but this crate has systems in [`ClothSubstep`], nothing has to happen between the stages of a substep, and a cloth
//! can go through all of them while it is in the cache. Many small cloths are shared out to threads; a large one has all
//! threads to itself.

use std::time::Instant;

use bevy_ecs::{
    prelude::*,
    schedule::{NodeId, SystemKey},
};

use crate::{
    cloth::Cloth,
    collider::ClothColliders,
    crew::{Crew, Desk},
    diagnostics::ClothStepTime,
    particles::ClothParticles,
    schedule::ClothSubstep,
    sleep::ClothRest,
    stages::{ClothStages, ClothStagesItem},
    step::{ClothStep, for_each_awake},
};

/// From this many particles on a cloth is worked on by all threads, and not shared out with others.
pub(crate) const LARGE: usize = 16_384;

/// The systems that this crate has in [`ClothSubstep`].
#[derive(Resource, Debug, Default)]
pub(crate) struct OwnStages(Vec<SystemKey>);

impl OwnStages {
    /// Those that are there now.
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

/// Run condition: a game put systems of its own into [`ClothSubstep`], or conditions, or took systems out.
pub(crate) fn game_has_stages(schedules: Res<Schedules>, own: Res<OwnStages>) -> bool {
    let Some(schedule) = schedules.get(ClothSubstep) else {
        return true;
    };
    let graph = schedule.graph();
    let mut sets = graph.system_sets.iter();
    !systems(schedule).eq(own.0.iter().copied())
        || systems(schedule).any(|key| graph.systems.has_conditions(key))
        || sets.any(|(_, _, conditions)| !conditions.is_empty())
}

/// Takes each cloth through all its substeps.
pub(crate) fn simulate_cloths(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut time: ResMut<ClothStepTime>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    let start = Instant::now();
    let simulate = |cloth: &mut ClothStagesItem, crew: Crew| {
        let count = step.substeps_of(*cloth.solver, cloth.topology);
        for index in 0..count {
            cloth.run(&step.nth_of(index, count, crew), &colliders);
        }
    };
    let is_large = |particles: &ClothParticles| particles.len() >= LARGE;
    let large =
        |rest: &ClothRest, particles: &ClothParticles| !rest.is_asleep() && is_large(particles);
    for_each_awake!(step, cloths, |mut cloth: ClothStagesItem| {
        if !is_large(&cloth.particles) {
            simulate(&mut cloth, Crew::ALONE);
        }
    });
    if cloths
        .iter()
        .any(|cloth| large(cloth.rest, cloth.particles))
    {
        Desk::open(|crew| {
            for mut cloth in &mut cloths {
                if large(cloth.rest, &cloth.particles) {
                    simulate(&mut cloth, crew);
                }
            }
        });
    }
    time.simulate = start.elapsed();
}
