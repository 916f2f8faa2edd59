//! Builds the meshes of a cloth.

use bevy_asset::{AssetId, Assets};
use bevy_camera::visibility::NoAutoAabb;
use bevy_ecs::prelude::*;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use tailorbird_cloth::{
    cloth::{Cloth, ClothShape},
    normals::{ClothNormals, ClothShading},
    topology::ClothTopology,
};

use super::{
    ClothMesh, ClothMeshOf, ClothMeshPart, make::ClothMeshSource, parts::MeshSource,
    vertices::Vertices,
};

/// Builds meshes for cloths that have none, or whose topology or shading changed.
pub(super) fn build_cloth_mesh(
    mut commands: Commands,
    cloths: Query<(
        Entity,
        &Cloth,
        &ClothTopology,
        &ClothShading,
        &ClothNormals,
        Option<&ClothMeshSource>,
        Option<&ClothMesh>,
    )>,
    meshes_of_parts: Query<&Mesh3d>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, cloth, topology, shading, normals, source, built) in &cloths {
        let shows = |part: &ClothMeshPart| match meshes_of_parts.get(part.entity) {
            // Another mesh, where the cloth was made of meshes, becomes another cloth.
            Ok(mesh) => mesh.0 == part.handle || source.is_some(),
            // The cloth itself has lost it; a part that is gone stays away.
            Err(_) => part.entity != entity,
        };
        let made = source.map_or(0, |source| source.made);
        let current = built.is_some_and(|built| {
            built.revision == topology.revision
                && built.made == made
                && built.shading == *shading
                && built.parts.iter().all(shows)
        });
        // The shape may be newer than what was built of it.
        let matches = match &cloth.shape {
            ClothShape::Mesh { positions, .. } => {
                topology.particles_of_vertices().len() == positions.len()
            }
            _ => topology.is_grid(),
        };
        // A mesh that could not be written yet would be nowhere for a while.
        if current || !matches || topology.revision == 0 || normals.shading() != *shading {
            continue;
        }
        let of_meshes = source.and_then(|source| {
            let left_out = source.left_out.as_slice();
            Vertices::of_meshes(&source.parts, &cloth.shape, &meshes, left_out)
        });
        let all: Vec<(Vertices, Option<&MeshSource>)> = match of_meshes {
            Some(all) => all
                .into_iter()
                .map(|(v, source)| (v, Some(source)))
                .collect(),
            None => vec![(Vertices::of_shape(&cloth.shape), None)],
        };
        let mut parts = Vec::with_capacity(all.len());
        for (vertices, source) in all {
            let (mesh, mut part) = vertices.into_mesh(topology, *shading);
            part.entity = source.map_or(entity, |source| source.entity);
            part.follow.from_cloth = source.and_then(|source| Some(source.to_cloth?.inverse()));
            let before = built.and_then(|built| {
                let mut before = built.parts.iter();
                before.find(|before| before.entity == part.entity)
            });
            // The same asset where there is one, so that whoever holds its handle keeps it.
            part.handle = match before.map(|before| before.handle.clone()) {
                Some(handle) if meshes.contains(&handle) => {
                    part.own_change = meshes.insert(&handle, mesh).is_ok();
                    handle
                }
                _ => meshes.add(mesh),
            };
            if let Ok(mut shown) = commands.get_entity(part.entity) {
                let of = ClothMeshOf {
                    cloth: entity,
                    built: part.handle.clone(),
                    source: source.map(|source| source.mesh.clone()),
                    two_sided: !topology.report.backs.is_some(),
                };
                shown.insert((Mesh3d(part.handle.clone()), of, NoAutoAabb));
            }
            parts.push(part);
        }
        commands.entity(entity).insert(ClothMesh {
            revision: topology.revision,
            made,
            shading: *shading,
            parts,
        });
    }
}

/// Makes the materials of cloths two-sided, but those of meshes whose backs have triangles of their own.
pub(crate) fn make_materials_two_sided(
    shown: Query<
        (&ClothMeshOf, &MeshMaterial3d<StandardMaterial>),
        Or<(
            Changed<MeshMaterial3d<StandardMaterial>>,
            Changed<ClothMeshOf>,
        )>,
    >,
    mut waiting: Local<Vec<AssetId<StandardMaterial>>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let two_sided = shown.iter().filter(|(of, _)| of.two_sided);
    waiting.extend(two_sided.map(|(_, material)| material.id()));
    // A material that is still being loaded stays on the list.
    waiting.retain(|id| {
        let Some(material) = materials.get(*id) else {
            return true;
        };
        if (!material.double_sided || material.cull_mode.is_some())
            && let Some(mut material) = materials.get_mut(*id)
        {
            material.double_sided = true;
            material.cull_mode = None;
        }
        false
    });
}
