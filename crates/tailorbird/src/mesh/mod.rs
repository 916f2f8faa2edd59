//! From particles to the picture: builds a mesh for each cloth and writes it once per frame.

mod build;
mod from_mesh;
pub mod garments;
mod parts;
mod pins;
mod tangents;
mod vertices;
mod write;

pub use build::{ClothMesh, ClothMeshOf, ClothMeshPart};
pub use from_mesh::ClothFromMesh;
pub use parts::MeshParts;
pub use pins::{ATTRIBUTE_CLOTH_PIN, ColorChannel, MeshPins};

use bevy_app::{App, Plugin, PostUpdate, PreUpdate};
use bevy_asset::{AssetEventSystems, Assets};
use bevy_camera::visibility::VisibilitySystems;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;
use bevy_pbr::StandardMaterial;
use bevy_transform::TransformSystems;

/// Builds a mesh for each cloth (positions, normals, UVs, tangents), and writes it once per frame, in `PostUpdate`.
///
/// Makes the `StandardMaterial` of cloths two-sided as well: a cloth has a back.
pub struct ClothMeshPlugin {
    /// Draws cloth between the last two steps, where the current frame is. For a simulation in a schedule with a fixed
    /// time step; without it motion would stutter wherever steps and frames do not coincide.
    pub interpolate: bool,
}

impl Default for ClothMeshPlugin {
    fn default() -> Self {
        Self { interpolate: true }
    }
}

/// The systems that build and write meshes, in `PostUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClothMeshSystems;

/// How meshes are written.
#[derive(Resource)]
struct ClothMeshSettings {
    interpolate: bool,
}

impl Plugin for ClothMeshPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ClothFromMesh>()
            .insert_resource(ClothMeshSettings {
                interpolate: self.interpolate,
            })
            .configure_sets(
                PostUpdate,
                ClothMeshSystems
                    // What holds cloth is where it is drawn.
                    .after(TransformSystems::Propagate)
                    .before(AssetEventSystems)
                    .before(VisibilitySystems::CheckVisibility)
                    .before(VisibilitySystems::CalculateBounds)
                    .run_if(resource_exists::<Assets<Mesh>>),
            )
            .add_systems(
                PreUpdate,
                from_mesh::cloth_from_mesh.run_if(resource_exists::<Assets<Mesh>>),
            )
            .add_systems(
                PostUpdate,
                (
                    build::build_cloth_mesh,
                    write::write_cloth_mesh,
                    build::make_materials_two_sided
                        .run_if(resource_exists::<Assets<StandardMaterial>>),
                )
                    .chain()
                    .in_set(ClothMeshSystems),
            );
    }
}
