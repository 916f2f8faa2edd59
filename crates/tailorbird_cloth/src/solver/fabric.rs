//! What the chain solver does to a triangle mesh that is no grid.

use super::{
    chains::Pass,
    kernels::{
        hinge::{HingePass, Hinges},
        lanes::{Shared, SharedPoints},
        mesh::{self, Mesh},
        packed::{Packed, with_packed},
    },
};
use crate::{
    particles::ClothParticles,
    topology::{Topology, fabric::Fabric, hinges::HingeConstraints, weave::EdgeFamily},
};

impl Pass<'_> {
    /// The chains along one of the threads, then along the other.
    pub(super) fn solve_fabric(&self, fabric: &Fabric, particles: &mut ClothParticles) {
        let material = self.material;
        let ClothParticles {
            position,
            inv_mass,
            contacts,
            effort,
            ..
        } = particles;
        let mesh = Mesh {
            fabric,
            position: SharedPoints::new(position),
            inv_mass: Shared::new(inv_mass),
            normal: contacts
                .any
                .then(|| SharedPoints::new(&mut contacts.normal)),
            pressed: (!contacts.pressed.is_empty()).then(|| Shared::new(&mut contacts.pressed)),
            give: self.give(*effort, contacts.any),
        };
        let passes = &fabric.chains().passes;
        for k in 0..passes.len() {
            let k = if self.is_odd() {
                passes.len() - 1 - k
            } else {
                k
            };
            let compliance = match passes[k].family {
                EdgeFamily::Warp => material.warp_compliance,
                EdgeFamily::Weft | EdgeFamily::Shear => material.weft_compliance,
            };
            let stretch = self.alpha_tilde(compliance);
            mesh::solve_chains(self.level, mesh, stretch, passes[k].batches.clone());
        }
    }

    /// Bending of what is no flat lattice, then the shear of what is no lattice.
    pub(super) fn bend(&self, topology: &Topology, particles: &mut ClothParticles) {
        let (hinges, fabric) = (&topology.hinges, topology.fabric.as_ref());
        if hinges.is_empty() && fabric.is_none() {
            return;
        }
        let ClothParticles {
            position, inv_mass, ..
        } = particles;
        with_packed(position, inv_mass, |all| {
            self.solve_hinges(hinges, all);
            if let Some(fabric) = fabric {
                let alpha_tilde = self.alpha_tilde(self.material.shear_compliance);
                mesh::solve_shear(fabric.shear(), alpha_tilde, all);
            }
        });
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
