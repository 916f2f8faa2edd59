//! Avian, as the tests see it.

use avian3d::{
    parry::{shape::SharedShape, utils::Array2},
    prelude::*,
};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use tailorbird_avian::{ClothAvianPlugin, ClothCollisionDisabled};
use tailorbird_cloth::prelude::ClothPlugin;

use crate::world::{Body, Contact, Form, Kind, Motion};

pub fn add(app: &mut App, gravity: Vec3) {
    app.add_plugins((
        PhysicsPlugins::default(),
        ClothPlugin::default(),
        ClothAvianPlugin::default(),
    ));
    app.insert_resource(Gravity(gravity));
}

fn collider(form: &Form) -> Collider {
    match form {
        Form::Ball(radius) => Collider::sphere(*radius),
        Form::Box(sides) => Collider::cuboid(sides.x, sides.y, sides.z),
        Form::RoundBox(sides, radius) => Collider::round_cuboid(sides.x, sides.y, sides.z, *radius),
        Form::Capsule(radius, a, b) => Collider::capsule_endpoints(*radius, *a, *b),
        Form::Cylinder(radius, height) => Collider::cylinder(*radius, *height),
        Form::Cone(radius, height) => Collider::cone(*radius, *height),
        Form::Hull(points) => Collider::convex_hull(points).unwrap(),
        Form::Mesh(points, triangles) => Collider::trimesh(points.clone(), triangles.clone()),
        Form::Terrain(height, cells, side) => {
            let place = |k: usize| (k as f32 / *cells as f32 - 0.5) * side;
            // Column by column.
            let corners = (0..=*cells).flat_map(|x| (0..=*cells).map(move |z| (x, z)));
            let heights = corners.map(|(x, z)| height(place(x), place(z))).collect();
            let grid = Array2::new(cells + 1, cells + 1, heights);
            SharedShape::heightfield(grid, Vec3::new(*side, 1.0, *side)).into()
        }
        Form::Compound(parts) => {
            let parts = parts
                .iter()
                .map(|(at, turn, form)| (*at, *turn, collider(form)));
            Collider::compound(parts.collect())
        }
        Form::HalfSpace(normal) => Collider::half_space(*normal),
    }
}

pub fn spawn(world: &mut World, body: &Body) -> Entity {
    let at =
        Transform::from_translation(body.at.translation.into()).with_rotation(body.at.rotation);
    let kind = match body.kind {
        Kind::Dynamic => RigidBody::Dynamic,
        Kind::Fixed => RigidBody::Static,
        Kind::Kinematic => RigidBody::Kinematic,
    };
    let mut entity = world.spawn((
        kind,
        collider(&body.form),
        Mass(body.mass),
        LinearVelocity(body.velocity),
        AngularVelocity(body.spin),
        GravityScale(if body.falls { 1.0 } else { 0.0 }),
        LinearDamping(body.damping),
        AngularDamping(body.damping),
        at,
    ));
    if !body.sleeps {
        entity.insert(SleepingDisabled);
    }
    if body.on_rail {
        let rail = LockedAxes::ROTATION_LOCKED.lock_translation_x();
        entity.insert(rail.lock_translation_z());
    }
    match body.contact {
        Contact::Yes => {}
        Contact::Sensor => {
            entity.insert(Sensor);
        }
        Contact::Layers(memberships, filters) => {
            entity.insert(CollisionLayers::from_bits(memberships, filters));
        }
        Contact::Disabled => {
            entity.insert(ClothCollisionDisabled);
        }
    }
    entity.id()
}

pub fn motion(world: &World, body: Entity) -> Motion {
    let entity = world.entity(body);
    let (position, rotation) = (
        entity.get::<Position>().unwrap().0,
        entity.get::<Rotation>().unwrap().0,
    );
    let center = entity
        .get::<ComputedCenterOfMass>()
        .map_or(Vec3::ZERO, |c| c.0);
    let inertia = entity
        .get::<ComputedAngularInertia>()
        .copied()
        .unwrap_or_default();
    Motion {
        position,
        rotation,
        center: position + rotation * center,
        velocity: entity.get::<LinearVelocity>().unwrap().0,
        spin: entity.get::<AngularVelocity>().unwrap().0,
        inertia: inertia.rotated(rotation).tensor().to_mat3(),
        asleep: entity.contains::<Sleeping>(),
    }
}

pub fn set_velocity(world: &mut World, body: Entity, velocity: Vec3) {
    world.get_mut::<LinearVelocity>(body).unwrap().0 = velocity;
}

pub fn set_damping(world: &mut World, body: Entity, rate: f32) {
    world.get_mut::<LinearDamping>(body).unwrap().0 = rate;
    world.get_mut::<AngularDamping>(body).unwrap().0 = rate;
}

/// Depth of a point in the body's axes inside its collider \[m\].
pub fn depth(world: &World, body: Entity, point: Vec3) -> f32 {
    let shape = world.get::<Collider>(body).unwrap().shape_scaled();
    if let Some(field) = shape.as_heightfield() {
        return crate::terrain::depth(field.triangles().map(|t| [t.a, t.b, t.c]), point);
    }
    let near = shape.project_local_point(point, false);
    let distance = near.point.distance(point);
    if near.is_inside { distance } else { -distance }
}
