//! The systems of a substep; their arithmetic is in [`kernels`].

pub(crate) mod chains;
mod fabric;
pub mod kernels;
#[cfg(test)]
mod mesh_tests;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;

use crate::{
    cloth::Cloth,
    frame::ClothFrame,
    material::ClothMaterial,
    particles::ClothParticles,
    step::{ClothStep, for_each_cloth},
    tethers::ClothTethers,
    topology::{ClothTopology, Topology, constraints::ConstraintFamily},
};
use kernels::{distance, verlet::Verlet};

/// Moves particles by inertia, gravity, wind and forces; pins and the grabbed particle towards their targets.
pub fn verlet_step(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothMaterial,
            &ClothSolver,
            &ClothFrame,
            &mut ClothParticles,
        ),
        With<Cloth>,
    >,
) {
    for_each_cloth!(step, cloths, |(
        topology,
        material,
        solver,
        frame,
        mut particles,
    ): (
        &ClothTopology,
        &ClothMaterial,
        &ClothSolver,
        &ClothFrame,
        Mut<ClothParticles>
    )| {
        let seconds = step.substep_seconds();
        if *solver == ClothSolver::Chains {
            let before = particles.substep_seconds;
            chains::damp(step.level(), topology, material, before, &mut particles);
        }
        let verlet = Verlet {
            seconds,
            seconds_before: particles.substep_seconds,
            damping: if material.damping >= 0.0 {
                material.damping
            } else {
                0.0
            },
            gravity: frame.vector_to_frame(step.gravity()),
        };
        let ClothParticles {
            position,
            previous_position,
            lost_displacement,
            acceleration,
            inv_mass,
            pins,
            ..
        } = &mut *particles;
        let left = step.substeps_left();
        verlet.step(
            step.level(),
            position,
            previous_position,
            lost_displacement,
            (!acceleration.is_empty()).then_some(&*acceleration),
            inv_mass,
        );
        for pin in pins.iter() {
            let i = pin.particle as usize;
            let from = position.get(i);
            position.set(i, from + (pin.target - from) / left as f32);
        }
        particles.move_grabbed(topology, left, seconds);
        particles.substep_seconds = seconds;
    });
}

/// How the constraints of a cloth are solved.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
pub enum ClothSolver {
    /// Whole lines of edges at once, exactly; tethers to the pins.
    #[default]
    Chains,
    /// Spring by spring: Jakobsen's relaxation, and XPBD where there is compliance.
    GaussSeidel,
}

impl ClothSolver {
    /// How many substeps a cloth needs in a step of 1/60 s.
    ///
    /// [`Chains`](Self::Chains): a 24th of the particles along the longer side, of a mesh that is no grid a 12th of the square
    /// root of its particles; even, 8 to 16: fewer do for a sheet that hangs, and not for one that is pulled or blown about.
    /// [`GaussSeidel`](Self::GaussSeidel): 16.
    pub fn substeps(self, topology: &Topology) -> u32 {
        match self {
            Self::Chains => {
                let side = topology.lattice.map_or_else(
                    || (topology.particles() as f32).sqrt().ceil() as u32,
                    |lattice| lattice.columns.max(lattice.rows),
                );
                // The chains of a mesh are shorter and bent, and more of them meet at a particle.
                let part = if topology.fabric.is_some() { 12 } else { 24 };
                side.div_ceil(part).next_multiple_of(2).clamp(8, 16)
            }
            Self::GaussSeidel => 16,
        }
    }
}

/// Holds the constraints, as the cloth's [`ClothSolver`] says, [`ClothStep::iterations`] times.
///
/// [`ClothSolver::GaussSeidel`] goes over batches that share no particle; those of compliance 0 are solved as Jakobsen's
/// relaxation, the others as XPBD.
pub fn solve_constraints(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothMaterial,
            &ClothSolver,
            &ClothTethers,
            &mut ClothParticles,
        ),
        With<Cloth>,
    >,
) {
    for_each_cloth!(step, cloths, |(
        topology,
        material,
        solver,
        tethers,
        mut particles,
    ): (
        &ClothTopology,
        &ClothMaterial,
        &ClothSolver,
        &ClothTethers,
        Mut<ClothParticles>
    )| {
        if *solver == ClothSolver::Chains {
            for k in 0..step.iterations() {
                let pass = chains::Pass {
                    level: step.level(),
                    topology,
                    material,
                    seconds: step.substep_seconds(),
                    gravity: step.gravity().length(),
                    number: step.substep() + k,
                };
                pass.solve(tethers, &mut particles);
            }
            return;
        }
        let h = step.substep_seconds();
        let cell_area = topology.cell_area();
        let alpha_tilde = |family| {
            let compliance = match family {
                ConstraintFamily::Stretch => {
                    0.5 * (material.warp_compliance + material.weft_compliance)
                }
                ConstraintFamily::Shear => material.shear_compliance,
                ConstraintFamily::Bend => material.bend_compliance * cell_area,
            };
            // What is not finite would turn into NaN in the product with a multiplier of 0.
            (compliance.max(0.0) / (h * h)).min(f32::MAX)
        };
        let constraints = &topology.constraints;
        let ClothParticles {
            position,
            inv_mass,
            lambda,
            ..
        } = &mut *particles;
        if position.is_empty() {
            return;
        }
        if ConstraintFamily::ALL
            .iter()
            .any(|&family| alpha_tilde(family) > 0.0)
        {
            lambda.clear();
            lambda.resize(constraints.len(), 0.0);
        }
        for _ in 0..step.iterations() {
            for batch in &constraints.batches {
                let range = batch.range.clone();
                let ends = &constraints.ends[range.clone()];
                let rest_lengths = &constraints.rest_lengths[range.clone()];
                let alpha_tilde = alpha_tilde(batch.family);
                if alpha_tilde > 0.0 {
                    let lambda = &mut lambda[range];
                    distance::solve_compliant(
                        ends,
                        rest_lengths,
                        alpha_tilde,
                        inv_mass,
                        lambda,
                        position,
                    );
                } else {
                    distance::solve_rigid(ends, rest_lengths, inv_mass, position);
                }
            }
        }
    });
}
