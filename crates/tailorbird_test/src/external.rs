//! Colliders of a physics engine.

use bevy_ecs::prelude::*;
use bevy_math::Isometry3d;
use tailorbird_cloth::prelude::*;

/// A collider that goes from one pose to another in the next step, with a friction of 0.5 and no margin, on all layers.
pub fn external(
    entity: Entity,
    shape: ClothColliderShape,
    [start, end]: [Isometry3d; 2],
    body: Option<ClothColliderBody>,
) -> ClothExternalCollider {
    ClothExternalCollider {
        entity,
        part: 0,
        shape,
        friction: 0.5,
        margin: 0.0,
        layers: ClothLayers::ALL,
        start,
        end,
        body,
    }
}
