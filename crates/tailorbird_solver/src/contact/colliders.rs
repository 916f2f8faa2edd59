//! The colliders of a step.

use bevy_math::{Isometry3d, Mat3, Vec3};

use super::solid::{Solid, swept};

/// Identity of a collider: its owner, as bits, and which of the owner's colliders it is, with its part of a compound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ColliderId {
    /// Owner, as bits.
    pub owner: u64,
    /// Index among the owner's colliders, and part of a compound.
    pub part: (u32, u32),
}

/// Collision layers: a cloth and a collider meet where each one's memberships share a bit with the other's filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Layers of its own, a bit each.
    pub memberships: u32,
    /// Layers that it meets, a bit each.
    pub filters: u32,
}

impl Layers {
    /// Returns whether the two meet.
    pub const fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

/// A rigid body that cloth pushes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// 1/mass along the axes of the world [1/kg]; 0 where it cannot move.
    pub inv_mass: Vec3,
    /// Inverse of the inertia about the centre of mass, in world axes [1/(kg m²)]; 0 does not turn.
    pub inv_inertia: Mat3,
    /// Centre of mass at the end of the step, in the world \[m\].
    pub center_of_mass: Vec3,
}

/// The colliders of a step with their motion.
#[derive(Clone, Debug, Default)]
pub struct Colliders {
    /// Colliders, in the order in which they are solved.
    pub colliders: Vec<MovingCollider>,
    /// Boxes around them during the step, in the world \[m\].
    pub boxes: Vec<(Vec3, Vec3)>,
    /// Bodies that cloth pushes.
    pub bodies: Vec<Body>,
}

/// A simple solid during a step.
#[derive(Clone, Debug)]
pub struct MovingCollider {
    /// Identity, the same from step to step.
    pub id: ColliderId,
    pub solid: Solid,
    pub friction: f32,
    pub margin: f32,
    pub layers: Layers,
    pub start: Isometry3d,
    pub end: Isometry3d,
    /// Index of the body that it belongs to.
    pub body: Option<usize>,
}

impl MovingCollider {
    /// Pose at a part of the step, in the world.
    pub fn at(&self, fraction: f32) -> Isometry3d {
        Isometry3d::new(
            self.start.translation.lerp(self.end.translation, fraction),
            self.start.rotation.slerp(self.end.rotation, fraction),
        )
    }

    /// Box around it during the step, margin included, in the world \[m\].
    pub fn swept_box(&self) -> (Vec3, Vec3) {
        const EVERYWHERE: (Vec3, Vec3) = (Vec3::MIN, Vec3::MAX);
        let margin = Vec3::splat(self.margin);
        self.solid.range().map_or(EVERYWHERE, |range| {
            let (low, high) = swept(range, &self.start, &self.end);
            (low - margin, high + margin)
        })
    }
}

/// Friction of a pair of surfaces: the geometric mean, so that the pair is slippery if either is.
pub fn combined_friction(a: f32, b: f32) -> f32 {
    (a * b).max(0.0).sqrt()
}
