//! A hand that moves a particle.

use crate::{particles::Particles, topology::Topology};

/// Largest distance of the held particle from a neighbour, as a multiple of their distance at rest.
pub const MOST_STRETCH: f32 = 1.1;

impl Particles {
    /// Moves the grabbed particle one substep nearer to its target, as far as its neighbours allow, and pulls the particles around it
    /// along. `left` substeps remain, this one included.
    pub fn move_grabbed(&mut self, topology: &Topology, left: u32, seconds: f32) {
        let Some((held, target)) = self.input.held.in_hand() else {
            return;
        };
        let i = held.index();
        let from = self.state.position.get(i);
        let mut hand = from + (target - from) / left as f32;
        // Projects onto the balls around the neighbours in turn; two rounds are enough for the neighbours in a sheet.
        for neighbor in topology.neighbors(held).iter().cycle().take(16) {
            let rest =
                topology.rest_positions[i].distance(topology.rest_positions[neighbor.index()]);
            let anchor = self.state.position.get(neighbor.index());
            hand = anchor + (hand - anchor).clamp_length_max(MOST_STRETCH * rest);
        }
        self.state.position.set(i, hand);
        // A part 1 − w of the displacement is left after a sixtieth of a second, whatever the number of substeps.
        for pulled in &self.input.pulled {
            let i = pulled.particle.index();
            if self.input.inv_mass[i] == 0.0 {
                continue;
            }
            let rate = 1.0 - (1.0 - pulled.weight).max(0.0).powf(60.0 * seconds);
            let (from, free) = (
                self.state.previous_position.get(i),
                self.state.position.get(i),
            );
            let slowed = from.lerp(free, 1.0 - rate);
            self.state
                .position
                .set(i, slowed.lerp(hand + pulled.offset, rate));
        }
    }
}
