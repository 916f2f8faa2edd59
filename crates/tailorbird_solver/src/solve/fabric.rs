//! The chain solver for a triangle mesh that is no grid.

use super::chains::Pass;
use crate::{
    kernels::{
        hinge::{HingePass, Hinges},
        lanes::{Shared, SharedPoints},
        mesh::{self, Mesh},
        packed::{Packed, with_packed},
    },
    particles::Particles,
    topology::{fabric::Fabric, hinges::HingeConstraints, weave::EdgeFamily},
};

/// Number of times that a substep solves each constraint of a mesh; each must be softer by this factor.
const TIMES: f32 = 2.0;

impl Pass<'_> {
    /// Solves shear, the chains of all passes, shear, the chains in the other order.
    ///
    /// In one order alone, successive passes rotate some waves: a mesh that nobody touches would gain energy. Both orders together are
    /// symmetric, and take energy from all waves.
    pub fn solve_fabric(&self, fabric: &Fabric, particles: &mut Particles) {
        let passes = fabric.chains.passes.len();
        self.solve_shear(fabric, particles);
        self.solve_chains(fabric, 0..passes, particles);
        self.solve_shear(fabric, particles);
        self.solve_chains(fabric, (0..passes).rev(), particles);
    }

    fn solve_shear(&self, fabric: &Fabric, particles: &mut Particles) {
        let alpha_tilde = TIMES * self.alpha_tilde(self.material.shear_compliance);
        let springs = &fabric.shear;
        let lengths = particles.state.grant.springs(springs);
        with_packed(
            &mut particles.state.position,
            &particles.input.inv_mass,
            |all| {
                mesh::solve_shear(springs, lengths, alpha_tilde, all);
            },
        );
    }

    fn solve_chains(
        &self,
        fabric: &Fabric,
        order: impl Iterator<Item = usize>,
        particles: &mut Particles,
    ) {
        let material = self.material;
        let Particles {
            state,
            input,
            scratch,
            ..
        } = particles;
        let (grant, contacts) = (&state.grant, &mut scratch.contacts);
        let mesh = Mesh {
            fabric,
            position: SharedPoints::new(&mut state.position),
            inv_mass: Shared::new(&mut input.inv_mass),
            normal: contacts
                .any
                .then(|| SharedPoints::new(&mut contacts.normal)),
            pressed: (!contacts.pressed.is_empty()).then(|| Shared::new(&mut contacts.pressed)),
            rest_length: grant.chains(&fabric.chains),
            give: self.give(state.effort, grant.largest(), contacts.any),
        };
        let passes = &fabric.chains.passes;
        for k in order {
            let compliance = match passes[k].family {
                EdgeFamily::Warp => material.warp_compliance,
                EdgeFamily::Weft | EdgeFamily::Shear => material.weft_compliance,
            };
            let stretch = TIMES * self.alpha_tilde(compliance);
            mesh::solve_chains(self.level, mesh, stretch, passes[k].batches.clone());
        }
    }

    /// Solves the bending of a cloth that is no flat lattice.
    pub fn bend(&self, hinges: &HingeConstraints, particles: &mut Particles) {
        if !hinges.is_empty() {
            with_packed(
                &mut particles.state.position,
                &particles.input.inv_mass,
                |all| {
                    self.solve_hinges(hinges, all);
                },
            );
        }
    }

    fn solve_hinges(&self, hinges: &HingeConstraints, all: &mut [Packed]) {
        let pass = HingePass {
            bend_compliance: self.material.bend_compliance.max(0.0),
            seconds: self.seconds,
        };
        for batch in &hinges.batches {
            let range = batch.range.clone();
            let some = Hinges {
                particles: &hinges.particles[range.clone()],
                coefficients: &hinges.coefficients[range.clone()],
                areas: &hinges.areas[range.clone()],
            };
            if batch.flat {
                pass.solve_flat(some, all);
            } else {
                pass.solve_curved(some, &hinges.rest_lengths[range], all);
            }
        }
    }
}
