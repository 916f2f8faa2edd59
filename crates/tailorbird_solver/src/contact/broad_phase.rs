//! Broad phase: colliders near a cloth, and blocks of its particles near a collider.

use std::{hash::Hash, ops::Range};

use bevy_math::{Isometry3d, Vec3};
use fearless_simd::Level;

use super::solid::{Solid, swept};
use crate::{
    contact::{
        cache::ContactCache,
        colliders::{Colliders, Layers, MovingCollider},
    },
    frame::Frame,
    kernels::range::bounds,
    points::Points,
};

/// Number of particles of a block.
const BLOCK: usize = 128;

/// Distance that a cloth can move before the list of colliders near it is found again \[m\].
const ROOM: f32 = 0.5;

/// Margin around a collider for contacts that have just ended \[m\].
pub const LEAVING: f32 = 0.01;

fn merge(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

fn overlap(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> bool {
    a.0.cmple(b.1).all() && a.1.cmpge(b.0).all()
}

/// The reach of a solid that moves, in the axes of its poses.
enum Reach {
    /// Box around it.
    Box((Vec3, Vec3)),
    /// Planes of a half-space at both ends of its motion, each by its normal and a point, and its room \[m\].
    HalfSpace([(Vec3, Vec3); 2], f32),
}

impl Reach {
    /// Everything that comes within `room` \[m\] of a solid.
    fn new(solid: &Solid, [from, to]: [Isometry3d; 2], room: f32) -> Self {
        let Some(range) = solid.range() else {
            let plane = |at: Isometry3d| (at.rotation * Vec3::Y, Vec3::from(at.translation));
            return Self::HalfSpace([from, to].map(plane), room);
        };
        let (low, high) = swept(range, &from, &to);
        Self::Box((low - Vec3::splat(room), high + Vec3::splat(room)))
    }

    /// Returns whether a box lies within.
    fn meets(&self, bounds: (Vec3, Vec3)) -> bool {
        match *self {
            Self::Box(around) => overlap(bounds, around),
            Self::HalfSpace(planes, room) => planes.iter().any(|&(normal, place)| {
                let lowest = Vec3::select(normal.cmpge(Vec3::ZERO), bounds.0, bounds.1);
                normal.dot(lowest - place) <= room
            }),
        }
    }
}

impl ContactCache {
    /// Finds the boxes of the blocks, and the colliders near them, from which they keep a distance of `margin` \[m\] besides the colliders'
    /// own margins.
    pub fn find_colliders(
        &mut self,
        colliders: &Colliders,
        frame: &Frame,
        layers: Layers,
        margin: f32,
        (level, stage): (Level, (u32, bool)),
        [now, before]: [&Points; 2],
    ) {
        if self.stage == Some(stage) {
            return;
        }
        self.stage = Some(stage);
        let len = now.len();
        self.blocks.clear();
        let starts = (0..len).step_by(BLOCK);
        self.blocks.extend(
            starts.map(|start| bounds(level, [now, before], start..(start + BLOCK).min(len))),
        );
        let Some(all) = self.blocks.iter().copied().reduce(merge) else {
            return;
        };
        let at = frame.isometry();
        let (low, high) = swept(all, &at, &at);
        let held = self
            .holds
            .is_some_and(|(min, max)| low.cmpge(min).all() && high.cmple(max).all());
        if held {
            return;
        }
        let room = Vec3::splat(ROOM);
        let holds = (low - room, high + room);
        self.holds = Some(holds);
        self.near.clear();
        for (k, collider) in colliders.colliders.iter().enumerate() {
            // Cloth may have moved a body away from its path.
            let moved = if collider.body.is_some() { ROOM } else { 0.0 };
            let moved = Vec3::splat(moved + margin + LEAVING);
            let (min, max) = colliders.boxes[k];
            if overlap(holds, (min - moved, max + moved)) && layers.interacts_with(collider.layers)
            {
                self.near.push(k);
            }
        }
        let near = &self.near;
        self.passing
            .retain(|key| near.iter().any(|k| colliders.colliders[*k].id == *key));
        self.planes
            .retain(|planes| near.iter().any(|k| planes.is_of(&colliders.colliders[*k])));
    }

    /// Next particles from `start` on, in whole blocks, that a solid with this motion in the cloth's frame may touch.
    pub fn next(
        &self,
        solid: &Solid,
        poses: [Isometry3d; 2],
        margin: f32,
        start: usize,
        len: usize,
    ) -> Option<Range<usize>> {
        let reach = Reach::new(solid, poses, margin + LEAVING);
        let reaches = |block: &(Vec3, Vec3)| reach.meets(*block);
        // The last block may be shorter than the others.
        let next = start.div_ceil(BLOCK);
        let blocks = self.blocks.get(next..)?;
        let first = next + blocks.iter().position(reaches)?;
        let count = self.blocks[first..]
            .iter()
            .take_while(|b| reaches(b))
            .count();
        Some(first * BLOCK..((first + count) * BLOCK).min(len))
    }

    /// Applies [`Self::update`] to single particles, in their order.
    pub fn update_each(&mut self, level: Level, points: [&Points; 2], particles: &[usize]) {
        for block in particles.chunk_by(|a, b| a / BLOCK == b / BLOCK) {
            self.update(level, points, block[0]..block[0] + 1);
        }
    }

    /// Updates the boxes of blocks whose particles were moved, if there are other colliders that need them.
    pub fn update(&mut self, level: Level, points: [&Points; 2], range: Range<usize>) {
        if self.near.len() < 2 {
            return;
        }
        let len = points[0].len();
        for k in range.start / BLOCK..range.end.div_ceil(BLOCK) {
            let end = ((k + 1) * BLOCK).min(len);
            if let Some(all) = self.blocks.get_mut(k) {
                *all = bounds(level, points, k * BLOCK..end);
            }
        }
    }
}

impl Colliders {
    /// Identities of the colliders that come within `room` \[m\] of a cloth's box during this step: owner, shape, start and end.
    pub fn near(
        &self,
        frame: &Frame,
        bounds: (Vec3, Vec3),
        layers: Layers,
        room: f32,
    ) -> impl Iterator<Item = impl Hash> {
        let near = move |collider: &&MovingCollider| {
            layers.interacts_with(collider.layers) && collider.reaches(frame, bounds, room)
        };
        self.colliders.iter().filter(near).map(|collider| {
            let bits = |at: &Isometry3d| {
                let [x, y, z] = at.translation.to_array();
                let [a, b, c, d] = at.rotation.to_array();
                [x, y, z, a, b, c, d].map(f32::to_bits)
            };
            let surface = [collider.friction, collider.margin].map(f32::to_bits);
            let place = [bits(&collider.start), bits(&collider.end)];
            let who = collider.id;
            (who, collider.solid.bits(), surface, place)
        })
    }
}

impl MovingCollider {
    /// Returns whether it may come within `room` \[m\] of a cloth's box.
    fn reaches(&self, frame: &Frame, bounds: (Vec3, Vec3), room: f32) -> bool {
        let frame = frame.isometry().inverse();
        let poses = [self.start, self.end].map(|at| frame * at);
        Reach::new(&self.solid, poses, room + self.margin).meets(bounds)
    }
}
