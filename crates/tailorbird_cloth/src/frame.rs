//! The rigid frame that a cloth's particles live in.
//!
//! ![A banner on a boat that pitches and rolls](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/banner.gif)

mod advance;
mod split;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec3, Vec3A};
use bevy_reflect::prelude::*;

pub use advance::advance_frames;
pub use split::split_mirrored;
use split::{check_shear, split_like};
pub(crate) use split::{shortest, split};

use crate::{
    cloth::Cloth,
    error::{ClothStatus, ErrorSource},
    inertia::{ClothInertia, Felt, TeleportMode},
    particles::ClothParticles,
    sampling::{SampledMotion, SampledPoses, excess},
    step::ClothStep,
};

/// The rigid frame that a cloth's particles live in: translation and rotation of the entity. Scale is part of the rest
/// shape instead.
///
/// Where the entity moves, the frame moves with it, evenly over the substeps, and pins with the frame. Free particles
/// keep their place in the world: they are expressed in the moved frame. So a cloth far from the world's origin is
/// as precise as one at it.
#[derive(Component, Clone, Copy, Debug, Reflect)]
#[reflect(Component, Default)]
pub struct ClothFrame {
    /// At the start of the step.
    pub(crate) start: Isometry3d,
    /// At the end of the step.
    pub(crate) end: Isometry3d,
    /// At the end of the substep in progress: what the particles' coordinates refer to.
    pub(crate) current: Isometry3d,
    /// From `start` to `current` \[m\]: exact where coordinates of the world are not.
    offset: Vec3,
    pub(crate) scale: Vec3,
    pub(crate) placed: bool,
    /// The last valid one.
    inertia: ClothInertia,
    /// How much of the motion of this step is felt.
    #[reflect(ignore)]
    felt: Felt,
    /// From where the last substep began to where the frame is now, as the particles were taken.
    #[reflect(ignore)]
    taken: Option<Taken>,
    /// How far the entity was put elsewhere before this step: it was told to, it hopped, or moved while the cloth did not simulate.
    #[reflect(ignore)]
    jump: Option<Isometry3d>,
    /// What was felt of the last step [m/s].
    velocity: Vec3,
    /// Whether the cloth goes where its entity goes, and feels nothing of it.
    pub(crate) carries: bool,
    asked: Option<TeleportMode>,
    teleported: Option<TeleportMode>,
}

/// How what does not follow the frame by itself came from the frame as it was into the frame as it is.
#[derive(Clone, Copy, Debug)]
struct Taken {
    /// How the frame was turned, and how far from where the step began.
    from: (Quat, Vec3),
    motion: Isometry3d,
}

impl Default for ClothFrame {
    fn default() -> Self {
        Self {
            start: Isometry3d::IDENTITY,
            end: Isometry3d::IDENTITY,
            current: Isometry3d::IDENTITY,
            offset: Vec3::ZERO,
            scale: Vec3::ONE,
            placed: false,
            inertia: ClothInertia::default(),
            felt: Felt::default(),
            taken: None,
            jump: None,
            velocity: Vec3::ZERO,
            carries: false,
            asked: None,
            teleported: None,
        }
    }
}

impl ClothFrame {
    /// Where the frame is in the world.
    pub fn isometry(&self) -> Isometry3d {
        self.current
    }

    /// The entity's scale, which is part of the rest shape.
    pub fn scale(&self) -> Vec3 {
        self.scale
    }

    /// A point of the frame in the world \[m\].
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.current.rotation * point + Vec3::from(self.current.translation)
    }

    /// A point of the world in the frame \[m\].
    pub fn to_frame(&self, point: Vec3) -> Vec3 {
        let offset = point - Vec3::from(self.start.translation) - self.offset;
        self.current.rotation.inverse() * offset
    }

    /// A point of the world in the frame at the end of the step \[m\].
    pub(crate) fn to_frame_at_end(self, point: Vec3) -> Vec3 {
        self.end.rotation.inverse() * (point - Vec3::from(self.end.translation))
    }

    /// A direction of the frame in world axes.
    pub fn vector_to_world(&self, vector: Vec3) -> Vec3 {
        self.current.rotation * vector
    }

    /// A direction of the world in the frame's axes.
    pub fn vector_to_frame(&self, vector: Vec3) -> Vec3 {
        self.current.rotation.inverse() * vector
    }

    /// The entity is put elsewhere, and its cloth with it: whatever way the entity goes until the next step, the cloth does not
    /// feel it. So with its parents, and with whatever else hangs on those.
    /// [`ClothTeleported`](crate::inertia::ClothTeleported) tells when that is done. What holds the cloth without being a parent is told by
    /// [`SampledMotion::teleport`](crate::sampling::SampledMotion::teleport).
    pub fn teleport(&mut self, mode: TeleportMode) {
        self.asked = Some(mode);
    }

    /// Whether [`Self::teleport`] was called since the last step.
    pub(crate) fn is_asked(&self) -> bool {
        self.asked.is_some()
    }

    /// How the entity was turned where it was put elsewhere before this step; none where it was not.
    pub(crate) fn jump_turn(&self) -> Option<Quat> {
        self.jump.map(|jump| jump.rotation)
    }

    /// What became of the cloth, where it was put elsewhere in this step.
    pub(crate) fn take_teleport(&mut self) -> Option<TeleportMode> {
        self.teleported.take()
    }

    /// Where something that goes from `start` to `end` in this step begins for a cloth that was put elsewhere with its entity:
    /// what was put elsewhere with it was as near to it before.
    pub(crate) fn start_of(&self, start: Isometry3d, end: Isometry3d) -> Isometry3d {
        let Some(jump) = self.jump else {
            return start;
        };
        let taken_along = jump * start;
        let far = |at: Isometry3d| at.translation.distance_squared(end.translation);
        if far(taken_along) < far(start) {
            taken_along
        } else {
            start
        }
    }

    /// The same for what holds the cloth: a cloth that its entity carries was put elsewhere with it, whatever its holder did.
    pub(crate) fn start_for(&self, start: Isometry3d, end: Isometry3d) -> Isometry3d {
        match self.jump {
            Some(jump) if self.carries => jump * start,
            _ => self.start_of(start, end),
        }
    }

    /// The way during a substep, in the frame as it is, of something that goes through the world from `start` to `end` in this
    /// step. It begins as far from the particles as it then was.
    pub(crate) fn way_to_frame(
        &self,
        start: Isometry3d,
        end: Isometry3d,
        fractions: (f32, f32),
    ) -> [Isometry3d; 2] {
        let start = self.start_of(start, end);
        // Differences first: they are exact where coordinates are large.
        let first = Vec3::from(start.translation - self.start.translation);
        let way = Vec3::from(end.translation - start.translation);
        let at = |fraction: f32| {
            let rotation = if start.rotation == end.rotation {
                end.rotation
            } else {
                start.rotation.slerp(end.rotation, fraction)
            };
            (rotation, first + fraction * way)
        };
        let into = |(turn, offset): (Quat, Vec3), (rotation, place): (Quat, Vec3)| {
            let inverse = turn.inverse();
            Isometry3d::new(inverse * (place - offset), inverse * rotation)
        };
        let now = (self.current.rotation, self.offset);
        let begin = at(fractions.0);
        let begin = match &self.taken {
            Some(taken) => taken.motion * into(taken.from, begin),
            None => into(now, begin),
        };
        [begin, into(now, at(fractions.1))]
    }

    /// What is felt of the motion of this step, in the frame's axes at its start.
    pub(crate) fn felt_motion(&self) -> Isometry3d {
        let motion = self.start.inverse() * self.end;
        Isometry3d::new(
            self.felt.linear * Vec3::from(motion.translation),
            Quat::IDENTITY.slerp(shortest(motion.rotation), self.felt.angular),
        )
    }

    /// Whether the frame moves during this step.
    pub fn is_moving(&self) -> bool {
        self.start != self.end
    }

    /// Takes over a scale that differs by more than the rounding of a scale that is read back from a rotated matrix.
    fn set_scale(&mut self, scale: Vec3) {
        const ROUNDING: f32 = 1e-5;
        let most = ROUNDING * scale.abs().max_element();
        if !self.placed || !scale.abs_diff_eq(self.scale, most) {
            self.scale = scale;
        }
    }

    /// Goes from one place to another within a step of this length \[s\], for the world and for the cloth; infinite where the cloth
    /// does not simulate. `holds` is whether it holds the cloth. What it is from where the last step ended to where this one starts carries the cloth.
    fn place(
        &mut self,
        [from, to]: [Isometry3d; 2],
        (teleported, holds): (bool, bool),
        seconds: [f32; 2],
    ) {
        let [world_seconds, seconds] = seconds;
        let inertia = self.inertia;
        let seen = if self.placed { self.end } else { to };
        (self.start, self.end) = (if self.placed { from } else { to }, to);
        self.placed = true;
        self.taken = None;
        let asked = self.asked.take();
        let far = from != to && inertia.is_teleport(from, to, world_seconds);
        let mode = asked.or_else(|| (far || teleported).then_some(inertia.teleport));
        if mode.is_some() {
            self.teleported = mode;
        }
        if asked.is_some() || far || self.carries || world_seconds.is_infinite() {
            self.start = to;
        }
        if world_seconds.is_finite() {
            let turn = self.start.rotation * seen.rotation.inverse();
            // What is carried has its velocity all the same.
            let began = if self.carries { from } else { self.start };
            let way = Vec3::from(to.translation - began.translation);
            let (excess, velocity) = excess(turn * self.velocity, way, world_seconds);
            let holds = holds && !self.carries;
            self.velocity = if asked.is_some() || far {
                turn * self.velocity
            } else if holds {
                velocity
            } else {
                way / world_seconds
            };
            if holds && self.start != to {
                self.start.translation += Vec3A::from(excess);
            }
        }
        self.jump = (self.start != seen).then(|| self.start * seen.inverse());
        self.felt = inertia.felt(self.start, to, world_seconds, seconds);
        self.current = self.start;
        self.offset = Vec3::ZERO;
    }
}

/// Reads where the entities of the cloths are.
///
/// A transform that is not finite is reported, and the frame stays where it was. One that is sheared is reported, and the frame follows
/// it without the shear.
pub fn prepare_frames(
    step: Res<ClothStep>,
    poses: SampledPoses,
    mut cloths: Query<
        (
            Entity,
            &SampledMotion,
            &mut ClothFrame,
            Ref<ClothInertia>,
            &ClothParticles,
            &mut ClothStatus,
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
    for (entity, own, mut frame, inertia, particles, mut status) in &mut cloths {
        if inertia.is_changed() {
            let errors = inertia.errors();
            if errors.is_empty() {
                frame.inertia = *inertia;
            }
            ClothStatus::update(&mut status, entity, &commands, ErrorSource::Inertia, errors);
        }
        let Ok(pose) = poses.get(entity) else {
            continue;
        };
        let holds = !particles.pins.is_empty() || !particles.limited.is_empty();
        let how = (pose.teleported, holds);
        let known = (frame.scale, frame.end.rotation);
        let [first, last] = own.scales();
        let error = match split_like(&pose.end, last, known) {
            Ok((end, scale)) => {
                let start = split_like(&pose.start, first, known).map_or(end, |(start, _)| start);
                frame.set_scale(scale);
                frame.place([start, end], how, seconds);
                check_shear(&pose.end)
            }
            Err(error) => {
                let stay = frame.end;
                if frame.placed {
                    frame.place([stay; 2], (false, holds), seconds);
                }
                Some(error)
            }
        };
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ErrorSource::Transform,
            error,
        );
    }
}
