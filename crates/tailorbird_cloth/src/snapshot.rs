//! Snapshots: going back to an earlier step, for rollback.

use bevy_ecs::{component::Mutable, prelude::*};

use crate::{
    attachment::{ClothAttachedParticles, ClothAttachmentForce, ClothAttachmentState},
    bounds::ClothBounds,
    collider::ClothColliderState,
    error::ClothStatus,
    forces::ClothForces,
    frame::ClothFrame,
    grab::ClothGrab,
    motion::{ClothMotionState, ClothTargetSamples},
    normals::ClothNormals,
    particles::ClothParticles,
    reaction::ClothPinForces,
    sampling::{ClothFrameClock, ClothSampledMotion},
    sleep::ClothSleepState,
    step::ClothStep,
    tethers::ClothTethers,
    topology::ClothTopology,
    wind::ClothWindState,
};

/// The values of a component, by entity.
type Values<C> = Vec<(Entity, C)>;

macro_rules! snapshot {
    (components { $($component:ident: $Component:ty,)* } resources { $($resource:ident: $Resource:ty,)* }) => {
        /// Everything that the next step depends on and that this crate writes: of all cloths, what holds them, colliders, and the clocks.
        ///
        /// A step after [`restore`](Self::restore) gives the same bits as the step after [`take`](Self::take), as long as the game puts
        /// back what it wrote itself: transforms, its own systems' state, `Time`, and whatever it changed meanwhile of [`Cloth`],
        /// [`ClothPins`], materials, forces on bodies and the other components that it set. Writing equal values again changes nothing.
        ///
        /// Between steps: taken from a system that runs before [`ClothSystems::Prepare`] or after [`ClothSystems::Writeback`]. It takes as
        /// much memory as the cloths do; topologies are shared.
        ///
        /// Not held, as others write it too: [`ClothSettings`](crate::settings::ClothSettings) (a single step counts down in it),
        /// attachments that broke meanwhile and are despawned (spawned again, they hold on anew: close to, but not the same bits), colliders that a physics engine has given for the step
        /// already, and `TrackedPose` and `ClothLoad` of the bridges to physics engines, which are to be rolled back with its bodies.
        /// Restore between frames, not within a step of the fixed loop.
        ///
        /// Entities are told by their ids, so a snapshot is good for the world that it was taken from, and for another one that spawned the
        /// same entities in the same order. A cloth that is gone is left out; one that was spawned since stays as it is: despawn it.
        ///
        /// ```
        /// # use bevy_ecs::prelude::*;
        /// # use tailorbird_cloth::prelude::*;
        /// # let mut world = World::new();
        /// let saved = ClothSnapshot::take(&mut world);
        /// // ... some steps later, when the input of another player turns out to have been another one:
        /// saved.restore(&mut world);
        /// ```
        ///
        /// [`Cloth`]: crate::cloth::Cloth
        /// [`ClothPins`]: crate::pins::ClothPins
        /// [`ClothSystems::Prepare`]: crate::schedule::ClothSystems::Prepare
        /// [`ClothSystems::Writeback`]: crate::schedule::ClothSystems::Writeback
        #[derive(Clone, Debug, Default)]
        pub struct ClothSnapshot {
            $($component: Values<$Component>,)*
            $($resource: Option<$Resource>,)*
        }

        impl ClothSnapshot {
            /// Notes the state of all cloths of a world.
            pub fn take(world: &mut World) -> Self {
                Self {
                    $($component: take_values(world),)*
                    $($resource: world.get_resource().cloned(),)*
                }
            }

            /// Puts all cloths of a world back to this state.
            pub fn restore(&self, world: &mut World) {
                $(restore_values(world, &self.$component);)*
                let restores = world.get_resource().map_or(0, |step: &ClothStep| step.restores);
                $(if let Some(value) = &self.$resource {
                    world.insert_resource(value.clone());
                })*
                if let Some(mut step) = world.get_resource_mut::<ClothStep>() {
                    step.restores = restores + 1;
                }
            }
        }
    };
}

snapshot! {
    components {
    particles: ClothParticles,
    topologies: ClothTopology,
    frames: ClothFrame,
    rests: ClothSleepState,
    tethers: ClothTethers,
    attached: ClothAttachedParticles,
    attachments: ClothAttachmentState,
    attachment_forces: ClothAttachmentForce,
    limits: ClothMotionState,
    targets: ClothTargetSamples,
    grabs: ClothGrab,
    forces: ClothForces,
    pin_forces: ClothPinForces,
    bounds: ClothBounds,
    normals: ClothNormals,
    statuses: ClothStatus,
    motions: ClothSampledMotion,
    collider_poses: ClothColliderState,
    }
    resources {
    step: ClothStep,
    wind: ClothWindState,
    clock: ClothFrameClock,
    }
}

fn take_values<C: Component + Clone>(world: &mut World) -> Values<C> {
    let mut query = world.query::<(Entity, &C)>();
    let values = query.iter(world);
    values
        .map(|(entity, value)| (entity, value.clone()))
        .collect()
}

fn restore_values<C: Component<Mutability = Mutable> + Clone>(
    world: &mut World,
    values: &Values<C>,
) {
    for (entity, value) in values {
        if let Some(mut current) = world.get_mut::<C>(*entity) {
            current.clone_from(value);
        } else if let Ok(mut entity) = world.get_entity_mut(*entity) {
            entity.insert(value.clone());
        }
    }
}

#[cfg(test)]
mod tests;
