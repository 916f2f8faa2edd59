//! The vertices of a cloth's mesh in the making.

use bevy_asset::{Assets, RenderAssetUsages};
use bevy_math::{UVec2, Vec2};
use bevy_mesh::{Indices, Mesh, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues};
use tailorbird_cloth::{cloth::ClothShape, normals::ClothShading, topology::Topology};

use super::{ClothMeshPart, follow::Follow, parts::MeshSource, plain::plain, tangents::Tangents};

/// The vertices of a mesh in the making, in the order of its source.
pub(super) struct Vertices {
    indices: Vec<u32>,
    uvs: Option<Vec<Vec2>>,
    /// Further attributes that are carried over from a source mesh.
    source: Option<Mesh>,
    /// For each vertex the vertex of the source.
    source_vertex: Vec<u32>,
    /// Index of the source's first vertex and triangle in the cloth's shape.
    first_vertex: usize,
    first_triangle: usize,
    /// For each vertex its normal.
    normal_of_vertex: Vec<u32>,
    backs: Vec<u32>,
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
            first_vertex: 0,
            first_triangle: 0,
            normal_of_vertex: Vec::new(),
            backs: Vec::new(),
        }
    }

    pub fn of_shape(shape: &ClothShape) -> Self {
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

    /// Vertices of the meshes that a shape was made of; `None` if they are not those of the shape (any more).
    pub fn of_meshes<'a>(
        sources: &'a [MeshSource],
        shape: &ClothShape,
        meshes: &Assets<Mesh>,
        left_out: &[MeshVertexAttribute],
    ) -> Option<Vec<(Self, &'a MeshSource)>> {
        let (mut first_vertex, mut first_triangle) = (0, 0);
        let mut all = Vec::with_capacity(sources.len());
        for source in sources {
            let mut vertices = Self::of_mesh(plain(meshes.get(&source.mesh)?, left_out).ok()?);
            (vertices.first_vertex, vertices.first_triangle) = (first_vertex, first_triangle);
            first_vertex += vertices.source_vertex.len();
            first_triangle += vertices.indices.len() / 3;
            all.push((vertices, source));
        }
        let ClothShape::Mesh {
            positions, indices, ..
        } = shape
        else {
            return None;
        };
        (positions.len() == first_vertex && indices.len() == 3 * first_triangle).then_some(all)
    }

    fn of_mesh(mesh: Mesh) -> Self {
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
        Self::new(mesh.count_vertices(), indices, uvs, Some(mesh))
    }

    /// The mesh, and how it follows the particles of `topology`.
    pub fn into_mesh(
        mut self,
        topology: &Topology,
        shading: ClothShading,
    ) -> (Mesh, ClothMeshPart) {
        // A grid's triangles are known to its topology alone, where vertices and particles are the same.
        if topology.is_grid() {
            self.indices = topology.triangles().iter().flatten().collect();
        }
        self.turn(topology);
        let backs = self.back_triangles(topology);
        match shading {
            ClothShading::Smooth => self.smooth(topology, &backs),
            ClothShading::Flat => self.flat(topology, &backs),
        }
        self.finish(topology)
    }

    /// Index among the mesh's own triangles of a triangle of the shape.
    fn own(&self, triangle: u32) -> Option<usize> {
        let own = (triangle as usize).checked_sub(self.first_triangle)?;
        (own < self.indices.len() / 3).then_some(own)
    }

    /// Turns triangles around that the topology has turned around.
    fn turn(&mut self, topology: &Topology) {
        for &triangle in topology.turned_triangles() {
            if let Some(own) = self.own(triangle) {
                self.indices.swap(3 * own + 1, 3 * own + 2);
            }
        }
    }

    /// Triangles that are the backs of others.
    fn back_triangles(&self, topology: &Topology) -> Vec<usize> {
        let backs = topology.copied_triangles().iter().filter(|copy| copy.back);
        backs.filter_map(|copy| self.own(copy.source)).collect()
    }

    /// A normal for each particle. A back shares no vertex with a front.
    fn smooth(&mut self, topology: &Topology, backs: &[usize]) {
        if !backs.is_empty() {
            let mut on_back = vec![false; self.indices.len() / 3];
            backs.iter().for_each(|back| on_back[*back] = true);
            let mut on_front = vec![false; self.source_vertex.len()];
            for (triangle, corners) in self.indices.as_chunks::<3>().0.iter().enumerate() {
                if !on_back[triangle] {
                    corners.iter().for_each(|v| on_front[*v as usize] = true);
                }
            }
            let mut back_of = vec![u32::MAX; on_front.len()];
            for corner in backs.iter().flat_map(|back| 3 * back..3 * back + 3) {
                let vertex = self.indices[corner];
                let back = &mut back_of[vertex as usize];
                if *back == u32::MAX {
                    *back = vertex;
                    if on_front[vertex as usize] {
                        *back = self.source_vertex.len() as u32;
                        self.source_vertex.push(vertex);
                    }
                    self.backs.push(*back);
                }
                self.indices[corner] = *back;
            }
        }
        self.normal_of_vertex = self.particles_of_vertices(topology);
    }

    /// A normal for each triangle: no two triangles share a vertex.
    fn flat(&mut self, topology: &Topology, backs: &[usize]) {
        // Triangles without area are drawn with the normal of the first.
        let mut normals = vec![0; self.indices.len()];
        let mut set = |source: u32, normal: u32| {
            if let Some(own) = self.own(source) {
                normals[3 * own..3 * own + 3].fill(normal);
            }
        };
        for (normal, source) in topology.source_triangles().enumerate() {
            set(source, normal as u32);
        }
        for copy in topology.copied_triangles() {
            set(copy.source, copy.triangle);
        }
        self.normal_of_vertex = normals;
        self.source_vertex = std::mem::take(&mut self.indices);
        self.indices = (0..self.source_vertex.len() as u32).collect();
        let corners = backs.iter().flat_map(|back| 3 * back..3 * back + 3);
        self.backs = corners.map(|corner| corner as u32).collect();
    }

    fn particles_of_vertices(&self, topology: &Topology) -> Vec<u32> {
        let particle = |v: &u32| {
            topology
                .particle_of_vertex(self.first_vertex + *v as usize)
                .0
        };
        self.source_vertex.iter().map(particle).collect()
    }

    fn finish(self, topology: &Topology) -> (Mesh, ClothMeshPart) {
        let particle_of_vertex = self.particles_of_vertices(topology);
        let as_in_source = self.source.as_ref().is_some_and(|mesh| {
            let all = 0..mesh.count_vertices() as u32;
            all.eq(self.source_vertex.iter().copied())
        });
        let mut mesh = self.source.map_or_else(
            || {
                Mesh::new(
                    PrimitiveTopology::TriangleList,
                    RenderAssetUsages::default(),
                )
            },
            |mut mesh| {
                if !as_in_source {
                    mesh.insert_indices(Indices::U32(self.source_vertex.clone()));
                    mesh.duplicate_vertices();
                }
                mesh
            },
        );
        let zeros = vec![[0.0f32; 3]; particle_of_vertex.len()];
        mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, zeros.clone());
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, zeros);
        // Tangents that nothing moves would stay as they were at rest.
        mesh.remove_attribute(Mesh::ATTRIBUTE_TANGENT);
        let tangents = self.uvs.map(|uvs| {
            let uvs: Vec<Vec2> = self
                .source_vertex
                .iter()
                .map(|v| uvs[*v as usize])
                .collect();
            mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0f32; 4]; uvs.len()]);
            let tangents = Tangents::new(&self.indices, &particle_of_vertex, &uvs);
            mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
            tangents
        });
        mesh.insert_indices(Indices::U32(self.indices));
        let follow = Follow::new(
            particle_of_vertex,
            self.normal_of_vertex,
            self.backs,
            tangents,
            (
                topology.particles(),
                topology.grid().map(|grid| grid.x as usize),
            ),
        );
        (mesh, ClothMeshPart::new(follow))
    }
}
