//! A skirt on somebody who walks on the spot and turns. No collider is near: each particle has a target, which the animation moves
//! with the legs, and `ClothMotionConstraints` says how far it may get from there, and how far towards the legs.
//!
//! Drag the skirt with the left mouse button: it comes as far as its limits.

use std::f32::consts::TAU;

use bevy::prelude::*;
use tailorbird::prelude::*;

/// A leg, and on which side it is.
#[derive(Component)]
struct Leg(f32);

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.76, 0.76, 0.74)))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, walk)
        .run();
}

/// Around the waist and down, in so many columns and rows, and how long it is [m].
const SKIRT: (u32, u32, f32) = (96, 31, 0.6);

/// A cone without a seam: the last column is joined to the first.
fn skirt() -> Cloth {
    let (columns, rows, length) = SKIRT;
    let place = |i: u32| {
        let down = (i / columns) as f32 / (rows - 1) as f32;
        let (sin, cos) = (TAU * (i % columns) as f32 / columns as f32).sin_cos();
        let radius = 0.14 + 0.26 * down;
        Vec3::new(radius * sin, -length * down, radius * cos)
    };
    let quads = (0..columns * (rows - 1)).flat_map(|a| {
        let b = a / columns * columns + (a + 1) % columns;
        let (c, d) = (a + columns, b + columns);
        [a, c, d, a, d, b]
    });
    let places = (0..columns * rows).map(place).collect::<Vec<_>>();
    Cloth::mesh(places, quads.collect::<Vec<_>>())
}

/// The waist is held, as by pins; the hem gets 15 cm away from its target, and 4 cm towards the legs.
fn limits(skirt: &Cloth) -> ClothMotionConstraints {
    let rest = skirt.rest_positions().into_iter();
    let down: Vec<_> = rest.map(|place| -place.y / SKIRT.2).collect();
    let behind = ClothPerParticle::weighted(down.iter().copied(), 0.04);
    ClothMotionConstraints::at_most(ClothPerParticle::weighted(down, 0.15))
        .with_backstop(behind, 0.4)
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = MeshMaterial3d(materials.add(Color::srgb(0.74, 0.64, 0.50)));
    let trunk = Mesh3d(meshes.add(Capsule3d::new(0.13, 0.35)));
    let trunk = (trunk, wood.clone(), Transform::from_xyz(0.0, 0.12, 0.0));
    // Hangs from the hip, which is its origin.
    let leg = Capsule3d::new(0.07, 0.75).mesh().build();
    let leg = Mesh3d(meshes.add(leg.translated_by(-0.45 * Vec3::Y)));
    let leg = |side| {
        let hip = Transform::from_xyz(0.08 * side, -0.05, 0.0);
        (Leg(side), leg.clone(), wood.clone(), hip)
    };
    let skirt = skirt();
    commands.spawn((
        limits(&skirt),
        skirt,
        ClothMotionTargets::default(),
        ClothMaterial::cotton(),
        MeshMaterial3d(materials.add(Color::srgb(0.10, 0.42, 0.42))),
        Transform::from_xyz(0.0, 1.0, 0.0),
        children![trunk, leg(-1.0), leg(1.0)],
    ));

    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.42, 0.40, 0.38))),
    ));
    commands.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(-2.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(0.0, 1.2, 2.7).looking_at(0.75 * Vec3::Y, Vec3::Y),
    ));
}

/// Turns all, swings the legs, and each particle's target with the leg on its side.
fn walk(
    time: Res<Time>,
    mut skirt: Single<(&Cloth, &mut ClothMotionTargets, &mut Transform)>,
    mut legs: Query<(&Leg, &mut Transform), Without<Cloth>>,
) {
    let t = time.elapsed_secs();
    let (cloth, targets, place) = &mut *skirt;
    place.rotation = Quat::from_rotation_y(1.2 * (0.9 * t).sin());
    let swing = 0.35 * (TAU * 0.8 * t).sin();
    for (leg, mut transform) in &mut legs {
        transform.rotation = Quat::from_rotation_x(swing * leg.0);
    }
    let rest = cloth.rest_positions();
    targets.set_positions(rest.into_iter().map(|place| {
        let side = (place.x / 0.15).clamp(-1.0, 1.0);
        place + Vec3::Z * (swing * side).sin() * place.y
    }));
}
