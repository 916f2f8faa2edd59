//! Tells of cloths that were put elsewhere.

use bevy_ecs::prelude::*;

use super::{ClothTeleportMode, ClothTeleported};
use crate::{
    cloth::Cloth, frame::ClothFrame, particles::ClothParticles, sleep::ClothSleepState,
    topology::ClothTopology,
};

/// Puts cloths that were teleported with [`ClothTeleportMode::Reset`] into their rest shape.
pub fn reset_teleported(
    mut cloths: Query<
        (
            Entity,
            &mut ClothFrame,
            &ClothTopology,
            &mut ClothParticles,
            &mut ClothSleepState,
        ),
        With<Cloth>,
    >,
    mut commands: Commands,
) {
    for (entity, mut frame, topology, mut particles, mut rest) in &mut cloths {
        let Some(mode) = frame.bypass_change_detection().take_teleport() else {
            continue;
        };
        if mode == ClothTeleportMode::Reset {
            particles.0.reset_to_rest(topology);
            rest.wake();
        }
        commands.trigger(ClothTeleported { entity, mode });
    }
}
