//! Colliders that are no entities of this crate: those of a physics engine.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Vec3};

use super::{ClothColliderShape, ClothLayers};

/// Colliders of this step that come from elsewhere, such as a physics engine. Push to it in each step, before
/// [`ClothSystems::Prepare`](crate::schedule::ClothSystems::Prepare);
/// [`snapshot_colliders`](super::snapshot_colliders) takes them out.
#[derive(Resource, Debug, Default)]
pub struct ClothExternalColliders {
    pub(crate) colliders: Vec<ClothExternalCollider>,
}

impl ClothExternalColliders {
    /// Adds a collider to the step that comes next.
    pub fn push(&mut self, collider: ClothExternalCollider) {
        self.colliders.push(collider);
    }

    /// The number of colliders that wait for the step.
    pub fn len(&self) -> usize {
        self.colliders.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.colliders.is_empty()
    }
}

/// A collider for one step, given by its motion.
#[derive(Clone, Debug)]
pub struct ClothExternalCollider {
    /// Owner: errors are reported for this entity.
    pub entity: Entity,
    /// Index among the entity's colliders.
    pub part: u32,
    /// Its shape around its pose. Cloning one is cheap.
    pub shape: ClothColliderShape,
    /// Coulomb friction [-]. The geometric mean with the material's counts.
    pub friction: f32,
    /// Distance that is kept from it besides the cloth's own thickness \[m\].
    pub margin: f32,
    /// Collision layers: the cloths that it meets.
    pub layers: ClothLayers,
    /// Pose at the start of the step, in the world.
    pub start: Isometry3d,
    /// Pose at the end of the step, unless cloth moves it.
    pub end: Isometry3d,
    /// The body that cloth pushes, if any. `None` is moved by nothing.
    pub body: Option<ClothColliderBody>,
}

/// The rigid body that a collider is part of. Colliders of one body give the same values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothColliderBody {
    /// Entity of the body, by which [`ClothReactions`](super::ClothReactions) names it.
    pub body: Entity,
    /// 1/mass along the axes of the world [1/kg]; 0 where it cannot move.
    pub inv_mass: Vec3,
    /// Inverse of the inertia about the centre of mass, in world axes [1/(kg m²)]; 0 does not turn.
    pub inv_inertia: Mat3,
    /// Centre of mass in the world, at the end of the step \[m\].
    pub center_of_mass: Vec3,
    /// Velocity at the end of the step, unless cloth moves it [m/s].
    pub linear_velocity: Vec3,
    /// Angular velocity at the end of the step, unless cloth moves it [rad/s].
    pub angular_velocity: Vec3,
}
