//! Measures the distances along the sheet from what is held.

use bevy_ecs::prelude::*;

use super::ClothTethers;
use crate::{
    cloth::Cloth, particles::ClothParticles, solver::ClothSolver, step::ClothStep,
    topology::ClothTopology,
};

/// Measures the distances from the pins anew where the pins changed: see [`Tethers::build`](tailorbird_solver::tethers::Tethers::build). Particles that are attached rigidly, or held at their
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
