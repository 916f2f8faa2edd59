//! Stages of bodies that cloth pushes; [`bodies`](super::bodies) explains them.

use std::{mem, ops::Range};

use bevy_math::Vec3;

use super::{
    bodies::{Coupling, Proxy, Pull, Struck},
    broad_phase::LEAVING,
    cache::ContactCache,
};
use crate::{
    cloth::ClothData,
    contact::colliders::{Colliders, MovingCollider, combined_friction},
    kernels::contact::Phase,
    particles::{Input, Particles, Scratch, State},
    points::Points,
    substep::Substep,
};

/// Largest part of a particle's inverse mass that a coupling takes: the rest would be lost in rounding.
const MOST: f32 = 1.0 - 1e-5;

impl Colliders {
    /// Lets the particles of a cloth strike a body: particles that touch it, and particles that are coupled with it.
    ///
    /// Before the constraints are solved, particles that touch become coupled, and coupled particles that are near stay so. After the
    /// solve, coupled particles stay so if they were pressed on the body.
    pub fn strike(
        &self,
        (collider, index): (&MovingCollider, usize),
        phase: Phase,
        substep: &Substep,
        cloth: &mut ClothData,
        cache: &mut ContactCache,
    ) {
        let (frame, material) = (&*cloth.frame, cloth.coefficients);
        let Some(mut proxy) = cache.bodies.list.get(index).copied() else {
            return;
        };
        let friction = combined_friction(collider.friction, material.friction);
        let Some(mut struck) = self.struck((collider, index), friction, &mut proxy, substep) else {
            return;
        };
        let margin = collider.margin + material.margin;
        let particles = &mut *cloth.particles;
        let mut couplings = mem::take(&mut cache.couplings);
        let old = group(&couplings, collider);

        let mut found = mem::take(&mut cache.found);
        found.clear();
        found.extend(couplings[old.clone()].iter().map(|c| c.particle));
        let (poses, len) = (struck.poses(frame), particles.len());
        let motion = struck.motion(frame);
        let mut start = 0;
        while let Some(range) = cache.next(&collider.solid, poses, margin, start, len) {
            start = range.end;
            collider.prepare(&motion, margin, particles, cache, substep, range.clone());
            collider.find_touching(&motion, margin, particles, cache, range, &mut found);
        }
        found.sort_unstable();
        found.dedup();
        found.retain(|&i| i < len);

        let last = phase == Phase::Final;
        for &i in &found {
            let known = couplings[old.clone()].binary_search_by_key(&i, |c| c.particle);
            let known = known.ok().map(|k| couplings[old.start + k]);
            let path = [
                particles.state.previous_position.get(i),
                particles.state.position.get(i),
            ];
            let contact = collider.nearest(&struck.motion(frame), margin, cache, i, path);
            if contact.depth <= 0.0 && (known.is_none() || contact.depth < -LEAVING) {
                continue;
            }
            let w = particles.input.inv_mass[i];
            let before = last.then(|| known.map_or(0.0, |coupling| coupling.pressed));
            let Particles {
                state:
                    State {
                        position,
                        previous_position,
                        ..
                    },
                ..
            } = &mut *particles;
            let path = [position, previous_position];
            let impulse = struck.strike(contact, frame, (i, w), before, path);
            let pressed = impulse + before.unwrap_or(0.0);
            if w > 0.0 && (pressed > 0.0 || !last) {
                let collider = collider.id;
                couplings.push(Coupling::new(collider, index, i, contact.normal, pressed));
            }
        }
        couplings.drain(old);
        let points = [
            &particles.state.position,
            &particles.state.previous_position,
        ];
        cache.update_each(substep.level, points, &found);
        cache.found = found;
        cache.couplings = couplings;
        cache.bodies.list[index] = proxy;
    }

    /// Shares bodies out to the particles that are coupled with them, for the constraints.
    pub fn share_out(&self, substep: &Substep, cloth: &mut ClothData, cache: &mut ContactCache) {
        let mut couplings = mem::take(&mut cache.couplings);
        // A particle that no longer comes near a collider touches it no more.
        couplings.retain(|coupling| self.find(coupling, cache).is_some());
        let bodies = &mut cache.bodies.list;
        bodies.iter_mut().for_each(|proxy| proxy.coupled = 0);
        for coupling in &couplings {
            bodies[coupling.body].coupled += 1;
        }
        let frame = &*cloth.frame;
        let Particles {
            state: State {
                previous_position, ..
            },
            input: Input { inv_mass, .. },
            scratch: Scratch { contacts, .. },
            ..
        } = &mut *cloth.particles;
        contacts.pressed.clear();
        if !couplings.is_empty() {
            contacts.pressed.resize(inv_mass.len(), 0.0);
        }
        for group in couplings.chunk_by_mut(|a, b| a.collider == b.collider) {
            let body = group[0].body;
            let mut proxy = cache.bodies.list[body];
            let count = proxy.coupled as f32;
            let Some(collider) = self.find(&group[0], cache) else {
                continue;
            };
            let Some(struck) = self.struck((collider, body), 0.0, &mut proxy, substep) else {
                continue;
            };
            for coupling in group {
                let i = coupling.particle;
                let before = frame.to_world(previous_position.get(i));
                let along = frame.vector_to_world(coupling.normal);
                let w = inv_mass[i];
                let share = w / (w + count * struck.inv_mass_at(before, along));
                let share = share.min(MOST);
                coupling.mass = (share / (w * (1.0 - share))).max(f32::MIN_POSITIVE);
                // A particle that touches another collider as well has only that contact in the constraints.
                if contacts.depth[i] == 0.0 {
                    coupling.share = share.sqrt();
                    contacts.normal.set(i, coupling.share * coupling.normal);
                    contacts.any = true;
                }
            }
        }
        cache.couplings = couplings;
    }

    /// Gives to bodies the impulses of the constraints on particles that are coupled with them.
    pub fn hand_over(&self, substep: &Substep, cloth: &mut ClothData, cache: &mut ContactCache) {
        let mut couplings = mem::take(&mut cache.couplings);
        let frame = &*cloth.frame;
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    ..
                },
            input: Input { inv_mass, .. },
            scratch: Scratch { contacts, .. },
            ..
        } = &mut *cloth.particles;
        let pins = motion_of_pins(inv_mass, [previous_position, position]);
        for group in couplings.chunk_by_mut(|a, b| a.collider == b.collider) {
            let body = group[0].body;
            let Some(mut proxy) = cache.bodies.list.get(body).copied() else {
                continue;
            };
            let Some(collider) = self.find(&group[0], cache) else {
                continue;
            };
            let Some(mut struck) = self.struck((collider, body), 0.0, &mut proxy, substep) else {
                continue;
            };
            let margin = collider.margin + cloth.coefficients.margin;
            let [from, to] = struck.poses(frame);
            let motion = struck.motion(frame);
            let mut pulled = Pull::default();
            for coupling in &mut *group {
                let i = coupling.particle;
                let mut pushed = coupling.share * contacts.pressed.get(i).copied().unwrap_or(0.0);
                let mut held = coupling.held.max(0.0);
                let path = [previous_position.get(i), position.get(i)];
                let meets = collider.nearest(&motion, margin, cache, i, path).depth >= 0.0;
                if pushed > 0.0 || !meets {
                    let to = path[1] + coupling.normal * (inv_mass[i] * pushed);
                    position.set(i, to);
                    (pushed, held) = (0.0, 0.0);
                }
                coupling.held = held * coupling.mass - pushed;
                coupling.pressed += coupling.held;
                let point = from.inverse() * path[0];
                let displacement = to * point - path[0] - pins.unwrap_or(Vec3::ZERO);
                let along = frame.vector_to_world(coupling.normal);
                pulled.add(
                    struck.arm(frame.to_world(path[0])),
                    along * -coupling.held,
                    coupling.held * coupling.normal.dot(displacement),
                );
            }
            // The part by which pins pull back an earlier excess gives the body no velocity.
            let stopped = pins.map_or(1.0, |_| struck.stopped_by(&pulled));
            for coupling in group {
                let before = frame.to_world(previous_position.get(coupling.particle));
                let pull = frame.vector_to_world(coupling.normal) * -mem::take(&mut coupling.held);
                struck.push(before, pull * stopped);
                struck.shift(before, pull * (1.0 - stopped));
            }
            cache.bodies.list[body] = proxy;
        }
        contacts.pressed.clear();
        cache.couplings = couplings;
    }

    /// Collider that a particle is coupled with, if it is near and belongs to that body.
    fn find(&self, coupling: &Coupling, cache: &ContactCache) -> Option<&MovingCollider> {
        let near = cache.near.iter().filter_map(|&k| self.colliders.get(k));
        near.into_iter()
            .find(|c| c.id == coupling.collider && c.body == Some(coupling.body))
    }

    /// State of a body in a substep.
    fn struck<'a>(
        &'a self,
        (collider, index): (&MovingCollider, usize),
        friction: f32,
        proxy: &'a mut Proxy,
        substep: &Substep,
    ) -> Option<Struck<'a>> {
        let body = self.bodies.get(index)?;
        let (start, end) = substep.fractions();
        let given = [collider.at(start), collider.at(end)];
        let local = collider.end.inverse() * body.center_of_mass;
        Some(Struck {
            body,
            proxy,
            given,
            center: given[1] * local,
            center_before: given[0] * local,
            friction,
            seconds: substep.seconds,
        })
    }
}

/// Mean displacement of the held particles during the substep \[m\]; `None` without any.
fn motion_of_pins(inv_mass: &[f32], [from, to]: [&Points; 2]) -> Option<Vec3> {
    let (mut sum, mut count) = (Vec3::ZERO, 0);
    for (i, _) in inv_mass.iter().enumerate().filter(|(_, w)| **w == 0.0) {
        sum += to.get(i) - from.get(i);
        count += 1;
    }
    (count > 0).then(|| sum / count as f32)
}

/// Range of the couplings of a collider, which lie side by side in the order of particles.
fn group(couplings: &[Coupling], collider: &MovingCollider) -> Range<usize> {
    let name = collider.id;
    let is_own = |coupling: &Coupling| coupling.collider == name;
    let first = couplings.iter().position(is_own).unwrap_or(0);
    let count = couplings[first..].iter().take_while(|c| is_own(c)).count();
    first..first + count
}
