//! The stages that keep particles out of colliders.

use std::mem;

use bevy_ecs::prelude::*;
use tailorbird_solver::kernels::contact::Phase;

use super::{ClothColliders, snapshot::MovingCollider, solid::Kind};
use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    solver::ClothSolver,
    stages::{ClothStages, ClothStagesItem, Substep, for_each_awake},
    step::ClothStep,
};

/// Looks for contacts before the constraints are solved: pushes particles out, and notes where they touch.
///
/// For [`ClothSolver::Chains`] alone, which then moves those particles along the surface, and bodies with them that cloth
/// pushes.
pub fn find_contacts(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        colliders.approach(&substep, &mut cloth);
    });
}

macro_rules! collide_systems {
    ($($(#[$doc:meta])* $name:ident: $kind:ident,)*) => {
        $(
            $(#[$doc])*
            pub fn $name(
                step: Res<ClothStep>,
                colliders: Res<ClothColliders>,
                mut cloths: Query<ClothStages, With<Cloth>>,
            ) {
                let substep = step.in_progress();
                for_each_awake(&step, &mut cloths, &|mut cloth| {
                    colliders.collide(Phase::Final, Some(Kind::$kind), &substep, &mut cloth);
                });
            }
        )*
    };
}

collide_systems! {
    /// Keeps particles out of the spheres.
    collide_sphere: Sphere,
    /// Keeps particles out of the half-spaces.
    collide_half_space: HalfSpace,
    /// Keeps particles out of the capsules, straight and tapered.
    collide_capsule: Capsule,
    /// Keeps particles out of the boxes.
    collide_cuboid: Cuboid,
    /// Keeps particles out of cylinders, convex hulls, triangle meshes and terrain.
    collide_shape: Other,
}

impl ClothColliders {
    /// What [`find_contacts`] does for one cloth.
    pub(crate) fn approach(&self, substep: &Substep, cloth: &mut ClothStagesItem) {
        let particles = &mut *cloth.particles;
        let bodies = &mut particles.around.bodies;
        bodies.advance(&self.bodies, substep);
        if *cloth.solver != ClothSolver::Chains || self.is_empty() {
            particles.contacts.clear();
            particles.around.couplings.clear();
            return;
        }
        let len = particles.len();
        particles.contacts.reset(len);
        self.collide(Phase::Approach, None, substep, cloth);
        let mut around = mem::take(&mut cloth.particles.around);
        self.share_out(substep, cloth, &mut around);
        cloth.particles.around = around;
    }

    /// What the systems after the constraints do for one cloth, one after the other.
    pub(crate) fn collide_all(&self, substep: &Substep, cloth: &mut ClothStagesItem) {
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
    pub(crate) fn collide(
        &self,
        phase: Phase,
        kind: Option<Kind>,
        substep: &Substep,
        cloth: &mut ClothStagesItem,
    ) {
        let meant =
            |collider: &MovingCollider| kind.is_none_or(|kind| collider.solid.kind() == kind);
        let contacts = &mut cloth.particles.contacts;
        let loaded = phase == Phase::Final && !contacts.pressed.is_empty();
        if !loaded && !self.colliders.iter().any(meant) {
            return;
        }
        let mut around = mem::take(&mut cloth.particles.around);
        if loaded {
            self.hand_over(substep, cloth, &mut around);
        }
        let layers = cloth.layers.copied().unwrap_or_default();
        let ClothParticles {
            position,
            previous_position,
            ..
        } = &*cloth.particles;
        let points = [position, previous_position];
        let stage = (substep.index, phase == Phase::Final);
        let margin = cloth.material.margin();
        let stage = (substep.level, stage);
        around.look(self, &cloth.frame, layers, margin, stage, points);
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
        cloth.particles.around = around;
    }
}

/// Two surfaces rub with the geometric mean of their frictions: if either is slippery, so is the pair.
pub(super) fn combined_friction(a: f32, b: f32) -> f32 {
    (a * b).max(0.0).sqrt()
}
