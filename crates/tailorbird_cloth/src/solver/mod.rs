//! The systems of a substep; their arithmetic is in [`kernels`].

pub mod kernels;

use bevy_ecs::prelude::*;

use crate::{
    cloth::Cloth,
    frame::ClothFrame,
    material::ClothMaterial,
    particles::ClothParticles,
    step::{ClothStep, for_each_cloth},
    topology::{ClothTopology, constraints::ConstraintFamily},
};
use kernels::{distance, verlet::Verlet};

/// Moves particles by inertia, gravity, wind and forces; pins and the grabbed particle towards their targets.
pub fn verlet_step(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothMaterial,
            &ClothFrame,
            &mut ClothParticles,
        ),
        With<Cloth>,
    >,
) {
    for_each_cloth!(step, cloths, |(
        topology,
        material,
        frame,
        mut particles,
    ): (
        &ClothTopology,
        &ClothMaterial,
        &ClothFrame,
        Mut<ClothParticles>
    )| {
        let seconds = step.substep_seconds();
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
            position,
            previous_position,
            lost_displacement,
            acceleration,
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

/// Holds the springs: Gauss–Seidel over batches that share no particle, [`ClothStep::iterations`] times.
///
/// Batches of compliance 0 are solved as Jakobsen's relaxation, the others as XPBD.
pub fn solve_constraints(
    step: Res<ClothStep>,
    mut cloths: Query<(&ClothTopology, &ClothMaterial, &mut ClothParticles), With<Cloth>>,
) {
    for_each_cloth!(step, cloths, |(topology, material, mut particles): (
        &ClothTopology,
        &ClothMaterial,
        Mut<ClothParticles>
    )| {
        let h = step.substep_seconds();
        let alpha_tilde = |family| {
            let compliance = match family {
                ConstraintFamily::Stretch => material.stretch_compliance,
                ConstraintFamily::Shear => material.shear_compliance,
                ConstraintFamily::Bend => material.bend_compliance,
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
