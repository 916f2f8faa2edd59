//! Tethers from every particle to up to four pins, or other particles that are held.

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_solver::tethers::Tethers;

use crate::{
    cloth::Cloth, particles::ClothParticles, solver::ClothSolver, step::ClothStep,
    topology::ClothTopology,
};

/// Geodesic distances of each particle from up to four of the pins, along the sheet at rest. In storage order. Written by [`build_tethers`]
/// alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTethers(#[reflect(ignore)] pub(crate) Tethers);

impl Deref for ClothTethers {
    type Target = Tethers;

    fn deref(&self) -> &Tethers {
        &self.0
    }
}

/// Measures the ways to the pins anew where the pins changed: see [`Tethers::build`]. Particles that are attached rigidly, or held at their
/// targets, count as pins; those at springs do not.
pub fn build_tethers(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothSolver,
            &ClothParticles,
            &mut ClothTethers,
        ),
        With<Cloth>,
    >,
) {
    for (topology, solver, particles, mut tethers) in &mut cloths {
        let wanted = *solver == ClothSolver::Chains;
        let pins = particles.anchors().filter(move |_| wanted);
        let when = (step.steps(), step.seconds());
        tethers.0.build(&topology.0, pins, when);
    }
}
