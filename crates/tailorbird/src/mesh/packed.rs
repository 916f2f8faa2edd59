//! The vertices of a mesh as the renderer has them: all attributes of a vertex side by side.

use bevy_mesh::{Mesh, MeshVertexAttribute, VertexAttributeValues};

/// Numbers of a position and of a normal, and of a tangent.
const VECTOR: usize = 3;
const TANGENT: usize = 4;

/// The vertices of a mesh, of which positions, normals and tangents follow the cloth.
pub(super) struct Packed {
    /// All numbers of all vertices.
    pub words: Vec<f32>,
    /// Numbers of a vertex.
    pub stride: usize,
    /// Where the position, the normal and the tangent, if there is one, start in a vertex.
    pub position: usize,
    pub normal: usize,
    pub tangent: Option<usize>,
    /// Whether these are all attributes, in the order that the renderer has them in.
    pub complete: bool,
    /// Rises when the other attributes change.
    pub version: u32,
    attributes: Vec<MeshVertexAttribute>,
}

fn attributes(mesh: &Mesh) -> impl Iterator<Item = (&MeshVertexAttribute, &VertexAttributeValues)> {
    mesh.try_attributes().into_iter().flatten()
}

impl Packed {
    /// The vertices of a mesh; none where it has no positions or normals.
    pub fn of(mesh: &Mesh, version: u32) -> Option<Self> {
        let words = |attribute: &MeshVertexAttribute| attribute.format.size() as usize / 4;
        let whole = |attribute: &MeshVertexAttribute| attribute.format.size().is_multiple_of(4);
        let complete = attributes(mesh).all(|(attribute, _)| whole(attribute));
        let follows = |attribute: &MeshVertexAttribute| {
            let known = [
                Mesh::ATTRIBUTE_POSITION,
                Mesh::ATTRIBUTE_NORMAL,
                Mesh::ATTRIBUTE_TANGENT,
            ];
            known.iter().any(|own| own.id == attribute.id)
        };
        let mut stride = 0;
        let mut places = Vec::new();
        for (attribute, values) in attributes(mesh) {
            if complete || follows(attribute) {
                places.push((attribute, values, stride));
                stride += words(attribute);
            }
        }
        let place_of = |wanted: MeshVertexAttribute, count: usize| {
            let mut all = places.iter();
            all.find(|(attribute, ..)| attribute.id == wanted.id && words(attribute) == count)
                .map(|&(.., place)| place)
        };
        let position = place_of(Mesh::ATTRIBUTE_POSITION, VECTOR)?;
        let normal = place_of(Mesh::ATTRIBUTE_NORMAL, VECTOR)?;
        let tangent = place_of(Mesh::ATTRIBUTE_TANGENT, TANGENT);
        let mut all = vec![0.0; stride * mesh.count_vertices()];
        for (attribute, values, place) in &places {
            let own = values.get_bytes().chunks_exact(4 * words(attribute));
            for (vertex, bytes) in all.chunks_exact_mut(stride).zip(own) {
                for (word, bytes) in vertex[*place..].iter_mut().zip(bytes.as_chunks::<4>().0) {
                    *word = f32::from_ne_bytes(*bytes);
                }
            }
        }
        Some(Self {
            words: all,
            stride,
            position,
            normal,
            tangent,
            complete,
            version,
            attributes: attributes(mesh).map(|(attribute, _)| *attribute).collect(),
        })
    }

    /// Whether a mesh still has these attributes, and as many vertices.
    pub fn is_of(&self, mesh: &Mesh) -> bool {
        let same = attributes(mesh).map(|(attribute, values)| (attribute.id, values.len()));
        let count = self.words.len() / self.stride;
        same.eq(self.attributes.iter().map(|own| (own.id, count)))
    }

    /// Writes positions, normals and tangents into a mesh.
    pub fn write_to(&self, mesh: &mut Mesh) {
        let vertices = || self.words.chunks_exact(self.stride);
        for (attribute, place) in [
            (Mesh::ATTRIBUTE_POSITION, self.position),
            (Mesh::ATTRIBUTE_NORMAL, self.normal),
        ] {
            if let Ok(Some(VertexAttributeValues::Float32x3(values))) =
                mesh.try_attribute_mut_option(attribute)
            {
                for (value, vertex) in values.iter_mut().zip(vertices()) {
                    value.copy_from_slice(&vertex[place..place + VECTOR]);
                }
            }
        }
        if let Some(place) = self.tangent
            && let Ok(Some(VertexAttributeValues::Float32x4(values))) =
                mesh.try_attribute_mut_option(Mesh::ATTRIBUTE_TANGENT)
        {
            for (value, vertex) in values.iter_mut().zip(vertices()) {
                value.copy_from_slice(&vertex[place..place + TANGENT]);
            }
        }
    }
}
