//! Tells cloth where Rapier's colliders are.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Vec3};
use bevy_rapier3d::{
    geometry::RapierColliderHandle,
    parry::math::Pose,
    plugin::context::{RapierContextColliders, RapierContextEntityLink, RapierRigidBodySet},
    rapier::{
        dynamics::RigidBody,
        geometry::{Collider, SharedShape},
    },
};
use tailorbird_bridge::{
    ClothBoxes, ClothCollisionDisabled, ClothLoad, ShapeCache, TrackedPose, WorldBox,
};
use tailorbird_cloth::prelude::*;

use crate::shape;

/// Pose of a collider in the world, with the present pose of its body.
pub(crate) fn pose(collider: &Collider, bodies: &RapierRigidBodySet) -> Isometry3d {
    let body = collider.parent().and_then(|body| bodies.bodies.get(body));
    match (body, collider.position_wrt_parent()) {
        (Some(body), Some(to)) => isometry(body.position()) * isometry(to),
        _ => isometry(collider.position()),
    }
}

fn isometry(pose: &Pose) -> Isometry3d {
    Isometry3d::new(pose.translation, pose.rotation)
}

/// 1/mass along the axes of the world [1/kg], and the inverse inertia in world axes [1/(kg m²)]; 0 along and about
/// locked ones.
pub(crate) fn inverse_mass(body: &RigidBody) -> (Vec3, Mat3) {
    let properties = body.mass_properties();
    let i = &properties.effective_world_inv_inertia;
    let inv_inertia = Mat3::from_cols(
        Vec3::new(i.m11, i.m12, i.m13),
        Vec3::new(i.m12, i.m22, i.m23),
        Vec3::new(i.m13, i.m23, i.m33),
    );
    (properties.effective_inv_mass, inv_inertia)
}

/// Properties of a body for cloth, if cloth can push it at all.
fn for_cloth(entity: Entity, body: &RigidBody) -> Option<ClothColliderBody> {
    if !body.is_dynamic() || !body.is_enabled() {
        return None;
    }
    let still = ClothColliderBody {
        body: entity,
        inv_mass: Vec3::ZERO,
        inv_inertia: Mat3::ZERO,
        center_of_mass: body.center_of_mass(),
        linear_velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
    };
    if body.is_sleeping() {
        return Some(still);
    }
    let (inv_mass, inv_inertia) = inverse_mass(body);
    Some(ClothColliderBody {
        inv_mass,
        inv_inertia,
        linear_velocity: body.linvel(),
        angular_velocity: body.angvel(),
        ..still
    })
}

/// Pushes Rapier's colliders that are near a cloth to [`ClothExternalColliders`].
pub(crate) fn push_colliders(
    mut cloths: ClothBoxes,
    mut cache: Local<ShapeCache<SharedShape>>,
    mut external: ResMut<ClothExternalColliders>,
    worlds: Query<(&RapierContextColliders, &RapierRigidBodySet)>,
    mut loads: Query<&mut ClothLoad>,
    colliders: Query<
        (
            Entity,
            &RapierColliderHandle,
            &RapierContextEntityLink,
            Option<&ClothLayers>,
            &TrackedPose,
        ),
        (Without<ClothCollisionDisabled>, Without<ClothCollider>),
    >,
) {
    if !cloths.begin_step() {
        return;
    }
    cache.begin_step();
    for mut load in &mut loads {
        load.at_rest = false;
    }
    for (entity, handle, link, layers, track) in &colliders {
        let Ok((set, bodies)) = worlds.get(link.0) else {
            continue;
        };
        let Some(collider) = set.colliders.get(handle.0) else {
            continue;
        };
        if collider.is_sensor() || !collider.is_enabled() {
            continue;
        }
        let end = pose(collider, bodies);
        if !end.translation.is_finite() {
            continue;
        }
        let start = track.start(end, cloths.seconds(), cloths.teleport_speed());
        let shape = collider.shared_shape();
        let aabb = shape.compute_local_aabb();
        let [before, now] = [start, end].map(|at| {
            let half = aabb.half_extents();
            if half.is_finite() && half.max_element() < 1e9 {
                WorldBox::around(aabb.center(), half, at)
            } else {
                WorldBox::EVERYWHERE
            }
        });
        if !cloths.reach(before.merge(now)) {
            continue;
        }
        let body = collider.parent().and_then(|handle| {
            let body = bodies.bodies.get(handle)?;
            Some((bodies.rigid_body_entity(handle)?, body))
        });
        if let Some((entity, _)) = body
            && cloths.rest_on(now)
            && let Ok(mut load) = loads.get_mut(entity)
        {
            load.at_rest = true;
        }
        let body = body.and_then(|(entity, body)| for_cloth(entity, body));
        let layers = layers.copied().unwrap_or_else(|| {
            let groups = collider.collision_groups();
            ClothLayers::new(groups.memberships.bits(), groups.filter.bits())
        });
        let address = Arc::as_ptr(&shape.0).cast::<()>() as usize;
        let pieces = cache.pieces(address, shape, || shape::pieces(&**shape));
        for (part, piece) in pieces.iter().enumerate() {
            external.push(ClothExternalCollider {
                entity,
                part: part as u32,
                shape: piece.shape.clone(),
                friction: collider.friction(),
                margin: piece.margin + collider.contact_skin(),
                layers,
                start: start * piece.at,
                end: end * piece.at,
                body,
            });
        }
    }
}
