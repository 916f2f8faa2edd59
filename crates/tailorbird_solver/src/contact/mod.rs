//! Colliders, and their contacts with particles.

pub mod bodies;
pub mod broad_phase;
pub mod cache;
pub mod colliders;
mod coupling;
mod narrow_phase;
pub mod planes;
pub mod solid;
pub mod surface;

use std::mem;

use solid::SolidKind;

use crate::{
    cloth::ClothData,
    coefficients::Method,
    contact::colliders::{Colliders, MovingCollider},
    kernels::contact::{Phase, Touch},
    particles::{Particles, State},
    substep::Substep,
};

impl Colliders {
    /// Pushes particles out of colliders before the constraints are solved, and notes contacts.
    pub fn approach(&self, substep: &Substep, cloth: &mut ClothData) {
        let particles = &mut *cloth.particles;
        let bodies = &mut particles.scratch.cache.bodies;
        bodies.advance(&self.bodies, substep);
        particles.state.touch = Touch {
            overlaps: particles.state.touch.overlaps,
            ..Touch::default()
        };
        if cloth.method != Method::Lines || self.colliders.is_empty() {
            particles.scratch.contacts.clear();
            particles.state.couplings.clear();
            return;
        }
        let len = particles.len();
        particles.scratch.contacts.reset(len);
        self.collide(Phase::Approach, None, substep, cloth);
        let mut cache = mem::take(&mut cloth.particles.scratch.cache);
        cache.couplings = mem::take(&mut cloth.particles.state.couplings);
        self.share_out(substep, cloth, &mut cache);
        cloth.particles.state.couplings = mem::take(&mut cache.couplings);
        cloth.particles.scratch.cache = cache;
        cloth.particles.state.touch.any = cloth.particles.scratch.contacts.any;
    }

    /// Keeps the particles of one cloth out of all colliders after the constraints were solved: kind by kind, in the order of [`SolidKind::ALL`].
    pub fn collide_all(&self, substep: &Substep, cloth: &mut ClothData) {
        self.collide(Phase::Final, Some(&SolidKind::ALL), substep, cloth);
    }

    /// Keeps the particles of one cloth out of colliders: with `kinds` out of colliders of these kinds, kind by kind, as the systems of an
    /// ECS do it; without out of all, in the order of their list.
    pub fn collide(
        &self,
        phase: Phase,
        kinds: Option<&[SolidKind]>,
        substep: &Substep,
        cloth: &mut ClothData,
    ) {
        let meant = |collider: &MovingCollider| {
            kinds.is_none_or(|kinds| kinds.contains(&collider.solid.kind()))
        };
        let contacts = &mut cloth.particles.scratch.contacts;
        let loaded = phase == Phase::Final && !contacts.pressed.is_empty();
        if !loaded && !self.colliders.iter().any(meant) {
            return;
        }
        let mut cache = mem::take(&mut cloth.particles.scratch.cache);
        cache.planes = mem::take(&mut cloth.particles.state.planes);
        cache.passing = mem::take(&mut cloth.particles.state.passing);
        cache.couplings = mem::take(&mut cloth.particles.state.couplings);
        if loaded {
            self.hand_over(substep, cloth, &mut cache);
        }
        let layers = cloth.layers;
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    ..
                },
            ..
        } = &*cloth.particles;
        let points = [position, previous_position];
        let stage = (substep.level, (substep.index, phase == Phase::Final));
        let margin = cloth.coefficients.margin;
        cache.find_colliders(self, cloth.frame, layers, margin, stage, points);
        for pass in 0..kinds.map_or(1, <[SolidKind]>::len) {
            let kind = kinds.map(|kinds| kinds[pass]);
            for k in 0..cache.near.len() {
                let Some(collider) = self.colliders.get(cache.near[k]) else {
                    continue;
                };
                if kind.is_some_and(|kind| collider.solid.kind() != kind) {
                    continue;
                }
                if let Some(body) = collider.body {
                    self.strike((collider, body), phase, substep, cloth, &mut cache);
                } else {
                    collider.collide(phase, substep, cloth, &mut cache);
                }
            }
        }
        cloth.particles.state.planes = mem::take(&mut cache.planes);
        cloth.particles.state.passing = mem::take(&mut cache.passing);
        cloth.particles.state.couplings = mem::take(&mut cache.couplings);
        cloth.particles.scratch.cache = cache;
    }
}
