//! Rapier, as the tests see it.

use bevy_app::{App, FixedPostUpdate};
use bevy_ecs::prelude::*;
use bevy_math::{Mat3, Vec3};
use bevy_rapier3d::{
    parry::{shape::SharedShape, utils::Array2},
    prelude::*,
};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::ClothPlugin;
use tailorbird_rapier::{ClothCollisionDisabled, ClothRapierPlugin};

use crate::world::{Body, Contact, Form, HZ, Kind, Motion};

pub fn add(app: &mut App, gravity: Vec3) {
    let start = RapierContextInitialization::InitializeDefaultRapierContext {
        integration_parameters: Default::default(),
        broad_phase_optimization_strategy: Default::default(),
        rapier_configuration: RapierConfiguration {
            gravity,
            ..RapierConfiguration::new(1.0)
        },
    };
    app.insert_resource(TimestepMode::Fixed {
        dt: 1.0 / HZ as f32,
        substeps: 1,
    });
    app.add_plugins((
        RapierPhysicsPlugin::<NoUserData>::default()
            .with_custom_initialization(start)
            .in_schedule(FixedPostUpdate),
        ClothPlugin::default(),
        ClothRapierPlugin::default(),
    ));
}

fn collider(form: &Form) -> Collider {
    match form {
        Form::Ball(radius) => Collider::ball(*radius),
        Form::Box(sides) => Collider::cuboid(0.5 * sides.x, 0.5 * sides.y, 0.5 * sides.z),
        Form::RoundBox(sides, radius) => {
            Collider::round_cuboid(0.5 * sides.x, 0.5 * sides.y, 0.5 * sides.z, *radius)
        }
        Form::Capsule(radius, a, b) => Collider::capsule(*a, *b, *radius),
        Form::Cylinder(radius, height) => Collider::cylinder(0.5 * height, *radius),
        Form::Cone(radius, height) => Collider::cone(0.5 * height, *radius),
        Form::Hull(points) => Collider::convex_hull(points).unwrap(),
        Form::Mesh(points, triangles) => {
            Collider::trimesh(points.clone(), triangles.clone()).unwrap()
        }
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
        Form::HalfSpace(normal) => Collider::halfspace(*normal).unwrap(),
    }
}

pub fn spawn(world: &mut World, body: &Body) -> Entity {
    let at =
        Transform::from_translation(body.at.translation.into()).with_rotation(body.at.rotation);
    let kind = match body.kind {
        Kind::Dynamic => RigidBody::Dynamic,
        Kind::Fixed => RigidBody::Fixed,
        Kind::Kinematic => RigidBody::KinematicVelocityBased,
    };
    let mut entity = world.spawn((
        kind,
        collider(&body.form),
        ColliderMassProperties::Mass(body.mass),
        Velocity {
            linear: body.velocity,
            angular: body.spin,
        },
        GravityScale(if body.falls { 1.0 } else { 0.0 }),
        Damping {
            linear_damping: body.damping,
            angular_damping: body.damping,
        },
        at,
    ));
    if !body.sleeps {
        entity.insert(Sleeping::disabled());
    }
    if body.on_rail {
        let rail = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
        entity.insert(rail | LockedAxes::ROTATION_LOCKED);
    }
    match body.contact {
        Contact::Yes => {}
        Contact::Sensor => {
            entity.insert(Sensor);
        }
        Contact::Layers(memberships, filters) => {
            let [memberships, filters] = [memberships, filters].map(Group::from_bits_retain);
            entity.insert(CollisionGroups::new(memberships, filters));
        }
        Contact::Disabled => {
            entity.insert(ClothCollisionDisabled);
        }
    }
    entity.id()
}

pub fn motion(world: &World, body: Entity) -> Motion {
    let entity = world.entity(body);
    let link = entity.get::<RapierContextEntityLink>().unwrap().0;
    let handle = entity.get::<RapierRigidBodyHandle>().unwrap().0;
    let set = world.get::<RapierRigidBodySet>(link).unwrap();
    let body = set.bodies.get(handle).unwrap();
    let i = body.mass_properties().effective_world_inv_inertia;
    let inverse = Mat3::from_cols(
        Vec3::new(i.m11, i.m12, i.m13),
        Vec3::new(i.m12, i.m22, i.m23),
        Vec3::new(i.m13, i.m23, i.m33),
    );
    Motion {
        position: body.translation(),
        rotation: *body.rotation(),
        center: body.center_of_mass(),
        velocity: body.linvel(),
        spin: body.angvel(),
        inertia: inverse.inverse(),
        asleep: body.is_sleeping(),
    }
}

pub fn set_velocity(world: &mut World, body: Entity, velocity: Vec3) {
    world.get_mut::<Velocity>(body).unwrap().linear = velocity;
}

pub fn set_damping(world: &mut World, body: Entity, rate: f32) {
    let mut damping = world.get_mut::<Damping>(body).unwrap();
    damping.linear_damping = rate;
    damping.angular_damping = rate;
}

/// Depth of a point in the body's axes inside its collider \[m\].
pub fn depth(world: &World, body: Entity, point: Vec3) -> f32 {
    let shape = &world.get::<Collider>(body).unwrap().raw;
    if let Some(field) = shape.as_heightfield() {
        return crate::terrain::depth(field.triangles().map(|t| [t.a, t.b, t.c]), point);
    }
    let near = shape.project_local_point(point, false);
    let distance = near.point.distance(point);
    if near.is_inside { distance } else { -distance }
}
