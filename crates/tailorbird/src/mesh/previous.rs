//! Where vertices were in the frame before.

use bevy_asset::Assets;
use bevy_ecs::prelude::*;
use bevy_mesh::{Mesh, MeshVertexAttribute, VertexFormat};

use super::{ClothMesh, ClothMeshSettings};

/// Where a vertex was in the frame before, in the space of its mesh \[m\].
pub const ATTRIBUTE_PREVIOUS_POSITION: MeshVertexAttribute = MeshVertexAttribute::new(
    "Vertex_Cloth_Previous_Position",
    0x7a11_0b1d_c107_0002,
    VertexFormat::Float32x3,
);

/// Gives the meshes of cloths a place for the positions of the frame before, or takes it away.
pub(super) fn add_previous_positions(
    settings: Res<ClothMeshSettings>,
    mut cloths: Query<&mut ClothMesh>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let wanted = settings.motion_vectors;
    for mut cloth in &mut cloths {
        for part in &mut cloth.bypass_change_detection().parts {
            let has = |mesh: &Mesh| {
                mesh.try_contains_attribute(ATTRIBUTE_PREVIOUS_POSITION)
                    .is_ok_and(|has| has != wanted)
            };
            if !meshes.get(&part.handle).is_some_and(has) {
                continue;
            }
            let Some(mut mesh) = meshes.get_mut(&part.handle) else {
                continue;
            };
            let changed = if wanted {
                let places = vec![[0.0f32; 3]; mesh.count_vertices()];
                mesh.try_insert_attribute(ATTRIBUTE_PREVIOUS_POSITION, places)
                    .is_ok()
            } else {
                mesh.try_remove_attribute(ATTRIBUTE_PREVIOUS_POSITION)
                    .is_ok()
            };
            part.own_change |= changed;
        }
    }
}
