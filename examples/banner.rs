//! A banner on a boat that pitches and rolls in a gusty wind. It is a child of the boat, held by nine rings: pins move with the
//! entity, and what is free keeps its place in the world until it is pulled along.
//!
//! Space: a calm, or the wind again. Drag the banner with the left mouse button.

use std::f32::consts::FRAC_PI_2;

use bevy::{app::RunFixedMainLoopSystems::AfterFixedMainLoop, prelude::*};
use tailorbird::prelude::*;

#[derive(Component)]
#[require(Transform, Visibility)]
struct Boat;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.62, 0.72, 0.82)))
        .insert_resource(ClothWind {
            gusts: ClothGusts {
                strength: 0.5,
                period: 2.5,
            },
            // In air without eddies it would stay as plain as a board.
            turbulence: ClothTurbulence {
                speed: 0.7,
                scale: 0.9,
                ..default()
            },
            ..ClothWind::steady(WIND)
        })
        .add_systems(Startup, setup)
        .add_systems(Update, change_wind)
        .add_systems(FixedUpdate, sail)
        .add_systems(RunFixedMainLoop, sail.in_set(AfterFixedMainLoop))
        .run();
}

/// Mean velocity of the air [m/s].
const WIND: Vec3 = Vec3::new(0.5, 0.0, 1.2);

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = MeshMaterial3d(materials.add(Color::srgb(0.40, 0.26, 0.15)));
    let boat = commands.spawn(Boat).id();
    let hull = ConicalFrustum {
        radius_top: 1.0,
        radius_bottom: 0.6,
        height: 0.4,
    };
    commands.spawn((
        Mesh3d(meshes.add(hull)),
        wood.clone(),
        Transform::from_xyz(0.0, 0.1, 0.0).with_scale(Vec3::new(1.7, 1.0, 0.6)),
        ChildOf(boat),
    ));
    let upright = Transform::from_xyz(0.0, 1.3, -0.06);
    let across = Transform::from_xyz(0.0, 2.32, 0.0);
    let across = across.with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    for (radius, length, place) in [(0.035, 2.3, upright), (0.022, 1.3, across)] {
        commands.spawn((
            ClothCollider::capsule(radius, length),
            Mesh3d(meshes.add(Capsule3d::new(radius, length))),
            wood.clone(),
            place,
            ChildOf(boat),
        ));
    }
    let columns = 41;
    commands.spawn((
        Cloth::grid(Vec2::new(1.2, 1.5), UVec2::new(columns, 51)).with_origin(Vec2::new(0.5, 0.0)),
        ClothPins::particles((0..=8).map(|ring| ring * (columns - 1) / 8)),
        ClothMaterial::cotton(),
        ClothLook::new(ClothFabric::COTTON).with_dye(Color::srgb(0.75, 0.12, 0.08)),
        Transform::from_xyz(0.0, 2.29, 0.03),
        ChildOf(boat),
    ));

    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.10, 0.24, 0.30))),
    ));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::from_xyz(-2.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(1.6, 1.7, 4.0).looking_at(1.15 * Vec3::Y, Vec3::Y),
    ));
}

/// Runs in each step, where cloth sees it, and once a frame: cloth is drawn between its last two steps, and so is the boat.
fn sail(time: Res<Time>, step: Res<Time<Fixed>>, mut boat: Single<&mut Transform, With<Boat>>) {
    let is_frame = time.elapsed() != step.elapsed();
    let late = f32::from(is_frame) * step.timestep().as_secs_f32();
    let t = time.elapsed_secs() - late;
    let roll = Quat::from_rotation_x(0.18 * (1.3 * t).sin());
    let pitch = Quat::from_rotation_z(0.12 * (1.9 * t).sin());
    **boat = Transform::from_xyz(0.0, 0.08 * (1.7 * t).sin(), 0.0).with_rotation(roll * pitch);
}

fn change_wind(keys: Res<ButtonInput<KeyCode>>, mut wind: ResMut<ClothWind>) {
    if keys.just_pressed(KeyCode::Space) {
        wind.velocity = WIND - wind.velocity;
    }
}
