//! The rigid frame that particles live in, and its motion during a step.

use bevy_math::{Isometry3d, Quat, Vec3};
use bevy_reflect::prelude::*;

/// The rigid frame that particles live in, and its path in a step.
#[derive(Clone, Copy, Debug, Default, Reflect)]
#[reflect(Default)]
pub struct Frame {
    /// At the start of the step.
    #[doc(hidden)]
    pub start: Isometry3d,
    /// At the end of the step.
    #[doc(hidden)]
    pub end: Isometry3d,
    /// At the end of the substep in progress: what the particles' coordinates refer to.
    #[doc(hidden)]
    pub current: Isometry3d,
    /// From `start` to `current` \[m\]: exact where coordinates of the world are not.
    #[doc(hidden)]
    pub offset: Vec3,
    /// Part of the motion of this step that particles feel.
    #[doc(hidden)]
    #[reflect(ignore)]
    pub felt: Felt,
    /// From where the last substep began to where the frame is now, as the particles were taken.
    #[doc(hidden)]
    #[reflect(ignore)]
    pub taken: Option<Taken>,
    /// Displacement by which the frame was put elsewhere before this step.
    #[doc(hidden)]
    #[reflect(ignore)]
    pub jump: Option<Isometry3d>,
}

/// Change of coordinates of the free particles when the frame moved in this substep.
#[derive(Clone, Copy, Debug)]
pub struct Taken {
    /// Rotation of the frame before, and its offset from the start of the step.
    pub from: (Quat, Vec3),
    /// Rigid motion of the particles that do not follow the frame by themselves.
    pub motion: Isometry3d,
}

/// Part of the motion of a step that particles feel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// Of the translation [-].
    pub linear: f32,
    /// Of the rotation [-].
    pub angular: f32,
    /// The angular velocity, in world axes, whose centrifugal acceleration acts beside that [rad/s].
    pub spin: Vec3,
}

impl Default for Felt {
    fn default() -> Self {
        Self {
            linear: 1.0,
            angular: 1.0,
            spin: Vec3::ZERO,
        }
    }
}

impl Felt {
    /// Returns whether it is the whole motion.
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }
}

/// The same rotation by no more than π.
pub fn shortest(rotation: Quat) -> Quat {
    if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    }
}

impl Frame {
    /// Pose of the frame in the world.
    pub fn isometry(&self) -> Isometry3d {
        self.current
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
    pub fn to_frame_at_end(&self, point: Vec3) -> Vec3 {
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

    /// Rotation by which the entity was put elsewhere before this step; none if it was not.
    pub fn jump_turn(&self) -> Option<Quat> {
        self.jump.map(|jump| jump.rotation)
    }

    /// Start of an object that moves from `start` to `end` in this step, for a cloth that was put elsewhere with its entity: an object
    /// that was put elsewhere with it was as near to it before.
    pub fn start_of(&self, start: Isometry3d, end: Isometry3d) -> Isometry3d {
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

    /// Path during a substep, in the frame as it is, of an object that moves through the world from `start` to `end` in this step. It
    /// begins as far from the particles as the object then was.
    pub fn path_in_frame(
        &self,
        start: Isometry3d,
        end: Isometry3d,
        fractions: (f32, f32),
    ) -> [Isometry3d; 2] {
        let start = self.start_of(start, end);
        // Differences first: they are exact where coordinates are large.
        let first = Vec3::from(start.translation - self.start.translation);
        let displacement = Vec3::from(end.translation - start.translation);
        let at = |fraction: f32| {
            let rotation = if start.rotation == end.rotation {
                end.rotation
            } else {
                start.rotation.slerp(end.rotation, fraction)
            };
            (rotation, first + fraction * displacement)
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

    /// The felt part of the motion of this step, in the frame's axes at its start.
    pub fn felt_motion(&self) -> Isometry3d {
        let motion = self.start.inverse() * self.end;
        Isometry3d::new(
            self.felt.linear * Vec3::from(motion.translation),
            Quat::IDENTITY.slerp(shortest(motion.rotation), self.felt.angular),
        )
    }

    /// Returns whether the frame moves during this step.
    pub fn is_moving(&self) -> bool {
        self.start != self.end
    }
}
