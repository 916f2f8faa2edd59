//! Tells cloth where avian's colliders are.

use std::sync::Arc;

use avian3d::{parry::shape::SharedShape, prelude::*};
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Vec3};
use tailorbird_bridge::{
    ClothBoxes, ClothCollisionDisabled, ClothLoad, ShapeCache, TrackedPose, WorldBox,
};
use tailorbird_cloth::prelude::*;

use crate::shape;

/// A rigid body, read only.
#[derive(bevy_ecs::query::QueryData)]
pub(crate) struct Body {
    kind: &'static RigidBody,
    position: &'static Position,
    rotation: &'static Rotation,
    mass: &'static ComputedMass,
    inertia: &'static ComputedAngularInertia,
    center: &'static ComputedCenterOfMass,
    linear: &'static LinearVelocity,
    angular: &'static AngularVelocity,
    locked: Option<&'static LockedAxes>,
    friction: Option<&'static Friction>,
    margin: Option<&'static CollisionMargin>,
    sleeps: Has<Sleeping>,
    disabled: Has<RigidBodyDisabled>,
}

/// A collider of avian's.
#[derive(bevy_ecs::query::QueryData)]
pub(crate) struct BodyCollider {
    entity: Entity,
    collider: &'static Collider,
    place: Place,
    layers: &'static CollisionLayers,
    cloth_layers: Option<&'static ClothLayers>,
    friction: Option<&'static Friction>,
    margin: Option<&'static CollisionMargin>,
    track: &'static TrackedPose,
}

/// Components that tell the pose of a collider.
#[derive(bevy_ecs::query::QueryData)]
pub(crate) struct Place {
    position: &'static Position,
    rotation: &'static Rotation,
    body: Option<&'static ColliderOf>,
    in_body: Option<&'static ColliderTransform>,
}

impl PlaceItem<'_, '_> {
    /// Pose in the world, with the present pose of its body.
    pub(crate) fn pose(&self, body: Option<(Vec3, bevy_math::Quat)>) -> Isometry3d {
        match (body, self.in_body) {
            (Some((position, rotation)), Some(to)) => {
                Isometry3d::new(position, rotation) * Isometry3d::new(to.translation, to.rotation)
            }
            _ => Isometry3d::new(self.position.0, self.rotation.0),
        }
    }

    /// The body that it is part of.
    pub(crate) fn body(&self) -> Option<Entity> {
        self.body.map(|of| of.body)
    }
}

/// 1/mass along the axes of the world [1/kg], and the inverse inertia in world axes [1/(kg m²)]; 0 along and about
/// locked ones.
pub(crate) fn inverse_mass(
    mass: &ComputedMass,
    inertia: &ComputedAngularInertia,
    rotation: &Rotation,
    locked: Option<&LockedAxes>,
) -> (Vec3, Mat3) {
    let mut inv_mass = Vec3::splat(mass.inverse());
    let mut inv_inertia = inertia.rotated(rotation.0).inverse().to_mat3();
    if let Some(locked) = locked {
        let free = |locked: bool| if locked { 0.0 } else { 1.0 };
        inv_mass *= Vec3::new(
            free(locked.is_translation_x_locked()),
            free(locked.is_translation_y_locked()),
            free(locked.is_translation_z_locked()),
        );
        let turns = Mat3::from_diagonal(Vec3::new(
            free(locked.is_rotation_x_locked()),
            free(locked.is_rotation_y_locked()),
            free(locked.is_rotation_z_locked()),
        ));
        inv_inertia = turns * inv_inertia * turns;
    }
    (inv_mass, inv_inertia)
}

impl BodyItem<'_, '_> {
    /// Properties of the body for cloth, if cloth can push it at all.
    fn for_cloth(&self, body: Entity) -> Option<ClothColliderBody> {
        if !self.kind.is_dynamic() || self.disabled {
            return None;
        }
        let center_of_mass = self.position.0 + self.rotation.0 * self.center.0;
        let still = ClothColliderBody {
            body,
            inv_mass: Vec3::ZERO,
            inv_inertia: Mat3::ZERO,
            center_of_mass,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        };
        if self.sleeps {
            return Some(still);
        }
        let (inv_mass, inv_inertia) =
            inverse_mass(self.mass, self.inertia, self.rotation, self.locked);
        Some(ClothColliderBody {
            inv_mass,
            inv_inertia,
            linear_velocity: self.linear.0,
            angular_velocity: self.angular.0,
            ..still
        })
    }
}

/// Pushes avian's colliders that are near a cloth to [`ClothExternalColliders`].
pub(crate) fn push_colliders(
    mut cloths: ClothBoxes,
    mut cache: Local<ShapeCache<SharedShape>>,
    mut external: ResMut<ClothExternalColliders>,
    default_friction: Res<DefaultFriction>,
    bodies: Query<Body>,
    mut loads: Query<&mut ClothLoad>,
    colliders: Query<
        BodyCollider,
        (
            Without<Sensor>,
            Without<ColliderDisabled>,
            Without<ClothCollisionDisabled>,
            Without<ClothCollider>,
        ),
    >,
) {
    if !cloths.begin_step() {
        return;
    }
    cache.begin_step();
    for mut load in &mut loads {
        load.at_rest = false;
    }
    for it in &colliders {
        let body = it
            .place
            .body()
            .and_then(|body| Some((body, bodies.get(body).ok()?)));
        let at = body.as_ref().map(|(_, b)| (b.position.0, b.rotation.0));
        let end = it.place.pose(at);
        if !end.translation.is_finite() {
            continue;
        }
        let start = it
            .track
            .start(end, cloths.seconds(), cloths.teleport_speed());
        let shape = it.collider.shape_scaled();
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
        let body_for_cloth = body.as_ref().and_then(|(entity, b)| b.for_cloth(*entity));
        if let Some((entity, _)) = &body
            && cloths.rest_on(now)
            && let Ok(mut load) = loads.get_mut(*entity)
        {
            load.at_rest = true;
        }
        let of_body = body.as_ref().map(|(_, b)| b);
        let friction = it.friction.or(of_body.and_then(|b| b.friction));
        let margin = it.margin.or(of_body.and_then(|b| b.margin));
        let layers = it
            .cloth_layers
            .copied()
            .unwrap_or_else(|| ClothLayers::new(it.layers.memberships.0, it.layers.filters.0));
        let address = Arc::as_ptr(&shape.0).cast::<()>() as usize;
        let pieces = cache.pieces(address, shape, || shape::pieces(&**shape));
        for (part, piece) in pieces.iter().enumerate() {
            external.push(ClothExternalCollider {
                entity: it.entity,
                part: part as u32,
                shape: piece.shape.clone(),
                friction: friction.unwrap_or(&default_friction.0).dynamic_coefficient,
                margin: piece.margin + margin.map_or(0.0, |margin| margin.0),
                layers,
                start: start * piece.at,
                end: end * piece.at,
                body: body_for_cloth,
            });
        }
    }
}
