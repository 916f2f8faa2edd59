//! Slowing of a strained cloth.

use bevy_math::Vec3;

use crate::{kernels::rigid_motion::RigidMotion, particles::Particles, topology::Topology};

/// Extent of a cloth, as a multiple of its size, beyond which it comes back faster [-]: no hand or post draws it out so far.
const FAR: f32 = 1.5;

/// Rate at which a cloth beyond that extent comes back [1/s].
const RATE: f32 = 8.0;

/// Rate at which the motion of a strained cloth decays, as seen from its holders [1/s].
const DECAY: f32 = 3.0;

/// Least part, in a lull, of the speed at which a cloth comes out of a collider [-].
const LEAST_OUT: f32 = 0.1;

/// Longest side of a box around points \[m\]; 0 without points.
fn extent(points: impl Iterator<Item = Vec3>) -> f32 {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = points.fold(none, |(low, high), p| (low.min(p), high.max(p)));
    (high - low).max_element().max(0.0)
}

/// Motion of the holders and colliders of a strained cloth, from which its own motion is seen.
struct Led {
    /// Mean displacement of most holders since the start of the substep; that of the whole cloth without holders \[m\].
    displacement: Vec3,
    /// Displacement of holders and colliders that bounds that of the cloth \[m\].
    reach: f32,
    /// Largest displacement of a holder or collider \[m\].
    farthest: f32,
    /// Extent of the held particles \[m\].
    apart: f32,
    /// Number of held particles.
    held: usize,
}

impl Particles {
    fn led(&mut self, out: f32) -> Led {
        let mut scratch = std::mem::take(&mut self.scratch.lambda);
        let led = self.led_with(out, &mut scratch);
        self.scratch.lambda = scratch;
        led
    }

    fn led_with(&self, out: f32, lengths: &mut Vec<f32>) -> Led {
        let held = self
            .input
            .inv_mass
            .iter()
            .enumerate()
            .filter(|(_, w)| **w == 0.0);
        let displacements = (held.clone())
            .map(|(i, _)| self.state.position.get(i) - self.state.previous_position.get(i));
        lengths.clear();
        lengths.extend(displacements.clone().map(Vec3::length));
        let farthest = lengths.iter().copied().fold(0.0, f32::max);
        let touching = if self.state.touch.any {
            self.state.touch.swept
        } else {
            0.0
        };
        // The cloth comes out of the collider that it is in, and where it cannot it comes to rest.
        let swept = if self.state.touch.any && self.state.touch.overlaps {
            touching + out * self.state.effort.lulled().max(LEAST_OUT)
        } else {
            touching
        };
        let Some(middle) = lengths.len().checked_sub(1).map(|last| last / 2) else {
            let whole = RigidMotion::of_all(
                &self.input.mass,
                &self.state.position,
                &self.state.previous_position,
            );
            return Led {
                displacement: whole.displacement,
                // The ground stops a falling cloth.
                reach: whole.displacement.length() + swept,
                farthest: touching,
                apart: 0.0,
                held: 0,
            };
        };
        let (_, &mut middle, _) = lengths.select_nth_unstable_by(middle, f32::total_cmp);
        // A holder that jumps away from the others leads nobody.
        let most = displacements.filter(|displacement| displacement.length() <= 1.5 * middle);
        let (sum, count) = most.fold((Vec3::ZERO, 0.0), |(sum, count), displacement| {
            (sum + displacement, count + 1.0)
        });
        Led {
            displacement: sum / f32::max(count, 1.0),
            reach: middle.max(swept),
            farthest: farthest.max(touching),
            apart: extent(held.map(|(i, _)| self.state.position.get(i))),
            held: lengths.len(),
        }
    }

    /// Slows a strained cloth, as seen from its holders, during a substep. `out` is the distance by which colliders push \[m\].
    pub fn damp_strained(&mut self, seconds: f32, out: f32) {
        if !self.state.effort.recovers {
            return;
        }
        let Led {
            displacement,
            reach,
            ..
        } = self.led(out);
        let most = (self.state.effort.speed() + self.state.effort.driven) * seconds + reach;
        let part = 1.0 - (-DECAY * seconds).exp();
        for (i, w) in self.input.inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let before = self.state.previous_position.get(i);
                let moved = self.state.position.get(i) - before - displacement;
                let kept = ((1.0 - part) * moved).clamp_length_max(most);
                self.state.previous_position.set(i, before + moved - kept);
            }
        }
    }

    /// Takes back displacements by constraints of a strained cloth that are beyond the bound of a substep. `out` is the distance by which
    /// colliders push, and `size` the size of the cloth \[m\].
    pub fn limit_strained(&mut self, seconds: f32, [out, size]: [f32; 2]) {
        if self.state.touch.any {
            let speed = self.state.touch.swept / seconds;
            self.state.effort.struck = self.state.effort.struck.max(speed);
        }
        if !self.state.effort.is_slowed() {
            return;
        }
        let led = self.led(out);
        let contacts = [led.held, self.state.touch.colliders];
        let driven = self.state.effort.driven;
        let fastest = driven.max(led.farthest / seconds);
        self.state.effort.pass(seconds, fastest, contacts);
        let mut speed = 2.0 * self.state.effort.speed() + driven;
        if !self.state.touch.any {
            let far = f32::max(FAR * size, led.apart + size);
            speed += RATE * (extent(self.state.previous_position.iter()) - far).max(0.0);
        }
        let most = speed * seconds + led.reach;
        for (i, w) in self.input.inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let start = self.state.previous_position.get(i) + led.displacement;
                let moved = self.state.position.get(i) - start;
                if moved.length_squared() > most * most {
                    self.state
                        .position
                        .set(i, start + moved.clamp_length_max(most));
                }
            }
        }
    }

    /// Disturbs a sheet in a perfect plane that a collider presses within that plane, which would stand as a board: pushes its particles
    /// out of it, each by its own part of 10 µm.
    pub fn disturb(&mut self, topology: &Topology) {
        const FLAT: f32 = 1e-4;
        const PUSH: f32 = 1e-5;
        let (state, contacts) = (&mut self.state, &self.scratch.contacts);
        let flat = topology.flat && state.position.z.iter().all(|z| z.abs() < FLAT);
        if !flat || !contacts.any {
            return;
        }
        let normal = &contacts.normal;
        let sideways = |i: usize| normal.x[i].hypot(normal.y[i]) > normal.z[i].abs();
        if !(0..normal.len()).any(sideways) {
            return;
        }
        for (i, w) in self.input.inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let push = PUSH * crate::numbers::unit_of(i as u32);
                state.position.z[i] += push;
                state.previous_position.z[i] += push;
            }
        }
    }
}
