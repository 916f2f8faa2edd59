//! Particles that are split off others.

use crate::{particles::Particles, topology::copies::ParticleCopy};

impl Particles {
    /// Adds particles that are split off others: they are where those are and as fast, free, and take their part of the mass. The next
    /// step needs a topology [with the same copies](crate::topology::Topology::with_copies).
    ///
    /// # Panics
    /// When one is a copy of a particle that does not exist.
    pub fn append(&mut self, copies: &[ParticleCopy]) {
        for copy in copies {
            let (of, len) = (copy.of as usize, self.len());
            let state = &mut self.state;
            for points in [
                &mut state.position,
                &mut state.previous_position,
                &mut state.lost_displacement,
                &mut state.step_position,
            ] {
                let place = points.get(of);
                points.resize(len + 1, 0.0);
                points.set(len, place);
            }
            let mass = copy.part * self.input.mass[of];
            self.input.mass[of] -= mass;
            self.input.mass.push(mass);
            self.input.inv_mass.resize(len + 1, 0.0);
        }
        self.input.acceleration.clear();
        self.update_inv_masses();
    }
}
