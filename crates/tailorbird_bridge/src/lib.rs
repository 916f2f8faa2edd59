//! Common parts of the bridges between cloth and physics engines: colliders near a cloth and their motion, the effect of a push on a body,
//! and the waking of sleeping bodies.
//!
//! Users take `tailorbird_avian` or `tailorbird_rapier`, which re-export what they need of this. A bridge to another engine is
//! two systems of a hundred lines: one in [`ClothBridgeSystems::Collect`] that pushes the engine's colliders to
//! [`ClothExternalColliders`](tailorbird_cloth::collider::ClothExternalColliders), one in [`ClothBridgeSystems::Apply`] that gives
//! bodies what [`ClothReactions`](tailorbird_cloth::collider::ClothReactions) says.

mod load;
mod near;
mod parry;
mod pose;
mod shapes;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
#[doc(no_inline)]
pub use tailorbird_cloth::collider::ClothColliderShape;

pub use self::{
    load::{ClothLoad, SleepLimits},
    near::{ClothBoxes, WorldBox},
    parry::ShapePart,
    pose::{TrackedPose, moved},
    shapes::{Piece, ShapeCache},
};

/// The systems of a bridge, in the schedule in which cloth is simulated.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClothBridgeSystems {
    /// Tells cloth where the engine's colliders are. After the engine's step, before
    /// [`ClothSystems::Prepare`](tailorbird_cloth::schedule::ClothSystems::Prepare).
    Collect,
    /// Gives bodies what cloth did to them. After
    /// [`ClothSystems::Simulate`](tailorbird_cloth::schedule::ClothSystems::Simulate).
    Apply,
}

/// On the entity of an engine's collider: cloth does not see it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothCollisionDisabled;
