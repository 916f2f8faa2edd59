//! Crates and a ball, bodies of the physics engine avian, fall on a sheet that carries them. Avian's colliders keep cloth out as
//! they are, and cloth stops, carries and pushes avian's bodies.
//!
//! Drag the sheet with the left mouse button.

use std::f32::consts::FRAC_PI_2;

use avian3d::prelude::*;
use bevy::prelude::*;
use tailorbird::prelude::*;
use tailorbird_avian::ClothAvianPlugin;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .add_plugins((ClothPlugins::default(), ClothDragPlugin))
        .add_plugins(ClothAvianPlugin::default())
        .insert_resource(ClearColor(Color::srgb(0.72, 0.76, 0.80)))
        .add_systems(Startup, (spawn_sheet, spawn_bodies, spawn_camera))
        .run();
}

/// Of the sheet's corners from its middle, and above the ground [m].
const CORNERS: (f32, f32) = (1.1, 1.5);

/// A sheet of denim whose corners are nearer to each other than it is wide, so that it sags.
fn spawn_sheet(mut commands: Commands) {
    let (side, height) = CORNERS;
    let held = |corner, x: f32, y: f32| ClothPin {
        target: Some(side * Vec3::new(x, y, 0.0)),
        ..ClothPin::new(ClothSelection::Corner(corner))
    };
    commands.spawn((
        Cloth::grid(Vec2::splat(2.4), UVec2::splat(65)).centered(),
        ClothPins::default()
            .with(held(ClothCorner::TopLeft, -1.0, 1.0))
            .with(held(ClothCorner::TopRight, 1.0, 1.0))
            .with(held(ClothCorner::BottomLeft, -1.0, -1.0))
            .with(held(ClothCorner::BottomRight, 1.0, -1.0)),
        ClothFabric::DENIM.bundle(),
        Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
    ));
}

/// One above the other, posts under the sheet's corners, and the ground.
fn spawn_bodies(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = MeshMaterial3d(materials.add(Color::srgb(0.48, 0.32, 0.18)));
    let crates = [(0.36, 4.0, 2.3), (0.28, 2.0, 3.6), (0.32, 3.0, 5.2)];
    for (k, (side, mass, height)) in crates.into_iter().enumerate() {
        let turn = Quat::from_scaled_axis(Vec3::new(0.4, 0.9, 0.2) * (k + 1) as f32);
        commands.spawn((
            RigidBody::Dynamic,
            Collider::cuboid(side, side, side),
            Mass(mass),
            Mesh3d(meshes.add(Cuboid::from_length(side))),
            wood.clone(),
            Transform::from_xyz(0.1, height, 0.05).with_rotation(turn),
        ));
    }
    let radius = 0.16;
    commands.spawn((
        RigidBody::Dynamic,
        Collider::sphere(radius),
        Mass(2.0),
        Mesh3d(meshes.add(Sphere::new(radius))),
        MeshMaterial3d(materials.add(Color::srgb(0.75, 0.18, 0.10))),
        Transform::from_xyz(0.3, 8.0, 0.1),
    ));
    let (side, height) = CORNERS;
    let post = meshes.add(Cylinder::new(0.02, height));
    for (x, z) in [(-side, -side), (side, -side), (-side, side), (side, side)] {
        commands.spawn((
            Mesh3d(post.clone()),
            wood.clone(),
            Transform::from_xyz(x, 0.5 * height, z),
        ));
    }
    commands.spawn((
        RigidBody::Static,
        Collider::half_space(Vec3::Y),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.40, 0.42, 0.40))),
    ));
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(-2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(1.9, 2.5, 3.7).looking_at(0.95 * Vec3::Y, Vec3::Y),
    ));
}
