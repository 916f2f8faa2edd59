//! A skirt from a glTF file (`assets/garments/skirt.gltf`) on a figure that turns to and fro: a waistband of denim and panels of
//! cotton, two meshes with materials of their own, become one cloth, held by what is painted on it (`_CLOTH_PIN`).
//!
//! Drag it with the left mouse button.

use std::f32::consts::TAU;

use bevy::{app::RunFixedMainLoopSystems::AfterFixedMainLoop, gltf::GltfPlugin, prelude::*};
use tailorbird::{
    fabric::{Texels, with_mipmaps},
    prelude::*,
};

#[derive(Component)]
#[require(Transform, Visibility)]
struct Figure;

fn main() {
    // Bevy wants to be told of attributes of a file's own, without their first underscore.
    let gltf = GltfPlugin::default().add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_CLOTH_PIN);
    App::new()
        .add_plugins((
            DefaultPlugins.set(gltf),
            ClothPlugins::default(),
            ClothDragPlugin,
        ))
        .insert_resource(ClearColor(Color::srgb(0.76, 0.76, 0.74)))
        .add_systems(Startup, setup)
        .add_systems(Update, add_mipmaps)
        .add_systems(FixedUpdate, turn)
        .add_systems(RunFixedMainLoop, turn.in_set(AfterFixedMainLoop))
        .run();
}

fn setup(
    mut commands: Commands,
    server: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let figure = commands.spawn(Figure).id();
    commands.spawn((
        WorldAssetRoot(server.load(GltfAssetLabel::Scene(0).from_asset("garments/skirt.gltf"))),
        // Waits until the meshes are loaded. Names of nodes would choose some of them.
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
        ClothMaterial::cotton(),
        ChildOf(figure),
    ));

    // Waist, hips and legs, a little smaller than what cloth meets: it must not touch what is seen.
    let wood = MeshMaterial3d(materials.add(Color::srgb(0.74, 0.64, 0.50)));
    let body = [
        (0.12, 0.3, Vec3::new(0.0, 1.18, 0.0)),
        (0.155, 0.0, Vec3::new(0.0, 0.88, 0.0)),
        (0.075, 0.62, Vec3::new(0.0, 0.41, -0.1)),
        (0.075, 0.62, Vec3::new(0.0, 0.41, 0.1)),
    ];
    for (radius, length, place) in body {
        commands.spawn((
            ClothCollider::capsule(radius, length).with_friction(0.3),
            Mesh3d(meshes.add(Capsule3d::new(radius - 0.004, length))),
            wood.clone(),
            Transform::from_translation(place),
            ChildOf(figure),
        ));
    }

    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.42, 0.40, 0.38))),
    ));
    commands.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(3.0, 3.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(2.0, 1.2, 0.6).looking_at(0.75 * Vec3::Y, Vec3::Y),
    ));
}

/// Runs in each step, where cloth sees it, and once a frame: cloth is drawn between its last two steps, and so is the figure.
fn turn(time: Res<Time>, step: Res<Time<Fixed>>, mut figure: Single<&mut Transform, With<Figure>>) {
    let is_frame = time.elapsed() != step.elapsed();
    let late = f32::from(is_frame) * step.timestep().as_secs_f32();
    let t = (time.elapsed_secs() - late).max(0.0);
    // It begins slowly.
    let swing = (0.25 * t).min(1.0) * (TAU * t / 3.0).sin();
    **figure = Transform::from_xyz(0.0, 0.0, 0.2 * swing)
        .with_rotation(Quat::from_rotation_y(1.3 * swing));
}

/// Bevy makes no smaller copies of a file's textures: without them a weave far away is a flickering pattern.
fn add_mipmaps(
    mut events: MessageReader<AssetEvent<Image>>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    for event in events.read() {
        if let AssetEvent::LoadedWithDependencies { id } = *event
            && let Some(image) = images.get(id).cloned()
        {
            let srgb = image.texture_descriptor.format.is_srgb();
            let texels = if srgb { Texels::Color } else { Texels::Value };
            images.insert(id, with_mipmaps(image, texels))?;
            // They keep what they had bound until they change themselves.
            materials.iter_mut().for_each(drop);
        }
    }
    Ok(())
}
