//! The stages that move particles, and hold them together.

use bevy_ecs::prelude::*;
use tailorbird_solver::step::{DAMP, INTEGRATE, SOLVE};

use crate::{
    cloth::Cloth,
    collider::ClothColliders,
    stages::{ClothStages, run_stage},
    step::ClothStep,
};

/// Moves particles by inertia, gravity, wind and forces; pins and the grabbed particle towards their targets.
pub fn verlet_step(
    (step, colliders): (Res<ClothStep>, Res<ClothColliders>),
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    run_stage(INTEGRATE, &step, &colliders, &mut cloths);
}

/// Holds the constraints, as the cloth's [`ClothSolver`](super::ClothSolver) says, [`ClothStep::iterations`] times.
///
/// [`ClothSolver::GaussSeidel`](super::ClothSolver::GaussSeidel) goes over batches that share no particle; those of compliance 0 are solved as Jakobsen's
/// relaxation, the others as XPBD.
pub fn solve_constraints(
    (step, colliders): (Res<ClothStep>, Res<ClothColliders>),
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    run_stage(SOLVE, &step, &colliders, &mut cloths);
}

/// Damps tangles, after the last substep: see [`ClothSolver::Chains`](super::ClothSolver::Chains).
pub fn damp_tangles(
    (step, colliders): (Res<ClothStep>, Res<ClothColliders>),
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    run_stage(DAMP, &step, &colliders, &mut cloths);
}
