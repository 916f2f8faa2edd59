//! A curtain that hangs by its upper corners, and a ball in front of it that pushes it aside.
//!
//! Arrows, Page Up, Page Down and Shift: move the ball. Drag the curtain with the left mouse button, pin what is held with P.

use bevy::prelude::*;
use tailorbird::prelude::*;

fn main() {
    App::new()
        .add_plugins((
            DefaultPlugins,
            ClothPlugins::default(),
            // For toys: drags cloth with the mouse and pins it by P; moves balls by the arrow keys.
            (ClothDragPlugin, ClothSphereControlsPlugin),
        ))
        .add_systems(Startup, setup)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // 2 m wide, 1.5 m high, with its middle at the entity's origin.
    commands.spawn((
        Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48)).centered(),
        ClothMaterial::cotton(),
        ClothPins::corners(ClothCorner::TOP),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.1, 0.1))),
        Transform::from_xyz(0.0, 1.2, 0.0),
    ));
    // A ball that leans on it: arrows, PageUp and PageDown move it.
    commands.spawn((
        ClothCollider::sphere(0.3),
        ClothSphereControls::default(),
        Mesh3d(meshes.add(Sphere::new(0.3))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.8, 0.8))),
        Transform::from_xyz(0.2, 0.95, 0.1),
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
        Transform::from_xyz(1.2, 1.6, 3.2).looking_at(1.15 * Vec3::Y, Vec3::Y),
    ));
}
