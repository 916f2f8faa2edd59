//! Meshes have tangents where their material looks at them.
//!
//! Bevy turns the normal of a back towards its viewer where there is a normal map, and where there are no tangents; with tangents alone it
//! does not, and the back of a plain cloth would take light from the other side.

use bevy_asset::Assets;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;
use bevy_pbr::{MeshMaterial3d, StandardMaterial};

use super::ClothMesh;

/// Returns whether a material needs tangents.
fn wants_tangents(material: &StandardMaterial) -> bool {
    material.normal_map_texture.is_some()
        || material.depth_map.is_some()
        || material.anisotropy_strength != 0.0
        || material.clearcoat > 0.0
}

/// Gives the meshes of cloths a place for tangents, or takes it away. One whose material is another one, or not there yet, stays as
/// it is.
pub(super) fn fit_tangents(
    mut cloths: Query<&mut ClothMesh>,
    shown: Query<&MeshMaterial3d<StandardMaterial>>,
    materials: Res<Assets<StandardMaterial>>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for mut cloth in &mut cloths {
        for part in &mut cloth.bypass_change_detection().parts {
            let material = shown.get(part.entity).ok();
            let Some(material) = material.and_then(|shown| materials.get(&shown.0)) else {
                continue;
            };
            let wanted = wants_tangents(material);
            if !wanted || part.follow.tangents.is_some() {
                part.fit_attribute(&mut meshes, Mesh::ATTRIBUTE_TANGENT, wanted, |count| {
                    vec![[0.0f32; 4]; count].into()
                });
            }
        }
    }
}
