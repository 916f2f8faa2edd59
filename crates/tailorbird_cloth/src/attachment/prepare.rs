//! Reads the attachments at the start of a step, and breaks them at its end.

use bevy_ecs::{prelude::*, relationship::RelationshipTarget};
use bevy_math::Vec3;
use bevy_transform::components::GlobalTransform;
use tailorbird_solver::{
    holds::Holder,
    pose::Pose,
    topology::{Topology, order::Given},
};

use super::{
    ClothAttachedParticles, ClothAttachedTo, ClothAttachment, ClothAttachmentBroken,
    ClothAttachmentForce, ClothAttachmentOf, ClothAttachmentOffset, ClothAttachmentState,
    ClothAttachments, ClothBreakReason, pose::pose_of,
};
use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    frame::ClothFrame,
    inertia::{ClothTeleportMode, ClothTeleported},
    particles::ClothParticles,
    sampling::{ClothSampledPoses, SampledPose, excess},
    sleep::ClothSleepState,
    step::ClothStep,
    topology::ClothTopology,
};

/// Reads what holds the attachments, and where it is at the end of this step.
///
/// An error of an attachment is reported for its entity, and its last valid state stays in force: the particles stay held where the target
/// was.
pub fn prepare_attachments(
    step: Res<ClothStep>,
    poses: ClothSampledPoses,
    mut cloths: Query<
        (
            Entity,
            Option<&ClothAttachments>,
            &ClothTopology,
            &ClothFrame,
            &ClothSleepState,
            &mut ClothParticles,
            &mut ClothAttachedParticles,
        ),
        With<Cloth>,
    >,
    mut attachments: Query<
        (
            Entity,
            Ref<ClothAttachment>,
            Option<&ClothAttachedTo>,
            &ClothAttachmentForce,
            &mut ClothAttachmentState,
            &mut ClothStatus,
        ),
        With<ClothAttachmentOf>,
    >,
    mut orphans: Query<
        (Entity, &mut ClothStatus),
        (With<ClothAttachment>, Without<ClothAttachmentOf>),
    >,
    commands: ParallelCommands,
) {
    for (entity, mut status) in &mut orphans {
        let error = ClothErrorKind::unrelated("ClothAttachmentOf");
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Attachment,
            [error],
        );
    }
    for (cloth, list, topology, frame, rest, mut particles, mut attached) in &mut cloths {
        if particles.is_empty() || list.is_none() && attached.is_empty() {
            continue;
        }
        let (mut changed, mut teleported) = (false, false);
        let bodies_before = attached.bodies.len();
        attached.0.clear();
        for attachment in list.into_iter().flat_map(RelationshipTarget::iter) {
            let Ok((entity, data, to, carried, mut state, mut status)) =
                attachments.get_mut(attachment)
            else {
                continue;
            };
            let mut errors = data.errors();
            if (data.is_changed() || state.valid.is_none())
                && errors.is_empty()
                && state.valid.as_ref() != Some(&*data)
            {
                state.valid = Some(ClothAttachment::clone(&data));
                state.stale = true;
            }
            let Some(&ClothAttachedTo(target)) = to else {
                if let Some(target) = state.target {
                    let broken = ClothAttachmentBroken {
                        entity: cloth,
                        attachment,
                        target,
                        force: carried.force,
                        reason: ClothBreakReason::TargetGone,
                    };
                    commands.command_scope(|commands| give_up(commands, broken));
                } else {
                    errors.push(ClothErrorKind::unrelated("ClothAttachedTo"));
                }
                let source = ClothErrorSource::Attachment;
                ClothStatus::update(&mut status, entity, &commands, source, errors);
                continue;
            };
            let sampled = poses
                .get(target)
                .map_err(|entity| ClothErrorKind::NoTransform { value: entity });
            let teleport = sampled.as_ref().is_ok_and(|sampled| sampled.teleported);
            teleported |= teleport;
            let pose = |end: fn(SampledPose) -> GlobalTransform| {
                let place = sampled.clone().map(end)?;
                pose_of(&place)
            };
            let (started, pose) = (pose(|s| s.start), pose(|s| s.end));
            let known = state.target == Some(target) && state.revision == topology.revision;
            if let Ok(pose) = pose
                && (state.stale || !known)
            {
                let started = started.as_ref().map_or(pose, |started| *started);
                state.resolve(target, [started, pose], topology, frame, &particles);
                changed = true;
            }
            let end = match pose {
                Ok(pose) => Some(pose),
                Err(error) => {
                    errors.push(error);
                    state.pose
                }
            };
            errors.extend(state.wrong.iter().cloned());
            let source = ClothErrorSource::Attachment;
            ClothStatus::update(&mut status, entity, &commands, source, errors);
            // Particles of another topology mean nothing in this one.
            let resolved = state.target.is_some() && state.revision == topology.revision;
            let Some(end) = end.filter(|_| resolved) else {
                continue;
            };
            let from = state.pose.unwrap_or(end);
            let began = started.unwrap_or(end);
            let start = began;
            let unfelt = rest.is_unseen() || !step.running();
            let seen = state.seen.replace(end);
            let carried = seen.is_some_and(|seen| seen != start);
            if carried && let Some(seen) = seen {
                state.velocity = seen.turn_to(&start) * state.velocity;
            }
            let (start, jumped) = if unfelt {
                (end, (from != end || rest.is_unseen()).then_some(from))
            } else if carried {
                (start, Some(from))
            } else {
                (from, None)
            };
            let displacement = start.displacement_to(&end);
            if rest.is_unseen() && step.running() {
                state.velocity = began.displacement_to(&end) / step.world_seconds();
            }
            let excess = if unfelt || displacement == Vec3::ZERO && teleport {
                Vec3::ZERO
            } else {
                excess(state.velocity, displacement, step.world_seconds()).0
            };
            let body = Holder {
                attachment: attachment.to_bits(),
                target: target.to_bits(),
                start,
                end,
                jumped,
                excess,
                told: displacement == Vec3::ZERO && teleport,
                pulled: Vec3::ZERO,
                substeps: 0,
            };
            let points = state.points.iter();
            let points = points.map(|&(i, point)| (topology.order.stored(i), point));
            attached.0.add(body, points, state.compliances.as_deref());
        }
        changed |= attached.bodies.len() != bodies_before;
        let mut moved = false;
        if !rest.is_unseen() {
            attached.soften(&particles);
            for body in &attached.bodies {
                if step.running()
                    && !body.told
                    && let Ok((.., mut state, _)) =
                        attachments.get_mut(Entity::from_bits(body.attachment))
                {
                    let displacement = body.start.displacement_to(&body.end);
                    state.velocity = displacement / step.world_seconds();
                }
            }
            moved = attached.take_along(frame, &mut particles);
            if moved && teleported {
                let teleported = ClothTeleported {
                    entity: cloth,
                    mode: ClothTeleportMode::KeepShape,
                };
                commands.command_scope(|mut commands| commands.trigger(teleported));
            }
        }
        changed |= attached
            .0
            .finish(frame, &mut particles.0, step.world_seconds());
        attached.0.disturbed |= changed || moved;
        if changed {
            attached.0.renew_revision();
        }
        // One that sleeps remembers where things were when it fell asleep, however slowly they creep away.
        let awake = !rest.is_asleep() || attached.disturbed;
        for body in &attached.bodies {
            if (awake || body.jumped.is_some())
                && let Ok((.., mut state, _)) =
                    attachments.get_mut(Entity::from_bits(body.attachment))
            {
                state.pose = Some(body.end);
            }
        }
    }
}

impl ClothAttachmentState {
    /// Finds the particles, and where they are held.
    fn resolve(
        &mut self,
        target: Entity,
        [started, pose]: [Pose; 2],
        topology: &Topology,
        frame: &ClothFrame,
        particles: &ClothParticles,
    ) {
        let Some(data) = &self.valid else {
            return;
        };
        let (mut selected, mut errors) = (Vec::new(), Vec::new());
        for selection in &data.selections {
            match selection.select("ClothAttachment", topology) {
                Ok(found) => selected.extend(found),
                Err(error) => errors.push(error),
            }
        }
        // Those that stay held by the same stay at their points.
        let stay = data.offset == ClothAttachmentOffset::Keep
            && self.target == Some(target)
            && self.revision == topology.revision;
        // Those of a cloth that grows grow with it.
        let grown = data.offset == ClothAttachmentOffset::Keep
            && self.target == Some(target)
            && self.particles == topology.particles()
            && self.scale != topology.scale;
        let before = std::mem::take(&mut self.points);
        let map = pose.seen_from(frame.end);
        let growth = if grown {
            let ratio = topology.scale / self.scale;
            let known = self.pose.unwrap_or(started);
            (!known.grows_to(&pose, ratio)).then_some(ratio)
        } else {
            None
        };
        let map_before = started.seen_from(frame.start);
        let kept_point = |point: Vec3| {
            growth.map_or(point, |ratio| {
                let about = particles.0.state.grown_about;
                map_before.undo(about + ratio * (map_before.apply(point) - about))
            })
        };
        let stay = stay || grown;
        let stored = |i: Given| topology.order.stored(i).index();
        let point = |k: usize, i: Given| match &data.offset {
            ClothAttachmentOffset::Points(points) => points.get(k).or(points.first()).copied(),
            ClothAttachmentOffset::Keep => {
                let mut before = before.iter().filter(|_| stay);
                let kept = before.find(|(particle, _)| *particle == i);
                Some(kept.map_or_else(
                    || map.undo(particles.0.state.position.get(stored(i))),
                    |&(_, point)| kept_point(point),
                ))
            }
        };
        if let ClothAttachmentOffset::Points(points) = &data.offset
            && points.len() != 1
            && points.len() != selected.len()
        {
            errors.push(ClothErrorKind::Count {
                field: "ClothAttachment.offset".into(),
                value: points.len(),
                allowed: format!("1 or one for each of {} particles", selected.len()),
            });
            self.points = if self.revision == topology.revision {
                before
            } else {
                Vec::new()
            };
        } else {
            self.points = selected
                .iter()
                .enumerate()
                .filter_map(|(k, &i)| {
                    let i = Given(i);
                    Some((i, point(k, i).filter(|p| p.is_finite())?))
                })
                .collect();
        }
        let compliance = data.give();
        let masses = self
            .points
            .iter()
            .map(|&(i, _)| particles.0.input.mass[stored(i)]);
        let mass: f32 = masses.clone().sum();
        let count = self.points.len() as f32;
        self.compliances = (compliance > 0.0).then(|| {
            let share = |m| if m > 0.0 { mass / m } else { count };
            masses
                .map(|m| (compliance * share(m)).min(f32::MAX))
                .collect()
        });
        if self.target != Some(target) {
            self.pose = None;
        }
        self.target = Some(target);
        self.revision = topology.revision;
        self.scale = topology.scale;
        self.particles = topology.particles();
        (self.stale, self.wrong) = (false, errors);
    }
}

/// Tells what the springs carried in the step, and breaks those that carried too much.
pub fn break_attachments(
    mut cloths: Query<(Entity, &ClothSleepState, &mut ClothAttachedParticles), With<Cloth>>,
    mut attachments: Query<(&ClothAttachmentState, &mut ClothAttachmentForce)>,
    mut commands: Commands,
) {
    for (cloth, rest, mut attached) in &mut cloths {
        if rest.is_asleep() {
            continue;
        }
        for body in &mut attached.bypass_change_detection().0.bodies {
            let Ok((state, mut carried)) = attachments.get_mut(Entity::from_bits(body.attachment))
            else {
                continue;
            };
            let force = body.pulled / body.substeps.max(1) as f32;
            (body.pulled, body.substeps) = (Vec3::ZERO, 0);
            carried.set_if_neq(ClothAttachmentForce { force });
            let most = state.valid.as_ref().and_then(|valid| valid.break_force);
            if most.is_some_and(|most| force.length() > most) {
                let broken = ClothAttachmentBroken {
                    entity: cloth,
                    attachment: Entity::from_bits(body.attachment),
                    target: Entity::from_bits(body.target),
                    force,
                    reason: ClothBreakReason::Force,
                };
                give_up(commands.reborrow(), broken);
            }
        }
    }
}

/// Tells observers, then despawns the attachment.
fn give_up(mut commands: Commands, broken: ClothAttachmentBroken) {
    commands.trigger(broken);
    if let Ok(mut attachment) = commands.get_entity(broken.attachment) {
        attachment.try_despawn();
    }
}
