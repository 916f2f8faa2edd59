//! Gives Rapier's bodies what cloth did to them.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_rapier3d::{
    dynamics::RapierRigidBodyHandle,
    geometry::RapierColliderHandle,
    parry::math::Pose,
    plugin::{
        context::{RapierContextColliders, RapierContextEntityLink, RapierRigidBodySet},
        systems::writeback_rigid_bodies,
    },
    rapier::dynamics::RigidBody,
};
use bevy_time::Time;
use tailorbird_bridge::{ClothLoad, SleepLimits, TrackedPose, moved};
use tailorbird_cloth::{collider::ClothReaction, prelude::*};
use tracing::error;

use crate::collect::{inverse_mass, pose};

/// Part of the speed at which a body may sleep, below which cloth gives it impulses alone. Rapier keeps whatever is put to
/// another place awake, be it a micrometre further, and so a crate under a tablecloth would never sleep.
const STILL: f32 = 0.2;

/// Gives bodies the impulses and the displacements that cloth gave them, wakes those that it really pushes, and notes where colliders are
/// then.
pub(crate) fn apply_reactions(
    time: Res<Time>,
    settings: Res<ClothSettings>,
    reactions: Res<ClothReactions>,
    mut worlds: Query<(&RapierContextColliders, &mut RapierRigidBodySet)>,
    mut bodies: Query<(
        Entity,
        &RapierRigidBodyHandle,
        &RapierContextEntityLink,
        &mut ClothLoad,
    )>,
    mut colliders: Query<(
        &RapierColliderHandle,
        &RapierContextEntityLink,
        &mut TrackedPose,
    )>,
) {
    let seconds = time.delta_secs();
    for (entity, handle, link, mut load) in &mut bodies {
        let Ok((_, mut set)) = worlds.get_mut(link.0) else {
            continue;
        };
        let reaction = reactions.get(entity);
        let set = &mut set.bypass_change_detection().bodies;
        let pushable = |body: &RigidBody| body.is_dynamic() && body.is_enabled();
        if seconds > 0.0 && set.get(handle.0).is_some_and(pushable) {
            // Whatever is borrowed to be changed is looked at again in the engine's next step.
            let Some(body) = set.get(handle.0) else {
                continue;
            };
            let change = answer(body, &mut load, reaction, seconds);
            if let (Some(change), Some(body)) = (change, set.get_mut(handle.0)) {
                change.apply(body);
            }
        }
    }
    for (handle, link, mut track) in &mut colliders {
        if let Ok((set, bodies)) = worlds.get(link.0)
            && let Some(collider) = set.colliders.get(handle.0)
        {
            track.set(pose(collider, bodies), seconds, settings.teleport_speed);
        }
    }
}

/// Writes `Transform` and `Velocity` of bodies that cloth moved.
pub(crate) fn write_transforms(world: &mut World) {
    if world.resource::<ClothReactions>().iter().len() > 0
        && let Err(error) = world.run_system_cached(writeback_rigid_bodies)
    {
        error!("transforms were not written: {error}");
    }
}

/// Change of a body.
struct Change {
    linear_velocity: Vec3,
    angular_velocity: Vec3,
    position: Option<Pose>,
    wakes: bool,
}

impl Change {
    fn apply(self, body: &mut RigidBody) {
        if self.wakes {
            body.wake_up(true);
        }
        body.set_linvel(self.linear_velocity, false);
        body.set_angvel(self.angular_velocity, false);
        if let Some(position) = self.position {
            body.set_position(position, false);
        }
    }
}

/// Answer of a body to the push of a step.
fn answer(
    body: &RigidBody,
    load: &mut ClothLoad,
    reaction: Option<&ClothReaction>,
    seconds: f32,
) -> Option<Change> {
    let (inv_mass, inv_inertia) = inverse_mass(body);
    let activation = body.activation();
    let limits = SleepLimits {
        linear: activation.normalized_linear_threshold,
        angular: activation.angular_threshold,
        seconds: activation.time_until_sleep,
    };
    if body.is_sleeping() {
        let mass = (inv_mass, inv_inertia);
        let (linear, angular) = load.disturb(reaction, mass, seconds, limits)?;
        return Some(Change {
            linear_velocity: body.linvel() + linear,
            angular_velocity: body.angvel() + angular,
            position: None,
            wakes: true,
        });
    }
    load.carry(reaction, seconds, limits.seconds);
    let reaction = reaction?;
    let at = body.position();
    let (translation, rotation) = moved(
        reaction,
        (at.translation, at.rotation),
        body.center_of_mass(),
    );
    let still = reaction.translation.length() <= STILL * limits.linear.max(0.0) * seconds
        && reaction.rotation.length() <= STILL * limits.angular.max(0.0) * seconds;
    Some(Change {
        linear_velocity: body.linvel() + inv_mass * reaction.impulse,
        angular_velocity: body.angvel() + inv_inertia * reaction.angular_impulse,
        position: (!still).then(|| Pose::from_parts(translation, rotation)),
        wakes: false,
    })
}
