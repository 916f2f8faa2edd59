//! Positions of vertices in the frame before.

use bevy_asset::Assets;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;

use super::{ATTRIBUTE_PREVIOUS_POSITION, ClothMesh, ClothMeshSettings};

/// Gives the meshes of cloths a place for the positions of the frame before, or takes it away.
pub(super) fn add_previous_positions(
    settings: Res<ClothMeshSettings>,
    mut cloths: Query<&mut ClothMesh>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let wanted = settings.motion_vectors;
    for mut cloth in &mut cloths {
        for part in &mut cloth.bypass_change_detection().parts {
            part.fit_attribute(&mut meshes, ATTRIBUTE_PREVIOUS_POSITION, wanted, |count| {
                vec![[0.0f32; 3]; count].into()
            });
        }
    }
}
