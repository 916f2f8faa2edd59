//! The vertices of a mesh as the renderer has them: all attributes of a vertex side by side.

use bevy_mesh::{Mesh, MeshVertexAttribute, VertexAttributeValues, VertexFormat};

/// Position of a vertex in the frame before, in the space of its mesh \[m\].
pub const ATTRIBUTE_PREVIOUS_POSITION: MeshVertexAttribute = MeshVertexAttribute::new(
    "Vertex_Cloth_Previous_Position",
    0x7a11_0b1d_c107_0002,
    VertexFormat::Float32x3,
);

/// Numbers of a position and of a normal, and of a tangent.
const VECTOR: usize = 3;
const TANGENT: usize = 4;

/// The vertices of a mesh, of which positions, normals and tangents follow the cloth.
pub(super) struct Packed {
    /// All numbers of all vertices.
    pub words: Vec<f32>,
    /// Numbers of a vertex.
    pub stride: usize,
    /// Starts of the position, the normal and the tangent, if there is one, in a vertex.
    pub position: usize,
    pub normal: usize,
    pub tangent: Option<usize>,
    /// The positions of the frame before, where the mesh has a place for them.
    previous: Option<Previous>,
    /// True if these are all attributes, in the order of the renderer.
    pub complete: bool,
    /// Rises when the other attributes change.
    pub version: u32,
    attributes: Vec<MeshVertexAttribute>,
}

/// Positions at which vertices were drawn.
struct Previous {
    /// Start of that position in a vertex.
    place: usize,
    /// None where they were not drawn in the frame before.
    positions: Vec<f32>,
    /// True if any was elsewhere.
    moved: bool,
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
                ATTRIBUTE_PREVIOUS_POSITION,
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
        let previous = place_of(ATTRIBUTE_PREVIOUS_POSITION, VECTOR).map(|place| Previous {
            place,
            positions: Vec::new(),
            moved: false,
        });
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
            previous,
            complete,
            version,
            attributes: attributes(mesh).map(|(attribute, _)| *attribute).collect(),
        })
    }

    /// Returns whether a mesh still has these attributes, and as many vertices.
    pub fn is_of(&self, mesh: &Mesh) -> bool {
        let same = attributes(mesh).map(|(attribute, values)| (attribute.id, values.len()));
        let count = self.words.len() / self.stride;
        same.eq(self.attributes.iter().map(|own| (own.id, count)))
    }

    /// Notes where vertices are drawn now, and writes where they were drawn before.
    pub fn keep_positions(&mut self) {
        let Some(Previous {
            place,
            positions,
            moved,
        }) = &mut self.previous
        else {
            return;
        };
        let vertices = self.words.chunks_exact_mut(self.stride);
        if positions.is_empty() {
            positions.resize(VECTOR * vertices.len(), f32::NAN);
        }
        *moved = false;
        for (vertex, before) in vertices.zip(positions.as_chunks_mut::<VECTOR>().0) {
            let now = [0, 1, 2].map(|axis| vertex[self.position + axis]);
            let was = if before[0].is_nan() { now } else { *before };
            *moved |= was != now;
            vertex[*place..*place + VECTOR].copy_from_slice(&was);
            *before = now;
        }
    }

    /// Returns whether vertices were elsewhere in the frame before, which is to be taken back when they stay.
    pub fn moved(&self) -> bool {
        self.previous
            .as_ref()
            .is_some_and(|previous| previous.moved)
    }

    /// Forgets where vertices were drawn: they are not, in this frame.
    pub fn forget_positions(&mut self) {
        if let Some(previous) = &mut self.previous {
            previous.positions.clear();
        }
    }

    /// Writes what follows the cloth into a mesh.
    pub fn write_to(&self, mesh: &mut Mesh) {
        let vertices = || self.words.chunks_exact(self.stride);
        let previous = self.previous.as_ref().map(|previous| previous.place);
        for (attribute, place) in [
            (Mesh::ATTRIBUTE_POSITION, Some(self.position)),
            (Mesh::ATTRIBUTE_NORMAL, Some(self.normal)),
            (ATTRIBUTE_PREVIOUS_POSITION, previous),
        ] {
            let Some(place) = place else {
                continue;
            };
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
