//! Finds the meshes that become one cloth.

use bevy_asset::{AssetServer, Assets, Handle, LoadState, UntypedAssetId};
use bevy_ecs::{prelude::*, system::SystemParam};
use bevy_math::{Affine3A, Vec3};
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology};
use bevy_scene::ScenePatchInstance;
use bevy_transform::prelude::Transform;
use bevy_world_serialization::WorldAssetRoot;
use tailorbird_cloth::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothShapeError},
};

use super::{
    ClothFromMesh, ClothMeshOf, ClothMeshParts,
    changes::SceneComplete,
    plain::{self, unusable},
};

/// A mesh that becomes a part of a cloth.
#[derive(Clone, Debug)]
pub(super) struct MeshSource {
    pub entity: Entity,
    pub mesh: Handle<Mesh>,
    /// From the space of the entity with the mesh to that of the cloth; `None` where they are one.
    pub to_cloth: Option<Affine3A>,
}

impl MeshSource {
    /// Returns whether this is the same mesh of the same entity.
    pub fn is_same(&self, other: &Self) -> bool {
        self.entity == other.entity && self.mesh == other.mesh
    }
}

/// Result of the search.
pub(super) enum Found {
    /// Something is still loading, or is not there yet.
    Nothing,
    Meshes(Vec<MeshSource>),
}

/// Parameters of a search for meshes.
#[derive(SystemParam)]
pub(super) struct Finder<'w, 's> {
    nodes: Query<
        'w,
        's,
        (
            Option<&'static Transform>,
            Option<&'static Name>,
            Option<&'static Mesh3d>,
            Option<&'static ClothMeshOf>,
            Option<&'static WorldAssetRoot>,
            Option<&'static ScenePatchInstance>,
            Has<SceneComplete>,
            Has<ClothFromMesh>,
            Has<Cloth>,
        ),
    >,
    children: Query<'w, 's, &'static Children>,
    meshes: Res<'w, Assets<Mesh>>,
    server: Option<Res<'w, AssetServer>>,
}

impl Finder<'_, '_> {
    /// The meshes of an entity: its own or, where it has none, those below it.
    ///
    /// # Errors
    /// When an asset did not load, or there are meshes below but none that is meant.
    pub fn find(&self, entity: Entity, parts: &ClothMeshParts) -> Result<Found, ClothErrorKind> {
        let (mut found, mut other_names, mut waits, mut scenes) =
            (Vec::new(), Vec::new(), false, 0);
        let mut stack = vec![(
            entity,
            Affine3A::IDENTITY,
            matches!(parts, ClothMeshParts::All),
        )];
        while let Some((node, to_cloth, mut meant)) = stack.pop() {
            let Ok((transform, name, mesh, part, scene, patch, complete, from_mesh, cloth)) =
                self.nodes.get(node)
            else {
                continue;
            };
            let mut to_cloth = to_cloth;
            if node != entity {
                if from_mesh || cloth {
                    continue;
                }
                to_cloth *= transform.copied().unwrap_or_default().compute_affine();
            }
            if let (ClothMeshParts::Named(names), Some(name)) = (parts, name) {
                meant |= names.iter().any(|wanted| wanted == name.as_str());
            }
            let children = self.children.get(node).ok();
            if let Some(scene) = scene {
                self.check_loaded(scene.0.id().untyped(), || format!("{:?}", scene.0.path()))?;
                scenes += 1;
                waits |= children.is_none() || self.is_loading(scene.0.id().untyped());
            }
            if let Some(patch) = patch.filter(|_| !complete) {
                self.check_loaded(patch.0.id().untyped(), || format!("{:?}", patch.0.path()))?;
                waits = true;
            }
            if let Some(mesh) = mesh {
                let source = MeshSource {
                    entity: node,
                    mesh: source_of(mesh, part),
                    to_cloth: (node != entity).then_some(to_cloth),
                };
                if node == entity {
                    found = vec![source];
                    waits = patch.is_some() && !complete;
                    break;
                } else if meant {
                    found.push(source);
                } else {
                    other_names.push(name.map_or_else(|| node.to_string(), ToString::to_string));
                }
            }
            let below = children.into_iter().flatten().rev();
            stack.extend(below.map(|child| (*child, to_cloth, meant)));
        }
        for source in &found {
            if !self.meshes.contains(&source.mesh) {
                let id = source.mesh.id().untyped();
                self.check_loaded(id, || format!("{:?}", source.mesh.path()))?;
                waits = true;
            }
        }
        if waits {
            return Ok(Found::Nothing);
        }
        if found.is_empty() && !other_names.is_empty() {
            return Err(unusable(format!(
                "has none of the names of {parts:?}, but {other_names:?}"
            )));
        }
        if found.is_empty() && scenes > 0 {
            return Err(unusable("is on none of the scene's entities"));
        }
        Ok(if found.is_empty() {
            Found::Nothing
        } else {
            Found::Meshes(found)
        })
    }

    /// A mesh that was found.
    pub fn mesh(&self, source: &MeshSource) -> Option<&Mesh> {
        self.meshes.get(&source.mesh)
    }

    fn is_loading(&self, id: UntypedAssetId) -> bool {
        let state = self.server.as_ref().map(|server| server.load_state(id));
        matches!(state, Some(LoadState::Loading))
    }

    fn check_loaded(
        &self,
        id: UntypedAssetId,
        asset: impl FnOnce() -> String,
    ) -> Result<(), ClothErrorKind> {
        match self.server.as_ref().map(|server| server.load_state(id)) {
            Some(LoadState::Failed(reason)) => Err(ClothErrorKind::AssetNotLoaded {
                asset: asset(),
                reason: reason.to_string(),
            }),
            _ => Ok(()),
        }
    }
}

/// The mesh as it was before a cloth was made of it.
fn source_of(mesh: &Mesh3d, part: Option<&ClothMeshOf>) -> Handle<Mesh> {
    match part {
        Some(part) if part.built == mesh.0 => part.source.clone().unwrap_or_default(),
        _ => mesh.0.clone(),
    }
}

/// Appends the triangles of a mesh to those of the cloth.
///
/// # Errors
/// The error in the mesh.
pub(super) fn append(
    mesh: &Mesh,
    to_cloth: Option<Affine3A>,
    positions: &mut Vec<Vec3>,
    indices: &mut Vec<u32>,
) -> Result<(), ClothErrorKind> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err(unusable("is not a triangle list"));
    }
    let places = plain::positions(mesh)?;
    let first = positions.len() as u32;
    let start = indices.len();
    match mesh.try_indices_option().ok().flatten() {
        Some(list) => indices.extend(list.iter().map(|i| i as u32)),
        None => indices.extend(0..places.len() as u32),
    }
    let own = &mut indices[start..];
    if !own.len().is_multiple_of(3) {
        return Err(ClothShapeError::IndexCount { value: own.len() }.into());
    }
    let vertices = places.len();
    for (at, index) in own.iter_mut().enumerate() {
        if *index as usize >= vertices {
            return Err(ClothShapeError::IndexOutOfRange {
                at,
                value: *index,
                vertices,
            }
            .into());
        }
        *index += first;
    }
    let Some(to_cloth) = to_cloth else {
        positions.extend(places.iter().map(|p| Vec3::from(*p)));
        return Ok(());
    };
    let volume = to_cloth.matrix3.determinant();
    if !to_cloth.is_finite() || volume == 0.0 {
        return Err(unusable("is scaled to nothing, or its place is not finite"));
    }
    if volume < 0.0 {
        // In a mirror the front is clockwise.
        for corners in own.as_chunks_mut::<3>().0 {
            corners.swap(1, 2);
        }
    }
    positions.extend(
        places
            .iter()
            .map(|p| to_cloth.transform_point3(Vec3::from(*p))),
    );
    Ok(())
}
