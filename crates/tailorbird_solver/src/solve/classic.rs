//! The classic solver: springs one by one.

use crate::{
    coefficients::Coefficients,
    kernels::{distance, spring::alpha_tilde},
    particles::Particles,
    substep::Substep,
    topology::{Topology, constraints::ConstraintFamily},
};

/// Passes over all springs, batch by batch.
pub fn solve(
    substep: &Substep,
    topology: &Topology,
    material: &Coefficients,
    particles: &mut Particles,
) {
    let cell_area = topology.cell_area();
    let alpha_tilde = |family| {
        let compliance = match family {
            ConstraintFamily::Stretch => {
                0.5 * (material.warp_compliance + material.weft_compliance)
            }
            ConstraintFamily::Shear => material.shear_compliance,
            ConstraintFamily::Bend => material.bend_compliance * cell_area,
        };
        alpha_tilde(compliance, substep.seconds)
    };
    let constraints = topology.constraints();
    let Particles {
        state,
        input,
        scratch,
        ..
    } = particles;
    let inv_mass = &input.inv_mass;
    let (position, lambda) = (&mut state.position, &mut scratch.lambda);
    if position.is_empty() {
        return;
    }
    let compliant = |&family: &ConstraintFamily| alpha_tilde(family) > 0.0;
    if ConstraintFamily::ALL.iter().any(compliant) {
        lambda.clear();
        lambda.resize(constraints.len(), 0.0);
    }
    for _ in 0..substep.iterations {
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
}
