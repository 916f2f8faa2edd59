//! Looks where things are, at the start of each frame and at both ends of each step.

use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time, Virtual};
use bevy_transform::{components::Transform, helper::TransformHelper};

use super::{
    ClothFrameClock, ClothMotionTeleported, ClothSampledMotion, FrameKind, LAPSE, clock::DEPTH,
    curve::between,
};
use crate::{frame::ClothFrame, settings::ClothSettings, step::ClothStep};

/// Puts [`ClothSampledMotion`] on the parents of what has it.
pub(crate) fn sample_parents(
    new: Query<
        Entity,
        (
            With<ClothSampledMotion>,
            Or<(Added<ClothSampledMotion>, Changed<ChildOf>)>,
        ),
    >,
    parents: Query<&ChildOf>,
    unsampled: Query<(), (With<Transform>, Without<ClothSampledMotion>)>,
    mut commands: Commands,
) {
    for entity in &new {
        for parent in parents.iter_ancestors(entity) {
            if unsampled.contains(parent) {
                commands
                    .entity(parent)
                    .try_insert_if_new(ClothSampledMotion::default());
            }
        }
    }
}

/// Tells all that moves a cloth that it was put elsewhere, where the cloth's frame was told.
pub(crate) fn pass_on_teleports(
    frames: Query<(Entity, &ClothFrame)>,
    parents: Query<&ChildOf>,
    mut motions: Query<&mut ClothSampledMotion>,
) {
    for (entity, _) in frames.iter().filter(|(_, frame)| frame.is_asked()) {
        for entity in std::iter::once(entity).chain(parents.iter_ancestors(entity)) {
            if let Ok(mut motion) = motions.get_mut(entity) {
                motion.asked = true;
            }
        }
    }
}

/// Notes where things are at the start of a frame, before its steps: where the frame before left them.
pub(crate) fn see_frame(
    mut clock: ResMut<ClothFrameClock>,
    time: Res<Time<Virtual>>,
    settings: Res<ClothSettings>,
    helper: TransformHelper,
    mut things: Query<(&Transform, Option<&ChildOf>, &mut ClothSampledMotion)>,
) {
    clock.begin_frame(time.elapsed(), time.delta());
    let speed = settings.valid_teleport_speed();
    let ClothFrameClock {
        kind,
        frame,
        replaces,
        ..
    } = *clock;
    for (place, child, mut motion) in &mut things {
        let parent = child.map(ChildOf::parent);
        let known = motion.frame + 1 == frame && motion.parent == parent;
        motion.frame = frame;
        if !known || kind == FrameKind::First {
            motion.restart(place, parent);
            continue;
        }
        let before = motion.frames[0];
        match kind {
            FrameKind::First => {}
            FrameKind::Start => motion.frames[0] = *place,
            FrameKind::Still => motion.take_along([&before, place]),
            FrameKind::Hitch => {
                let moved = motion.moved_between([&before, place]);
                motion.take_along([&before, &moved]);
                motion.see(place, replaces);
            }
            FrameKind::Passed(seconds) => {
                if motion.asked {
                    let moved = motion.moved_between([&before, place]);
                    motion.take_along([&before, &moved]);
                } else if motion.fixed[0] == 0 {
                    let moved = parent.filter(|_| before.translation != place.translation);
                    let limits = [seconds, speed, metre_of(moved, &helper)];
                    if let Some(start) = motion.hops.came_from([&before, place], limits) {
                        motion.take_along([&before, &start]);
                        motion.hopped = true;
                    }
                }
                motion.see(place, replaces);
            }
        }
    }
}

/// Length of a unit of a parent's space in the world \[m\].
fn metre_of(parent: Option<Entity>, helper: &TransformHelper) -> f32 {
    parent
        .and_then(|parent| helper.compute_global_transform(parent).ok())
        .map(|place| place.affine().matrix3.determinant().abs().cbrt())
        .filter(|metre| *metre > 0.0 && metre.is_finite())
        .unwrap_or(1.0)
}

/// Notes where things are before the fixed loop moves them.
pub(crate) fn begin_fixed_step(
    mut clock: ResMut<ClothFrameClock>,
    mut things: Query<(&Transform, &mut ClothSampledMotion)>,
) {
    clock.looping = true;
    for (place, mut motion) in &mut things {
        motion.began = *place;
    }
}

/// Notes what the fixed loop moved after cloth had stepped.
pub(crate) fn end_fixed_step(
    mut clock: ResMut<ClothFrameClock>,
    mut things: Query<(&Transform, &mut ClothSampledMotion)>,
) {
    clock.looping = false;
    for (place, mut motion) in &mut things {
        motion.note_moves(place);
    }
}

/// Finds out where things are at both ends of the step.
pub(crate) fn sample_motion(
    mut clock: ResMut<ClothFrameClock>,
    step: Res<ClothStep>,
    (time, fixed): (Option<Res<Time<Virtual>>>, Option<Res<Time<Fixed>>>),
    settings: Res<ClothSettings>,
    helper: TransformHelper,
    mut things: Query<(
        Entity,
        &Transform,
        Option<&ChildOf>,
        &mut ClothSampledMotion,
    )>,
    mut messages: MessageWriter<ClothMotionTeleported>,
) {
    clock.step += 1;
    if let (Some(time), Some(fixed)) = (time, fixed) {
        clock.moment = clock.moment_at(time.elapsed().saturating_sub(fixed.overstep()));
    }
    let ClothFrameClock {
        looping,
        moment,
        step: number,
        ..
    } = *clock;
    let speed = settings.valid_teleport_speed();
    for (entity, place, child, mut motion) in &mut things {
        let parent = child.map(ChildOf::parent);
        let known = motion.step + 1 == number && motion.parent == parent;
        motion.step = number;
        if !known {
            motion.restart(place, parent);
        }
        motion.from = motion.now;
        motion.teleported = std::mem::take(&mut motion.hopped);
        if looping {
            motion.fixed = motion.fixed.map(|steps| steps.saturating_sub(1));
            motion.note_moves(place);
        } else {
            motion.fixed = [LAPSE; 3];
        }
        let sampled = between(&motion.frames, &moment);
        let mut now = motion.moved_between([place, &sampled]);
        let told = std::mem::take(&mut motion.asked);
        if told {
            now = *place;
            motion.from = now;
            motion.frames = [now; DEPTH];
        } else if motion.fixed[0] > 0 {
            let from = motion.from;
            let metre = metre_of(
                parent.filter(|_| from.translation != now.translation),
                &helper,
            );
            let limits = [step.world_seconds(), speed, metre];
            if let Some(start) = motion.hops.came_from([&from, &now], limits) {
                motion.from = start;
                motion.teleported = true;
            }
        }
        motion.now = now;
        if told || motion.teleported {
            motion.teleported = true;
            messages.write(ClothMotionTeleported { entity, told });
        }
    }
}
