//! Which colliders are near a cloth.

use std::hash::Hash;

use bevy_math::{Isometry3d, Vec3};

use super::{ClothColliders, ColliderShape, MovingCollider};
use crate::{bounds::ClothBounds, frame::ClothFrame};

impl ClothColliders {
    /// What tells the colliders apart that come within `room` \[m\] of a cloth's box during this step: who, which shape, from
    /// where to where.
    pub(crate) fn near(
        &self,
        frame: &ClothFrame,
        bounds: &ClothBounds,
        room: f32,
    ) -> impl Iterator<Item = impl Hash> {
        let near = move |collider: &&MovingCollider| collider.reaches(frame, bounds, room);
        self.colliders.iter().filter(near).map(|collider| {
            let bits = |at: &Isometry3d| {
                let [x, y, z] = at.translation.to_array();
                let [a, b, c, d] = at.rotation.to_array();
                [x, y, z, a, b, c, d].map(f32::to_bits)
            };
            let radius = match collider.shape {
                ColliderShape::Sphere { radius } => Some(radius.to_bits()),
                ColliderShape::HalfSpace => None,
            };
            let friction = collider.friction.to_bits();
            let place = [bits(&collider.start), bits(&collider.end)];
            (collider.entity, radius, friction, place)
        })
    }
}

impl MovingCollider {
    /// Whether it may come within `room` \[m\] of a cloth's box.
    fn reaches(&self, frame: &ClothFrame, bounds: &ClothBounds, room: f32) -> bool {
        let ends = [self.start, self.end];
        let centers = ends.map(|at| frame.to_frame(at.translation.into()));
        match self.shape {
            ColliderShape::Sphere { radius } => {
                let room = Vec3::splat(radius + room);
                let (low, high) = (centers[0].min(centers[1]), centers[0].max(centers[1]));
                (low - room).cmple(bounds.max).all() && (high + room).cmpge(bounds.min).all()
            }
            ColliderShape::HalfSpace => ends.iter().zip(centers).any(|(at, point)| {
                let normal = frame.vector_to_frame(at.rotation * Vec3::Y);
                let lowest = Vec3::select(normal.cmpge(Vec3::ZERO), bounds.min, bounds.max);
                normal.dot(lowest - point) <= room
            }),
        }
    }
}
