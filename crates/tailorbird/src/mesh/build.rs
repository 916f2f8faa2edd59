//! Builds the mesh of a cloth.

use bevy_asset::{AssetId, Assets, Handle, RenderAssetUsages};
use bevy_camera::visibility::NoAutoAabb;
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_mesh::{Indices, Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use tailorbird_cloth::{
    cloth::{Cloth, ClothShape},
    normals::ClothShading,
    topology::{ClothTopology, Topology},
};

use super::{from_mesh::ClothMeshSource, tangents::Tangents};

/// How the vertices of a cloth's mesh follow from its particles. Written by this plugin alone.
#[derive(Component)]
pub struct ClothMesh {
    pub(super) handle: Handle<Mesh>,
    /// Of the topology it was built from.
    pub(super) revision: u64,
    pub(super) shading: ClothShading,
    /// For each vertex its particle.
    pub(super) particle_of_vertex: Vec<u32>,
    /// For each vertex its normal: of a particle when smooth, of a triangle when flat.
    pub(super) normal_of_vertex: Vec<u32>,
    /// Absent where the mesh has no UVs.
    pub(super) tangents: Option<Tangents>,
    /// What was written last: steps, part of the step, scale.
    pub(super) written: Option<(u64, f32, Vec3)>,
}

impl ClothMesh {
    /// For each vertex of the mesh the particle that moves it.
    pub fn particle_of_vertex(&self) -> &[u32] {
        &self.particle_of_vertex
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
        Option<&ClothMeshSource>,
        Option<&ClothMesh>,
        Option<&Mesh3d>,
    )>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, cloth, topology, shading, source, built, mesh_3d) in &cloths {
        let current = built.is_some_and(|built| {
            built.revision == topology.revision
                && built.shading == *shading
                && mesh_3d.is_some_and(|mesh| mesh.0 == built.handle)
        });
        if current || topology.revision == 0 {
            continue;
        }
        let vertices = source
            .and_then(|source| meshes.get(&source.0))
            .map_or_else(|| Vertices::of_shape(&cloth.shape), Vertices::of_mesh);
        let vertices = match shading {
            ClothShading::Smooth => vertices.smooth(topology),
            ClothShading::Flat => vertices.flat(topology),
        };
        let (mesh, mut cloth_mesh) = vertices.into_mesh(topology, *shading);
        // The same asset where there is one, so that whoever holds its handle keeps it.
        cloth_mesh.handle = match built.map(|built| built.handle.clone()) {
            Some(handle) if meshes.insert(&handle, mesh.clone()).is_ok() => handle,
            _ => meshes.add(mesh),
        };
        commands
            .entity(entity)
            .insert((Mesh3d(cloth_mesh.handle.clone()), cloth_mesh, NoAutoAabb));
    }
}

/// Makes the materials of cloths two-sided.
pub(super) fn make_materials_two_sided(
    cloths: Query<
        &MeshMaterial3d<StandardMaterial>,
        (With<Cloth>, Changed<MeshMaterial3d<StandardMaterial>>),
    >,
    mut waiting: Local<Vec<AssetId<StandardMaterial>>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    waiting.extend(cloths.iter().map(|material| material.id()));
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

/// The vertices of a mesh in the making, in the order of the source: that of [`Topology::particle_of_vertex()`].
struct Vertices {
    indices: Vec<u32>,
    uvs: Option<Vec<Vec2>>,
    /// Further attributes that are carried over from a source mesh.
    source: Option<Mesh>,
    /// For each vertex the vertex of the source.
    source_vertex: Vec<u32>,
    /// For each vertex its normal.
    normal_of_vertex: Vec<u32>,
}

impl Vertices {
    fn new(
        vertices: usize,
        indices: Vec<u32>,
        uvs: Option<Vec<Vec2>>,
        source: Option<Mesh>,
    ) -> Self {
        Self {
            indices,
            uvs,
            source,
            source_vertex: (0..vertices as u32).collect(),
            normal_of_vertex: Vec::new(),
        }
    }

    fn of_shape(shape: &ClothShape) -> Self {
        match shape {
            ClothShape::Grid { resolution, .. } => {
                let uvs: Vec<Vec2> = (0..resolution.y)
                    .flat_map(|row| (0..resolution.x).map(move |column| UVec2::new(column, row)))
                    .map(|at| at.as_vec2() / (resolution - 1).as_vec2())
                    .collect();
                Self::new(uvs.len(), Vec::new(), Some(uvs), None)
            }
            ClothShape::Mesh {
                positions, indices, ..
            } => Self::new(positions.len(), indices.clone(), None, None),
            _ => Self::new(0, Vec::new(), None, None),
        }
    }

    fn of_mesh(mesh: &Mesh) -> Self {
        let uvs = match mesh.attribute(Mesh::ATTRIBUTE_UV_0) {
            Some(VertexAttributeValues::Float32x2(uvs)) => {
                Some(uvs.iter().map(|uv| Vec2::from(*uv)).collect())
            }
            _ => None,
        };
        let indices = mesh.indices().map_or_else(
            || (0..mesh.count_vertices() as u32).collect(),
            |indices| indices.iter().map(|i| i as u32).collect(),
        );
        Self::new(mesh.count_vertices(), indices, uvs, Some(mesh.clone()))
    }

    /// A normal for each particle.
    fn smooth(mut self, topology: &Topology) -> Self {
        self.fill_grid_indices(topology);
        self.normal_of_vertex = topology.particles_of_vertices().collect();
        self
    }

    /// A normal for each triangle: no two triangles share a vertex.
    fn flat(mut self, topology: &Topology) -> Self {
        self.fill_grid_indices(topology);
        // Triangles that the topology left out are drawn with the normal of the first.
        let mut normals = vec![0; self.indices.len()];
        for (normal, source) in topology.source_triangles().enumerate() {
            let start = source as usize * 3;
            normals[start..start + 3].fill(normal as u32);
        }
        self.uvs = self
            .uvs
            .map(|uvs| self.indices.iter().map(|&i| uvs[i as usize]).collect());
        self.source_vertex = std::mem::take(&mut self.indices);
        self.indices = (0..self.source_vertex.len() as u32).collect();
        self.source = self.source.map(|mut mesh| {
            mesh.duplicate_vertices();
            mesh
        });
        self.normal_of_vertex = normals;
        self
    }

    /// A grid's triangles are known to its topology alone, where vertices and particles are the same.
    fn fill_grid_indices(&mut self, topology: &Topology) {
        if topology.grid.is_some() {
            self.indices = topology.triangles().iter().flatten().collect();
        }
    }

    fn into_mesh(self, topology: &Topology, shading: ClothShading) -> (Mesh, ClothMesh) {
        let particle_of_vertex: Vec<u32> = self
            .source_vertex
            .iter()
            .map(|&v| topology.particle_of_vertex(v as usize))
            .collect();
        let zeros = vec![[0.0f32; 3]; particle_of_vertex.len()];
        let mut mesh = self.source.unwrap_or_else(|| {
            Mesh::new(
                PrimitiveTopology::TriangleList,
                RenderAssetUsages::default(),
            )
        });
        mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, zeros.clone());
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, zeros);
        let tangents = self.uvs.map(|uvs| {
            mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0f32; 4]; uvs.len()]);
            let tangents = Tangents::new(&self.indices, &particle_of_vertex, &uvs);
            mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
            tangents
        });
        mesh.insert_indices(Indices::U32(self.indices));
        let cloth_mesh = ClothMesh {
            handle: Handle::default(),
            revision: topology.revision,
            shading,
            particle_of_vertex,
            normal_of_vertex: self.normal_of_vertex,
            tangents,
            written: None,
        };
        (mesh, cloth_mesh)
    }
}
