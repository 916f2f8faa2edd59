//! Strips of silk that hang from a beam, and a fan that goes to and fro in front of them: a `ClothWindZone` is a child of the fan, and
//! moves the air in a box before it. Nothing else moves.
//!
//! Space: show the zone and its air. Drag the strips with the left mouse button.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use tailorbird::prelude::*;

#[derive(Component)]
#[require(Transform, Visibility)]
struct Fan;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.76, 0.78, 0.80)))
        .add_systems(Startup, setup)
        .add_systems(Update, show_air)
        .add_systems(FixedUpdate, move_fan)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let dark = MeshMaterial3d(materials.add(Color::srgb(0.16, 0.17, 0.19)));
    let (strips, apart, height) = (14, 0.2, 1.9);
    for k in 0..strips {
        let hue = 360.0 * k as f32 / strips as f32;
        commands.spawn((
            Cloth::grid(Vec2::new(0.16, 1.5), UVec2::new(7, 57)).with_origin(Vec2::new(0.5, 0.0)),
            ClothPins::edges([ClothEdge::Top]),
            ClothMaterial::silk(),
            ClothLook::new(ClothFabric::SILK).with_dye(Color::hsl(hue, 0.6, 0.5)),
            Transform::from_xyz(apart * (k as f32 - 0.5 * (strips - 1) as f32), height, 0.0),
        ));
    }
    commands.spawn((
        Mesh3d(meshes.add(Cylinder::new(0.02, apart * strips as f32))),
        dark.clone(),
        Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_z(FRAC_PI_2)),
    ));

    let fan = commands.spawn(Fan).id();
    commands.spawn((
        ClothWindZone {
            // The air rises from nothing at the border to its full speed so far inside.
            falloff: 0.2,
            turbulence: ClothTurbulence {
                speed: 0.8,
                scale: 0.4,
                ..default()
            },
            ..ClothWindZone::cuboid(Vec3::new(0.8, 0.8, 2.4), 5.0 * Vec3::NEG_Z)
        },
        Transform::from_xyz(0.0, 0.0, -1.2),
        ChildOf(fan),
    ));
    let forward = Quat::from_rotation_x(FRAC_PI_2);
    let parts: [(Mesh, Transform); 3] = [
        (
            Torus::new(0.21, 0.24).into(),
            Transform::from_rotation(forward),
        ),
        (
            Capsule3d::new(0.06, 0.1).into(),
            Transform::from_xyz(0.0, 0.0, 0.06).with_rotation(forward),
        ),
        (
            Cylinder::new(0.015, 0.75).into(),
            Transform::from_xyz(0.0, -0.42, 0.1),
        ),
    ];
    for (mesh, place) in parts {
        commands.spawn((Mesh3d(meshes.add(mesh)), dark.clone(), place, ChildOf(fan)));
    }

    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.44, 0.43, 0.41))),
    ));
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
        Transform::from_xyz(2.1, 1.8, 3.7).looking_at(Vec3::new(0.0, 0.8, 0.3), Vec3::Y),
    ));
}

fn move_fan(time: Res<Time>, mut fan: Single<&mut Transform, With<Fan>>) {
    **fan = Transform::from_xyz(1.1 * (0.9 * time.elapsed_secs()).sin(), 0.8, 1.1);
}

fn show_air(keys: Res<ButtonInput<KeyCode>>, mut store: ResMut<GizmoConfigStore>) {
    if keys.just_pressed(KeyCode::Space) {
        let gizmos = store.config_mut::<ClothGizmos>().1;
        gizmos.wind = !gizmos.wind;
    }
}
