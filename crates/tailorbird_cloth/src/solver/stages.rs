//! The stages that move particles, and hold them together.

use tailorbird_solver::step::{DAMP, INTEGRATE, SOLVE};

use crate::stages::StagedCloths;

/// Moves particles by inertia, gravity, wind and forces; pins and the grabbed particle towards their targets.
pub fn verlet_step(mut cloths: StagedCloths) {
    cloths.run(INTEGRATE);
}

/// Holds the constraints, as the cloth's [`ClothSolver`](super::ClothSolver) says, [`ClothStep::iterations`](crate::step::ClothStep::iterations) times.
///
/// [`ClothSolver::GaussSeidel`](super::ClothSolver::GaussSeidel) goes over batches that share no particle; those of compliance 0 are solved as Jakobsen's
/// relaxation, the others as XPBD.
pub fn solve_constraints(mut cloths: StagedCloths) {
    cloths.run(SOLVE);
}

/// Damps tangles, after the last substep: see [`ClothSolver::Chains`](super::ClothSolver::Chains).
pub fn damp_tangles(mut cloths: StagedCloths) {
    cloths.run(DAMP);
}
