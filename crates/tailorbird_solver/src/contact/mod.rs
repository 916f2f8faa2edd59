//! Colliders, and what particles do at them.

pub mod around;
pub mod bodies;
pub mod colliders;
mod coupling;
mod narrow;
pub mod near;
pub mod sight;
pub mod solid;
pub mod surface;

use std::mem;

use solid::Kind;

use crate::{
    cloth::Cloth,
    coefficients::Method,
    contact::colliders::{Colliders, MovingCollider},
    kernels::contact::{Phase, Touch},
    particles::{Particles, State},
    substep::Substep,
};

impl Colliders {
    /// What [`find_contacts`] does for one cloth.
    pub fn approach(&self, substep: &Substep, cloth: &mut Cloth) {
        let particles = &mut *cloth.particles;
        let bodies = &mut particles.scratch.around.bodies;
        bodies.advance(&self.bodies, substep);
        particles.state.touch = Touch {
            overlaps: particles.state.touch.overlaps,
            ..Touch::default()
        };
        if cloth.method != Method::Lines || self.colliders.is_empty() {
            particles.scratch.contacts.clear();
            particles.scratch.around.couplings.clear();
            return;
        }
        let len = particles.len();
        particles.scratch.contacts.reset(len);
        self.collide(Phase::Approach, None, substep, cloth);
        let mut around = mem::take(&mut cloth.particles.scratch.around);
        self.share_out(substep, cloth, &mut around);
        cloth.particles.scratch.around = around;
        cloth.particles.state.touch.any = cloth.particles.scratch.contacts.any;
    }

    /// Keeps the particles of one cloth out of all colliders after the constraints were solved: kind by kind, in the order of [`Kind::ALL`].
    pub fn collide_all(&self, substep: &Substep, cloth: &mut Cloth) {
        self.collide(Phase::Final, Some(&Kind::ALL), substep, cloth);
    }

    /// Keeps the particles of one cloth out of all colliders, in the order of their list, or out of those of some kinds, kind by kind.
    pub fn collide(
        &self,
        phase: Phase,
        kinds: Option<&[Kind]>,
        substep: &Substep,
        cloth: &mut Cloth,
    ) {
        let is_of = |collider: &MovingCollider, kind: Option<Kind>| {
            kind.is_none_or(|kind| collider.solid.kind() == kind)
        };
        let meant = |collider: &MovingCollider| {
            kinds.is_none_or(|kinds| kinds.contains(&collider.solid.kind()))
        };
        let contacts = &mut cloth.particles.scratch.contacts;
        let loaded = phase == Phase::Final && !contacts.pressed.is_empty();
        if !loaded && !self.colliders.iter().any(meant) {
            return;
        }
        let mut around = mem::take(&mut cloth.particles.scratch.around);
        around.sights = mem::take(&mut cloth.particles.state.sights);
        around.passing = mem::take(&mut cloth.particles.state.passing);
        if loaded {
            self.hand_over(substep, cloth, &mut around);
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
        let stage = (substep.index, phase == Phase::Final);
        let margin = cloth.coefficients.margin;
        let stage = (substep.level, stage);
        around.look(self, cloth.frame, layers, margin, stage, points);
        let (passes, near) = (kinds.map_or(1, <[Kind]>::len), around.near.len());
        for (pass, k) in (0..passes).flat_map(|pass| (0..near).map(move |k| (pass, k))) {
            let kind = kinds.map(|kinds| kinds[pass]);
            let near = self.colliders.get(around.near[k]);
            let Some(collider) = near.filter(|collider| is_of(collider, kind)) else {
                continue;
            };
            if let Some(body) = collider.body {
                self.strike((collider, body), phase, substep, cloth, &mut around);
            } else {
                collider.collide(phase, substep, cloth, &mut around);
            }
        }
        cloth.particles.state.sights = mem::take(&mut around.sights);
        cloth.particles.state.passing = mem::take(&mut around.passing);
        cloth.particles.scratch.around = around;
    }
}
