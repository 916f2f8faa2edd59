//! Reactions: the effect of cloth on the bodies that it pushes.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;

use super::{ClothColliders, ClothExternalColliders};
use crate::{cloth::Cloth, particles::ClothParticles, step::ClothStep};

/// Effect of cloth on bodies in the last step: for each [`ClothColliderBody`](super::ClothColliderBody) that a cloth touched, after
/// [`ClothSystems::Simulate`](crate::schedule::ClothSystems::Simulate).
#[derive(Resource, Clone, Debug, Default)]
pub struct ClothReactions {
    pub(crate) list: Vec<(Entity, ClothReaction)>,
}

/// Effect of cloth on one body in a step, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClothReaction {
    /// Momentum given to the body \[N s\].
    pub impulse: Vec3,
    /// Angular momentum about its centre of mass \[N m s\].
    pub angular_impulse: Vec3,
    /// Displacement by cloth within the step \[m\], from the end pose that was set.
    pub translation: Vec3,
    /// Rotation by cloth about its centre of mass: axis times angle \[rad\].
    pub rotation: Vec3,
    /// Its velocity with that [m/s]: the velocity that was set, and the impulse times the inverse mass.
    pub linear_velocity: Vec3,
    /// Its angular velocity with that [rad/s].
    pub angular_velocity: Vec3,
}

impl ClothReactions {
    /// Effect on this body; `None` if no cloth touched it.
    pub fn get(&self, body: Entity) -> Option<&ClothReaction> {
        let found = self.list.binary_search_by_key(&body, |(entity, _)| *entity);
        found.ok().map(|i| &self.list[i].1)
    }

    /// All bodies that were touched, in the order of entities.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (Entity, &ClothReaction)> + '_ {
        self.list.iter().map(|(body, reaction)| (*body, reaction))
    }
}

/// Adds up the effect of all cloths on bodies, in the order of the cloths' entities. Without a step there is none.
pub fn gather_reactions(
    (step, colliders): (Res<ClothStep>, Res<ClothColliders>),
    mut external: ResMut<ClothExternalColliders>,
    mut reactions: ResMut<ClothReactions>,
    mut order: Local<Vec<Entity>>,
    mut cloths: Query<(Entity, &mut ClothParticles), With<Cloth>>,
) {
    if !external.is_empty() {
        // A pause: they are not for the step after it.
        external.colliders.clear();
    }
    let list = &mut reactions.bypass_change_detection().list;
    let before = list.len();
    list.clear();
    order.clear();
    for (entity, mut particles) in &mut cloths {
        let particles = &mut particles.bypass_change_detection().0;
        let bodies = &particles.scratch.cache.bodies;
        if bodies.touched() {
            order.push(entity);
        }
        if step.running {
            bodies.note_load(step.seconds(), &mut particles.state.load);
        }
    }
    order.sort_unstable();
    for entity in &*order {
        let Ok((_, mut particles)) = cloths.get_mut(*entity) else {
            continue;
        };
        let bodies = &mut particles.bypass_change_detection().0.scratch.cache.bodies;
        for (body, proxy) in colliders.bodies.iter().zip(&bodies.list) {
            if !proxy.touched {
                continue;
            }
            let at = list.binary_search_by_key(&body.body, |(entity, _)| *entity);
            let at = at.unwrap_or_else(|at| {
                let unmoved = ClothReaction {
                    linear_velocity: body.linear_velocity,
                    angular_velocity: body.angular_velocity,
                    ..ClothReaction::default()
                };
                list.insert(at, (body.body, unmoved));
                at
            });
            let sum = &mut list[at].1;
            sum.impulse += proxy.done.impulse;
            sum.angular_impulse += proxy.done.angular_impulse;
            sum.translation += proxy.done.translation;
            sum.rotation += proxy.done.rotation;
            sum.linear_velocity += body.inv_mass * proxy.done.impulse;
            sum.angular_velocity += body.inv_inertia * proxy.done.angular_impulse;
        }
        bodies.clear();
    }
    if before > 0 || !reactions.list.is_empty() {
        reactions.set_changed();
    }
}
