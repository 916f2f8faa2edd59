//! Particles held by the attachments of a cloth.

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::GlobalTransform;
use tailorbird_solver::{
    holds::{Holds, Spring},
    pose::motion,
};

use super::pose::pose_of;

/// The particles of a cloth that attachments hold, and where. Written by
/// [`prepare_attachments`](super::prepare_attachments) alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothAttachedParticles(#[reflect(ignore)] pub(crate) Holds);

impl Deref for ClothAttachedParticles {
    type Target = Holds;

    fn deref(&self) -> &Holds {
        &self.0
    }
}

/// A particle that an attachment holds rigidly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPoint {
    /// The particle.
    pub particle: u32,
    /// The attachment.
    pub attachment: Entity,
    /// The entity that holds it.
    pub target: Entity,
    /// Point in that entity's own space \[m\].
    pub point: Vec3,
}

impl ClothAttachedParticles {
    /// The particles that are held rigidly.
    pub fn rigid(&self) -> impl ExactSizeIterator<Item = HeldPoint> + '_ {
        self.0.rigid.iter().map(|hold| {
            let body = &self.0.bodies[hold.body as usize];
            HeldPoint {
                particle: self.0.order.given(hold.particle).0,
                attachment: Entity::from_bits(body.attachment),
                target: Entity::from_bits(body.target),
                point: hold.point,
            }
        })
    }

    /// The particles at springs.
    pub fn springs(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        let given = |spring: &Spring| self.0.order.given(spring.hold.particle).0;
        self.0.springs.iter().map(given)
    }

    /// Motion of a target from its pose at a part of the last step, 0 to 1, to its present one, as seen from a frame that does not move;
    /// without changes of scale. `None` if it holds nothing.
    pub fn motion(
        &self,
        target: Entity,
        now: &GlobalTransform,
        frame: Isometry3d,
        fraction: f32,
    ) -> Option<Isometry3d> {
        let target = target.to_bits();
        let body = self.0.bodies.iter().find(|body| body.target == target)?;
        let was = body.start.towards(&body.end, fraction);
        Some(motion(&was, &pose_of(now).ok()?, frame))
    }
}
