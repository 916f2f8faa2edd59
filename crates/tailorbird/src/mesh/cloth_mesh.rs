//! The meshes of a cloth, and the entities that show them.

use bevy_asset::{Assets, Handle};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Mesh, MeshVertexAttribute, VertexAttributeValues};
use tailorbird_cloth::normals::ClothShading;

use super::{ClothMeshWrite, ClothVertexBinding, follow::Follow, packed::Packed};
use crate::drawn::ClothDrawnHolds;

/// Map from a cloth's particles to the vertices of its meshes. Written by this plugin alone.
#[derive(Component)]
#[require(ClothDrawnHolds)]
pub struct ClothMesh {
    /// Of the topology it was built from.
    pub(super) revision: u64,
    /// Of the meshes that it was built from; 0 where it was not.
    pub(super) made: u64,
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
    /// State that the vertices show: steps and restores, part of the step, scale.
    pub(super) shows: Option<([u64; 2], f32, Vec3)>,
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

    /// The binding of a vertex of the mesh; none if there is no such vertex.
    pub fn binding(&self, vertex: u32) -> Option<ClothVertexBinding> {
        self.follow.bindings.get(vertex)
    }

    /// Binds a vertex to something else: to a point of a triangle, for a mesh that is finer than the cloth, or for what is sewn on it.
    /// Returns whether it did: not where there is no such vertex or particle, or where weights are not finite or their sum is not 1. To be
    /// done again where the mesh is built anew.
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
