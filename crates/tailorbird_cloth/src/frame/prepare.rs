//! Moves frames with their entities.

use bevy_ecs::prelude::*;
use tailorbird_solver::step::ADVANCE;

use super::{
    ClothFrame,
    split::{check_shear, split_like},
};
use crate::{
    cloth::Cloth,
    error::{ClothErrorSource, ClothStatusOf},
    inertia::ClothInertia,
    particles::ClothParticles,
    sampling::{ClothSampledMotion, ClothSampledPoses},
    stages::StagedCloths,
    step::ClothStep,
};

/// Reads where the entities of the cloths are.
///
/// A transform that is not finite is reported, and the frame stays where it was. One that is sheared is reported, and the frame follows
/// it without the shear.
pub fn prepare_frames(
    step: Res<ClothStep>,
    poses: ClothSampledPoses,
    mut cloths: Query<
        (
            &ClothSampledMotion,
            &mut ClothFrame,
            Ref<ClothInertia>,
            &ClothParticles,
            ClothStatusOf,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    // A pause keeps what moves meanwhile from being felt, and from being a teleport.
    let seconds = if step.running() {
        [step.world_seconds(), step.seconds()]
    } else {
        [f32::INFINITY; 2]
    };
    for (own, mut frame, inertia, particles, mut status) in &mut cloths {
        if inertia.is_changed() {
            let errors = inertia.errors();
            if errors.is_empty() {
                frame.inertia = *inertia;
            }
            status.update(&commands, ClothErrorSource::Inertia, errors);
        }
        let Ok(pose) = poses.get(status.entity) else {
            continue;
        };
        let holds = particles.input.held.any_in_frame();
        let how = (pose.teleported, holds);
        let known = (frame.scale, frame.frame.end.rotation);
        let [first, last] = own.scales();
        let error = match split_like(&pose.end, last, known) {
            Ok((end, scale)) => {
                let start = split_like(&pose.start, first, known).map_or(end, |(start, _)| start);
                frame.set_scale(scale);
                frame.place([start, end], how, seconds);
                check_shear(&pose.end)
            }
            Err(error) => {
                let stay = frame.frame.end;
                if frame.placed {
                    frame.place([stay; 2], (false, holds), seconds);
                }
                Some(error)
            }
        };
        status.update(&commands, ClothErrorSource::Transform, error);
    }
}

/// Moves the frames on by one substep, and expresses the free particles in the moved frame; moves what is attached or held at a
/// target.
pub fn advance_frames(mut cloths: StagedCloths) {
    cloths.run(ADVANCE);
}
