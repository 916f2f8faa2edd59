//! What the chain solver does to a triangle mesh that is no grid.

use super::{
    chains::Pass,
    kernels::{
        hinge::{HingePass, Hinges},
        lanes::{Shared, SharedPoints},
        mesh::{self, Mesh},
    },
};
use crate::{
    particles::ClothParticles,
    topology::{Topology, fabric::Fabric, weave::EdgeFamily},
};

impl Pass<'_> {
    /// Shear, then the chains along one of the threads, then along the other.
    pub(super) fn solve_fabric(&self, fabric: &Fabric, particles: &mut ClothParticles) {
        let material = self.material;
        let ClothParticles {
            position,
            inv_mass,
            contacts,
            ..
        } = particles;
        let mesh = Mesh {
            fabric,
            position: SharedPoints::new(position),
            inv_mass: Shared::new(inv_mass),
            normal: contacts
                .any
                .then(|| SharedPoints::new(&mut contacts.normal)),
        };
        mesh::solve_shear(
            self.level,
            mesh,
            self.alpha_tilde(material.shear_compliance),
        );
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

    /// Bending of what is no flat lattice.
    pub(super) fn bend(&self, topology: &Topology, particles: &mut ClothParticles) {
        let all = &topology.hinges;
        let pass = HingePass {
            bend_compliance: self.material.bend_compliance.max(0.0),
            seconds: self.seconds,
        };
        let ClothParticles {
            position, inv_mass, ..
        } = particles;
        for batch in &all.batches {
            let range = batch.range.clone();
            let hinges = Hinges {
                particles: &all.particles[range.clone()],
                coefficients: &all.coefficients[range.clone()],
                areas: &all.areas[range.clone()],
            };
            if batch.flat {
                pass.solve_flat(hinges, inv_mass, position);
            } else {
                let rest = &all.rest_lengths[range];
                pass.solve_curved(hinges, rest, inv_mass, position);
            }
        }
    }
}
