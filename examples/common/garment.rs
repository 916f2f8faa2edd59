//! A skirt from a glTF file on a wooden figure.

use bevy::{gltf::GltfPlugin, prelude::*};
use tailorbird::{
    fabric::{Texels, with_mipmaps},
    prelude::*,
};

use super::{
    scenes::{SceneAssets, SceneCloth, SceneEntity, SceneKind},
    settings::DemoSettings,
};

/// Tells Bevy what `_CLOTH_PIN` is, which it knows without the first underscore.
pub fn gltf() -> GltfPlugin {
    GltfPlugin::default().add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_CLOTH_PIN)
}

/// Gives the textures of a glTF file their smaller copies, without which a weave far away is a flickering pattern.
pub fn add_mipmaps(
    mut events: MessageReader<AssetEvent<Image>>,
    server: Res<AssetServer>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut changed = false;
    for event in events.read() {
        let AssetEvent::Added { id } = *event else {
            continue;
        };
        let (Some(path), Some(image)) = (server.get_path(id), images.get(id)) else {
            continue;
        };
        let name = path.to_string();
        if !name.contains("textures/") || image.texture_descriptor.mip_level_count > 1 {
            continue;
        }
        let texels = if name.contains("albedo") {
            Texels::Color
        } else if name.contains("normal") {
            Texels::Normal
        } else {
            Texels::Value
        };
        let small = with_mipmaps(image.clone(), texels);
        match images.insert(id, small) {
            Ok(()) => changed = true,
            Err(error) => warn!("{name}: {error}"),
        }
    }
    if changed {
        // They keep what they had bound until they change themselves.
        materials.iter_mut().for_each(drop);
    }
}

/// The skirt (`assets/garments/skirt.gltf`, made by `cargo xtask garment`) on a figure that the keys move: a waistband of denim and
/// panels of cotton are two meshes with materials of their own and become one cloth, held by what is painted on it.
pub fn spawn(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    let wood = assets.painted(Color::srgb(0.74, 0.66, 0.54), 0.6, 0.0);
    // What is seen is a little smaller than what the skirt lies on.
    const UNDER: f32 = 0.004;
    let mut ball = |radius: f32, height: f32| {
        (
            ClothCollider::sphere(radius).with_friction(0.3),
            assets.sphere(radius - UNDER),
            wood.clone(),
            Transform::from_xyz(0.0, height, 0.0),
        )
    };
    let balls = [ball(0.115, 1.12), ball(0.155, 0.88)];
    let mut leg = |z: f32| {
        let (radius, length) = (0.075, 0.62);
        (
            ClothCollider::capsule(radius, length).with_friction(0.3),
            assets.mesh(Capsule3d::new(radius - UNDER, length)),
            wood.clone(),
            Transform::from_xyz(0.0, 0.41, z),
        )
    };
    let legs = [leg(-0.1), leg(0.1)];
    let foot = (
        assets.mesh(Cylinder::new(0.24, 0.03)),
        wood.clone(),
        Transform::from_xyz(0.0, 0.015, 0.0),
    );
    let skirt = (
        SceneCloth {
            size: SceneKind::Garment.size(),
        },
        assets.gltf("garments/skirt.gltf"),
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
        settings.material,
        settings.solver,
        settings.shading,
    );
    commands
        .spawn((
            Name::new("figure"),
            SceneEntity,
            ClothSphereControls::default(),
            Transform::default(),
            Visibility::default(),
        ))
        .with_children(|figure| {
            for ball in balls {
                figure.spawn(ball);
            }
            for leg in legs {
                figure.spawn(leg);
            }
            figure.spawn(foot);
            figure.spawn(skirt);
        });
}
