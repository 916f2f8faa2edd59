//! Colliders, and what particles do at them.

pub mod bodies;
mod coupling;
mod narrow;
pub mod near;
pub mod sight;
pub mod solid;
pub mod surface;

use std::mem;

use bevy_math::{Isometry3d, Mat3, Vec3};

use solid::{Kind, Solid, swept};

use crate::{
    cloth::Cloth,
    coefficients::Method,
    kernels::contact::{Phase, Touch},
    particles::{Particles, State},
    substep::Substep,
};

/// What tells a collider from others: whose it is, as bits, and which of those, with its part of a compound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ColliderId {
    /// Whose.
    pub owner: u64,
    /// Which of the owner's colliders, and which part of a compound.
    pub part: (u32, u32),
}

/// Which colliders a cloth meets, and which cloths a collider: two meet where each one's memberships share a bit with the other's filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// The layers that it is in, a bit each.
    pub memberships: u32,
    /// The layers that it meets, a bit each.
    pub filters: u32,
}

impl Layers {
    /// Whether the two meet.
    pub const fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

/// A rigid body that cloth pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// 1/mass along the axes of the world [1/kg]; 0 where it cannot move.
    pub inv_mass: Vec3,
    /// Inverse of the inertia about the centre of mass, in world axes [1/(kg m²)]; 0 does not turn.
    pub inv_inertia: Mat3,
    /// In the world, at the end of the step \[m\].
    pub center_of_mass: Vec3,
}

/// The colliders of a step with their motion.
#[derive(Clone, Debug, Default)]
pub struct Colliders {
    /// In the order in which they are solved.
    pub colliders: Vec<MovingCollider>,
    /// The boxes around them during the step, in the world \[m\].
    pub boxes: Vec<(Vec3, Vec3)>,
    /// The bodies that cloth pushes.
    pub bodies: Vec<Body>,
}

/// A simple solid during a step.
#[derive(Clone, Debug)]
pub struct MovingCollider {
    /// What tells it from others, from step to step.
    pub id: ColliderId,
    pub solid: Solid,
    pub friction: f32,
    pub margin: f32,
    pub layers: Layers,
    pub start: Isometry3d,
    pub end: Isometry3d,
    /// Which of the bodies it belongs to.
    pub body: Option<usize>,
}

impl MovingCollider {
    /// Where it is at a part of the step, in the world.
    pub fn at(&self, fraction: f32) -> Isometry3d {
        Isometry3d::new(
            self.start.translation.lerp(self.end.translation, fraction),
            self.start.rotation.slerp(self.end.rotation, fraction),
        )
    }

    /// The box around it during the step, margin included, in the world \[m\].
    pub fn around(&self) -> (Vec3, Vec3) {
        const EVERYWHERE: (Vec3, Vec3) = (Vec3::MIN, Vec3::MAX);
        let margin = Vec3::splat(self.margin);
        self.solid.range().map_or(EVERYWHERE, |range| {
            let (low, high) = swept(range, &self.start, &self.end);
            (low - margin, high + margin)
        })
    }
}

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

    /// What the systems after the constraints do for one cloth, one after the other.
    pub fn collide_all(&self, substep: &Substep, cloth: &mut Cloth) {
        for kind in [
            Kind::Sphere,
            Kind::HalfSpace,
            Kind::Capsule,
            Kind::Cuboid,
            Kind::Other,
        ] {
            self.collide(Phase::Final, Some(kind), substep, cloth);
        }
    }

    /// Keeps the particles of one cloth out of all colliders, or out of those of one kind.
    pub fn collide(&self, phase: Phase, kind: Option<Kind>, substep: &Substep, cloth: &mut Cloth) {
        let meant =
            |collider: &MovingCollider| kind.is_none_or(|kind| collider.solid.kind() == kind);
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
        for k in 0..around.near.len() {
            let Some(collider) = self.colliders.get(around.near[k]) else {
                continue;
            };
            if !meant(collider) {
                continue;
            }
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

/// Two surfaces rub with the geometric mean of their frictions: if either is slippery, so is the pair.
pub fn combined_friction(a: f32, b: f32) -> f32 {
    (a * b).max(0.0).sqrt()
}
