//! Meshes, materials and files of the scenes.

use bevy::{ecs::system::SystemParam, prelude::*};

/// Of something that is drawn.
pub type MaterialOf = MeshMaterial3d<StandardMaterial>;

/// Everything that is needed to show a scene.
#[derive(SystemParam)]
pub struct SceneAssets<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
    server: Res<'w, AssetServer>,
}

impl SceneAssets<'_> {
    /// A ball of this radius [m].
    pub fn sphere(&mut self, radius: f32) -> Mesh3d {
        Mesh3d(self.meshes.add(Sphere::new(radius).mesh().uv(64, 32)))
    }

    /// A scene from a glTF file in the folder of assets.
    pub fn gltf(&self, path: &'static str) -> WorldAssetRoot {
        WorldAssetRoot(self.server.load(GltfAssetLabel::Scene(0).from_asset(path)))
    }

    /// A mesh of this shape.
    pub fn mesh(&mut self, shape: impl Into<Mesh>) -> Mesh3d {
        Mesh3d(self.meshes.add(shape))
    }

    /// A plain material.
    pub fn painted(&mut self, color: Color, roughness: f32, metallic: f32) -> MaterialOf {
        MeshMaterial3d(self.materials.add(StandardMaterial {
            base_color: color,
            perceptual_roughness: roughness,
            metallic,
            ..default()
        }))
    }
}
