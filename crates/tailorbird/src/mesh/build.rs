//! Builds the meshes of a cloth.

use bevy_asset::{AssetId, Assets, Handle};
use bevy_camera::visibility::NoAutoAabb;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Mesh, Mesh3d, MeshVertexAttribute, VertexAttributeValues};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use tailorbird_cloth::{
    cloth::{Cloth, ClothShape},
    normals::{ClothNormals, ClothShading},
    topology::ClothTopology,
};

use super::{
    ClothMeshWrite, ClothVertexBinding, follow::Follow, from_mesh::ClothMeshSource, packed::Packed,
    parts::MeshSource, vertices::Vertices,
};
use crate::drawn::ClothDrawnHolds;

/// Map from a cloth's particles to the vertices of its meshes. Written by this plugin alone.
#[derive(Component)]
#[require(ClothDrawnHolds)]
pub struct ClothMesh {
    /// Of the topology it was built from.
    pub(super) revision: u64,
    /// Of the meshes that it was built from; 0 where it was not.
    made: u64,
    pub(super) shading: ClothShading,
    pub(crate) parts: Vec<ClothMeshPart>,
}

impl ClothMesh {
    /// The meshes: one, but for a cloth that was made of several.
    pub fn parts(&self) -> &[ClothMeshPart] {
        &self.parts
    }

    /// The same, to bind vertices.
    pub fn parts_mut(&mut self) -> &mut [ClothMeshPart] {
        &mut self.parts
    }
}

/// One mesh of a cloth.
pub struct ClothMeshPart {
    pub(super) entity: Entity,
    pub(crate) handle: Handle<Mesh>,
    pub(super) follow: Follow,
    /// Its vertices; absent before they are known, and where the mesh has no place for them.
    pub(super) packed: Option<Packed>,
    /// State that the vertices show: steps, part of the step, scale.
    pub(super) shows: Option<(u64, f32, Vec3)>,
    /// True if the vertices changed since they were written.
    pub(super) fresh: bool,
    /// True if the asset has been written since the mesh was built.
    pub(super) in_asset: bool,
    /// Destination of the vertices when they were computed last.
    pub(super) went: Option<ClothMeshWrite>,
    /// True if the last change of the asset was ours.
    pub(crate) own_change: bool,
    /// True if others have changed the asset.
    pub(super) outdated: bool,
}

impl ClothMeshPart {
    pub(super) fn new(follow: Follow) -> Self {
        Self {
            entity: Entity::PLACEHOLDER,
            handle: Handle::default(),
            follow,
            packed: None,
            shows: None,
            fresh: false,
            in_asset: false,
            went: None,
            own_change: false,
            outdated: false,
        }
    }

    /// Gives its mesh a place for an attribute, with these values for so many vertices, or takes it away.
    pub(super) fn fit_attribute(
        &mut self,
        meshes: &mut Assets<Mesh>,
        attribute: MeshVertexAttribute,
        wanted: bool,
        values: impl FnOnce(usize) -> VertexAttributeValues,
    ) {
        let differs = |mesh: &Mesh| {
            mesh.try_contains_attribute(attribute)
                .is_ok_and(|has| has != wanted)
        };
        if !meshes.get(&self.handle).is_some_and(differs) {
            return;
        }
        let Some(mut mesh) = meshes.get_mut(&self.handle) else {
            return;
        };
        let changed = if wanted {
            let values = values(mesh.count_vertices());
            mesh.try_insert_attribute(attribute, values).is_ok()
        } else {
            mesh.try_remove_attribute(attribute).is_ok()
        };
        self.own_change |= changed;
    }

    /// The entity that has the mesh: the cloth itself or one below it.
    pub fn entity(&self) -> Entity {
        self.entity
    }

    /// For each vertex of the mesh the particle that moves it; of one on a triangle, the corner that is nearest to it. In storage order.
    pub fn particle_of_vertex(&self) -> &[u32] {
        self.follow.bindings.particles()
    }

    /// Binding of a vertex of the mesh; `None` if there is no such vertex.
    pub fn binding(&self, vertex: u32) -> Option<ClothVertexBinding> {
        self.follow.bindings.get(vertex)
    }

    /// Binds a vertex to something else: to a point of a triangle, for a mesh that is finer than the cloth, or for what is sewn on it.
    /// Returns whether there is such a vertex. To be done again where the mesh is built anew.
    ///
    /// # Panics
    /// When it is drawn, where a particle does not exist.
    pub fn bind(&mut self, vertex: u32, binding: ClothVertexBinding) -> bool {
        self.shows = None;
        self.follow.bind(vertex, binding)
    }
}

/// An entity whose `Mesh3d` shows a cloth, or a part of it. Written by this plugin alone.
#[derive(Component, Clone, Debug)]
pub struct ClothMeshOf {
    pub(super) cloth: Entity,
    /// The mesh that shows the cloth.
    pub(super) built: Handle<Mesh>,
    /// The mesh that was here before.
    pub(super) source: Option<Handle<Mesh>>,
    /// True if its backs are drawn by the triangles of its fronts.
    pub(super) two_sided: bool,
}

impl ClothMeshOf {
    /// The cloth.
    pub fn cloth(&self) -> Entity {
        self.cloth
    }
}

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
