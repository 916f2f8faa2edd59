//! Gives avian's bodies what cloth did to them.

use avian3d::{
    dynamics::solver::islands::WakeBody,
    physics_transform::{PhysicsTransformConfig, position_to_transform},
    prelude::*,
};
use bevy_ecs::prelude::*;
use bevy_time::Time;
use tailorbird_bridge::{ClothLoad, SleepLimits, TrackedPose, moved};
use tailorbird_cloth::{collider::ClothReaction, prelude::*};
use tracing::error;

use crate::collect::{Place, inverse_mass};

/// A rigid body, to write.
#[derive(bevy_ecs::query::QueryData)]
#[query_data(mutable)]
pub(crate) struct PushedBody {
    entity: Entity,
    kind: &'static RigidBody,
    position: &'static mut Position,
    rotation: &'static mut Rotation,
    linear: &'static mut LinearVelocity,
    angular: &'static mut AngularVelocity,
    mass: &'static ComputedMass,
    inertia: &'static ComputedAngularInertia,
    center: &'static ComputedCenterOfMass,
    locked: Option<&'static LockedAxes>,
    threshold: Option<&'static SleepThreshold>,
    load: &'static mut ClothLoad,
    sleeps: Has<Sleeping>,
}

/// Gives bodies the impulses and the displacements that cloth gave them, and wakes those that it really pushes.
pub(crate) fn apply_reactions(
    time: Res<Time>,
    time_to_sleep: Option<Res<TimeToSleep>>,
    reactions: Res<ClothReactions>,
    mut bodies: Query<PushedBody, Without<RigidBodyDisabled>>,
    mut commands: Commands,
) {
    let seconds = time.delta_secs();
    if seconds <= 0.0 {
        return;
    }
    let memory = time_to_sleep.map_or(0.5, |time| time.0);
    for mut body in &mut bodies {
        if body.kind.is_dynamic() {
            let reaction = reactions.get(body.entity);
            body.react(reaction, seconds, memory, &mut commands);
        }
    }
}

/// Writes the `Transform`s of bodies that cloth moved.
pub(crate) fn write_transforms(world: &mut World) {
    let wanted = world
        .get_resource::<PhysicsTransformConfig>()
        .is_some_and(|config| config.position_to_transform);
    if wanted
        && world.resource::<ClothReactions>().iter().len() > 0
        && let Err(error) = world.run_system_cached(position_to_transform)
    {
        error!("transforms were not written: {error}");
    }
}

/// Notes where colliders are after the step.
pub(crate) fn track_colliders(
    time: Res<Time>,
    settings: Res<ClothSettings>,
    bodies: Query<(&Position, &Rotation), With<RigidBody>>,
    mut colliders: Query<(Place, &mut TrackedPose)>,
) {
    let (seconds, speed) = (time.delta_secs(), settings.teleport_speed);
    for (place, mut track) in &mut colliders {
        let body = place.body().and_then(|body| bodies.get(body).ok());
        let pose = place.pose(body.map(|(position, rotation)| (position.0, rotation.0)));
        track.set(pose, seconds, speed);
    }
}

impl PushedBodyItem<'_, '_> {
    fn react(
        &mut self,
        reaction: Option<&ClothReaction>,
        seconds: f32,
        memory: f32,
        commands: &mut Commands,
    ) {
        let (inv_mass, inv_inertia) =
            inverse_mass(self.mass, self.inertia, &self.rotation, self.locked);
        if self.sleeps {
            let threshold = self.threshold.copied().unwrap_or_default();
            let limits = SleepLimits {
                linear: threshold.linear,
                angular: threshold.angular,
                seconds: memory,
            };
            let mass = (inv_mass, inv_inertia);
            if let Some((linear, angular)) = self.load.disturb(reaction, mass, seconds, limits) {
                self.linear.0 += linear;
                self.angular.0 += angular;
                commands.queue_silenced(WakeBody(self.entity));
            }
            return;
        }
        self.load.carry(reaction, seconds, memory);
        let Some(reaction) = reaction else {
            return;
        };
        self.linear.0 += inv_mass * reaction.impulse;
        self.angular.0 += inv_inertia * reaction.angular_impulse;
        let at = (self.position.0, self.rotation.0);
        let center = at.0 + at.1 * self.center.0;
        let (position, rotation) = moved(reaction, at, center);
        self.position.0 = position;
        self.rotation.0 = rotation;
    }
}
