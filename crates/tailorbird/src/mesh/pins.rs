//! Pins that are named by the mesh.

use std::{fmt, sync::Arc};

use bevy_math::Vec3;
use bevy_mesh::{Mesh, MeshVertexAttribute, VertexFormat};
use bevy_reflect::prelude::*;
use tailorbird_cloth::error::ClothErrorKind;

use super::plain;

/// Weight of each vertex: 0 is free, 1 is pinned. The attribute for `_CLOTH_PIN` of a glTF file; see the [guide](super::garments).
pub const ATTRIBUTE_CLOTH_PIN: MeshVertexAttribute = MeshVertexAttribute::new(
    "Vertex_Cloth_Pin",
    0x7a11_0b1d_c107_0001,
    VertexFormat::Float32,
);

/// Vertices of a mesh that are pinned when it becomes a cloth.
///
/// A particle is pinned if any of its vertices is: both sides of a seam agree.
#[derive(Clone, Default, Reflect)]
#[reflect(opaque)]
#[non_exhaustive]
pub enum ClothMeshPins {
    /// None.
    #[default]
    None,
    /// Vertices whose colour is above a threshold.
    Color {
        /// Channel of the colour.
        channel: ClothColorChannel,
        /// The threshold [-].
        threshold: f32,
    },
    /// Vertices whose attribute is above a threshold. The first number of a vector counts.
    Attribute {
        /// The attribute, of one to four `f32`.
        attribute: MeshVertexAttribute,
        /// The threshold [-].
        threshold: f32,
    },
    /// Vertices for whose positions, in the space of the cloth's entity \[m\], this is true.
    Where(Arc<dyn Fn(Vec3) -> bool + Send + Sync>),
    /// Vertices with these indices. The vertices of several meshes are counted through, in the order of the hierarchy.
    Vertices(Vec<u32>),
}

/// A channel of a vertex colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
pub enum ClothColorChannel {
    /// The first.
    #[default]
    Red,
    /// The second.
    Green,
    /// The third.
    Blue,
    /// The fourth; opaque materials do not show it.
    Alpha,
}

impl ClothMeshPins {
    /// The threshold of pins that are painted, unless another is given.
    pub const THRESHOLD: f32 = 0.5;

    /// Pins the vertices whose colour is above [`Self::THRESHOLD`] in a channel.
    pub fn color(channel: ClothColorChannel) -> Self {
        Self::Color {
            channel,
            threshold: Self::THRESHOLD,
        }
    }

    /// Pins the vertices whose [`ATTRIBUTE_CLOTH_PIN`] is above [`Self::THRESHOLD`].
    pub fn attribute() -> Self {
        Self::Attribute {
            attribute: ATTRIBUTE_CLOTH_PIN,
            threshold: Self::THRESHOLD,
        }
    }

    /// Pins the vertices for whose positions, in the space of the cloth's entity \[m\], `held` is true.
    pub fn matching(held: impl Fn(Vec3) -> bool + Send + Sync + 'static) -> Self {
        Self::Where(Arc::new(held))
    }

    /// Pins the vertices with these indices.
    pub fn vertices(vertices: impl IntoIterator<Item = u32>) -> Self {
        Self::Vertices(vertices.into_iter().collect())
    }

    /// Returns whether the weights are painted on the mesh.
    pub(super) fn are_painted(&self) -> bool {
        matches!(self, Self::Color { .. } | Self::Attribute { .. })
    }

    /// The attribute that would be drawn though its numbers mean pins and weights, not colours.
    pub(super) fn paint(&self) -> Option<MeshVertexAttribute> {
        match self {
            Self::Color { .. } => Some(Mesh::ATTRIBUTE_COLOR),
            Self::Attribute { attribute, .. } if attribute.id == Mesh::ATTRIBUTE_COLOR.id => {
                Some(Mesh::ATTRIBUTE_COLOR)
            }
            _ => None,
        }
    }

    /// The weight above which a vertex is pinned.
    ///
    /// # Errors
    /// When it is not finite.
    pub(super) fn threshold(&self) -> Result<f32, ClothErrorKind> {
        match *self {
            Self::Color { threshold, .. } | Self::Attribute { threshold, .. } => {
                if threshold.is_finite() {
                    Ok(threshold)
                } else {
                    Err(ClothErrorKind::Value {
                        field: "ClothFromMesh.pins.threshold".into(),
                        value: threshold,
                        allowed: "finite [-]".into(),
                    })
                }
            }
            _ => Ok(Self::THRESHOLD),
        }
    }

    /// The weight of each vertex of meshes that lie one after the other; `positions` are those of all vertices in the cloth's space \[m\].
    ///
    /// # Errors
    /// An error if no mesh has the data that names the pins, or a vertex is not there.
    pub(super) fn weights(
        &self,
        meshes: &[&Mesh],
        positions: &[Vec3],
    ) -> Result<Vec<f32>, ClothErrorKind> {
        match self {
            Self::None => Ok(vec![0.0; positions.len()]),
            Self::Color { channel, .. } => read(
                meshes,
                Mesh::ATTRIBUTE_COLOR,
                *channel as usize,
                positions.len(),
            ),
            Self::Attribute { attribute, .. } => read(meshes, *attribute, 0, positions.len()),
            Self::Where(held) => Ok(positions.iter().map(|p| f32::from(held(*p))).collect()),
            Self::Vertices(vertices) => {
                let mut weights = vec![0.0; positions.len()];
                for (k, &vertex) in vertices.iter().enumerate() {
                    let Some(weight) = weights.get_mut(vertex as usize) else {
                        return Err(ClothErrorKind::Value {
                            field: format!("ClothFromMesh.pins, vertex {k} of the list,"),
                            value: vertex as f32,
                            allowed: format!("below the number of vertices, {}", positions.len()),
                        });
                    };
                    *weight = 1.0;
                }
                Ok(weights)
            }
        }
    }
}

impl fmt::Debug for ClothMeshPins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Color { channel, threshold } => write!(f, "Color({channel:?} > {threshold})"),
            Self::Attribute {
                attribute,
                threshold,
            } => write!(f, "Attribute({} > {threshold})", attribute.name),
            Self::Where(_) => f.write_str("Where(..)"),
            Self::Vertices(vertices) => f.debug_tuple("Vertices").field(vertices).finish(),
        }
    }
}

/// One number of an attribute for each vertex of all meshes; 0 in a mesh that does not have it.
fn read(
    meshes: &[&Mesh],
    attribute: MeshVertexAttribute,
    channel: usize,
    vertices: usize,
) -> Result<Vec<f32>, ClothErrorKind> {
    let mut weights = Vec::with_capacity(vertices);
    let mut found = false;
    for mesh in meshes {
        let first = weights.len();
        let values = mesh.try_attribute_option(attribute).ok().flatten();
        weights.extend(
            values
                .and_then(|values| plain::channel(values, channel))
                .unwrap_or_default(),
        );
        found |= weights.len() > first;
        weights.resize(first + mesh.count_vertices(), 0.0);
    }
    if found {
        Ok(weights)
    } else {
        Err(ClothErrorKind::MissingAttribute {
            attribute: attribute.name.into(),
        })
    }
}
