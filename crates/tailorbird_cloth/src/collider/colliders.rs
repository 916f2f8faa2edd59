//! The colliders of a step.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::contact::colliders::Colliders;

use super::{ClothColliderBody, solids::Solids};

/// The scale of a collider. Written by [`snapshot_colliders`](super::snapshot_colliders) alone.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothColliderState {
    scale: Vec3,
}

impl ClothColliderState {
    /// A scale that differs by more than this part of it is another one: below that it is the rounding of something that
    /// turns, which must not make a mesh or hull of another size of each step.
    const SAME_SCALE: f32 = 1e-5;

    /// The scale that is in force from now on.
    pub(super) fn settle(&mut self, scale: Vec3) -> Vec3 {
        let difference = (scale - self.scale).abs();
        if difference.cmpgt(Self::SAME_SCALE * scale.abs()).any() {
            self.scale = scale;
        }
        self.scale
    }
}

/// The colliders of this step with their motion. Written by [`snapshot_colliders`](super::snapshot_colliders) alone.
#[derive(Resource, Clone, Debug, Default)]
pub struct ClothColliders {
    /// Colliders in the form of the solver.
    pub(crate) list: Colliders,
    /// The bodies that cloth pushes, in the order of entities.
    pub(super) bodies: Vec<ClothColliderBody>,
    pub(super) solids: Solids,
}

impl ClothColliders {
    /// The number of colliders; each part of a compound counts.
    pub fn len(&self) -> usize {
        self.list.colliders.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.colliders.is_empty()
    }
}
