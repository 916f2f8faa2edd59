//! A flag of silk on a pole in a gusty wind.
//!
//! W and S: a stronger and a weaker wind. A and D: turn it. Drag the flag with the left mouse button.

use bevy::prelude::*;
use tailorbird::prelude::*;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.55, 0.70, 0.85)))
        .insert_resource(ClothWind {
            gusts: ClothGusts {
                strength: 0.4,
                period: 3.0,
            },
            turbulence: ClothTurbulence {
                speed: 1.2,
                scale: 1.5,
                seed: 1,
            },
            ..ClothWind::steady(Vec3::new(7.0, 0.0, 1.0))
        })
        .add_systems(Startup, setup)
        .add_systems(Update, change_wind)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Cloth::grid(Vec2::new(1.8, 1.2), UVec2::new(73, 49)),
        ClothPins::edges([ClothEdge::Left]),
        ClothMaterial::silk(),
        ClothLook::new(ClothFabric::SILK).with_dye(Color::srgb(0.93, 0.50, 0.10)),
        Transform::from_xyz(0.03, 2.5, 0.0),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Cylinder::new(0.025, 4.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.85, 0.86))),
        Transform::from_xyz(0.0, 0.6, 0.0),
    ));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::from_xyz(-2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(1.3, 1.5, 2.4).looking_at(Vec3::new(0.8, 1.85, 0.0), Vec3::Y),
    ));
}

fn change_wind(keys: Res<ButtonInput<KeyCode>>, time: Res<Time>, mut wind: ResMut<ClothWind>) {
    let axis = |more, less| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let stronger = axis(KeyCode::KeyW, KeyCode::KeyS) * time.delta_secs();
    let turn = axis(KeyCode::KeyA, KeyCode::KeyD) * time.delta_secs();
    if stronger != 0.0 || turn != 0.0 {
        let turned = Quat::from_rotation_y(turn) * wind.velocity;
        wind.velocity = (turned * (1.0 + stronger)).clamp_length(0.1, 20.0);
    }
}
