//! Two curtains and two balls that swing through both. Each ball meets the curtain of its own colour, and goes through the other
//! one as if that were not there: `ClothLayers` says who meets whom.
//!
//! Space: all meet all, or by layers again. Drag the curtains with the left mouse button.

use bevy::prelude::*;
use tailorbird::prelude::*;

/// A layer is a bit.
const ORANGE: u32 = 1 << 0;
const BLUE: u32 = 1 << 1;

#[derive(Component)]
struct Ball;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.78, 0.78, 0.76)))
        .add_systems(Startup, setup)
        .add_systems(Update, change_layers)
        .add_systems(FixedUpdate, swing)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let radius = 0.22;
    let sphere = meshes.add(Sphere::new(radius).mesh().uv(48, 24));
    let brass = MeshMaterial3d(materials.add(Color::srgb(0.55, 0.45, 0.28)));
    let rail = meshes.add(Capsule3d::new(0.015, 1.7));
    for (layer, color, side) in [
        (ORANGE, Color::srgb(0.85, 0.38, 0.08), 1.0),
        (BLUE, Color::srgb(0.10, 0.28, 0.60), -1.0),
    ] {
        // Hung by every fourth particle in a zigzag, closer to each other than the cloth is wide, so that it has folds. In a
        // perfect plane it would not know which way to fold.
        let hooks = (0..=18).map(|k| {
            let aside = if k % 2 == 0 { 0.02 } else { -0.02 };
            ClothPin::at(4 * k, Vec3::new(0.85 * (k as f32 / 9.0 - 1.0), 0.0, aside))
        });
        commands.spawn((
            Cloth::grid(Vec2::new(1.95, 1.4), UVec2::new(73, 49)).with_origin(Vec2::new(0.5, 0.0)),
            ClothPins {
                pins: hooks.collect(),
            },
            ClothLayers::new(layer, layer),
            ClothMaterial::cotton(),
            ClothLook::new(ClothFabric::COTTON).with_dye(color),
            Transform::from_xyz(0.0, 1.7, 0.5 * side),
        ));
        commands.spawn((
            Mesh3d(rail.clone()),
            brass.clone(),
            Transform::from_xyz(0.0, 1.71, 0.5 * side)
                .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)),
        ));
        commands.spawn((
            Ball,
            // Cells of the cloth would cut a little into what is round.
            ClothCollider::sphere(radius).with_margin(0.01),
            ClothLayers::new(layer, layer),
            Mesh3d(sphere.clone()),
            MeshMaterial3d(materials.add(color)),
            Transform::from_xyz(0.4 * side, 0.95, 0.0),
        ));
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
        Transform::from_xyz(-1.0, 4.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(2.6, 1.8, 2.1).looking_at(Vec3::Y, Vec3::Y),
    ));
}

fn swing(time: Res<Time>, mut balls: Query<&mut Transform, With<Ball>>) {
    for mut transform in &mut balls {
        transform.translation.z = 0.75 * (1.1 * time.elapsed_secs()).sin();
    }
}

/// Without layers a cloth or a collider meets all that wants to meet it.
fn change_layers(
    keys: Res<ButtonInput<KeyCode>>,
    mut layers: Query<&mut ClothLayers>,
    mut set_aside: Local<Vec<ClothLayers>>,
) {
    if keys.just_pressed(KeyCode::Space) {
        let others = std::mem::take(&mut *set_aside);
        for (k, mut layers) in layers.iter_mut().enumerate() {
            set_aside.push(*layers);
            *layers = others.get(k).copied().unwrap_or(ClothLayers::ALL);
        }
    }
}
