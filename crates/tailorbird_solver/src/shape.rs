//! The rest shape of a cloth.

use bevy_math::{UVec2, Vec2, Vec3};
use bevy_reflect::prelude::*;

use crate::{error::ClothShapeError, fingerprint, topology::repair::Repaired};

/// The rest shape of a cloth.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
#[non_exhaustive]
pub enum ClothShape {
    /// A rectangle in the x-y plane that faces +z. Columns run along +x, rows along −y: row 0 is the top.
    Grid {
        /// Width and height \[m\].
        size: Vec2,
        /// Columns and rows of particles, at least 2 × 2.
        resolution: UVec2,
        /// Point of the rectangle that lies at the entity's origin, as fractions of the width from the left and of the height from the top.
        /// (0, 0), the default, is the top left corner: particle (0, 0).
        #[cfg_attr(feature = "serialize", serde(default))]
        origin: Vec2,
    },
    /// Triangles.
    Mesh {
        /// Vertices \[m\].
        positions: Vec<Vec3>,
        /// Three for each triangle, counter-clockwise seen from the front.
        indices: Vec<u32>,
        /// Texture coordinates of the vertices, or none. The warp runs where u is constant, as in the pattern of a garment; without, and in
        /// triangles where they are not finite, along the edges.
        #[cfg_attr(feature = "serialize", serde(default))]
        uvs: Vec<Vec2>,
        /// Distance \[m\] up to which vertices become one particle, so that seams of UVs or normals hold together.
        #[cfg_attr(feature = "serialize", serde(default = "weld_distance"))]
        weld_distance: f32,
    },
}

/// Default for a file without the field.
#[cfg(feature = "serialize")]
fn weld_distance() -> f32 {
    ClothShape::WELD_DISTANCE
}

impl ClothShape {
    /// Distance \[m\] at which the vertices of a mesh are welded, unless another is set.
    pub const WELD_DISTANCE: f32 = 1e-5;

    /// A rectangle of `size` \[m\] with `resolution` columns and rows of particles, whose top left corner is at the origin.
    pub fn grid(size: Vec2, resolution: UVec2) -> Self {
        Self::Grid {
            size,
            resolution,
            origin: Vec2::ZERO,
        }
    }

    /// Triangles, by their vertices \[m\] and three indices for each triangle.
    pub fn mesh(positions: impl Into<Vec<Vec3>>, indices: impl Into<Vec<u32>>) -> Self {
        Self::Mesh {
            positions: positions.into(),
            indices: indices.into(),
            uvs: Vec::new(),
            weld_distance: Self::WELD_DISTANCE,
        }
    }

    /// Checks the shape without building it.
    ///
    /// # Errors
    /// The first error that is found.
    pub fn check(&self) -> Result<(), ClothShapeError> {
        /// Largest number of particles of a grid: f32 counts up to it exactly.
        const MOST_PARTICLES: u64 = 1 << 24;
        match self {
            Self::Grid {
                size,
                resolution,
                origin,
            } => {
                if !size.is_finite() || size.min_element() <= 0.0 {
                    return Err(ClothShapeError::Size { value: *size });
                }
                let particles = u64::from(resolution.x) * u64::from(resolution.y);
                if resolution.cmplt(UVec2::splat(2)).any() || particles > MOST_PARTICLES {
                    return Err(ClothShapeError::Resolution { value: *resolution });
                }
                if !origin.is_finite() {
                    return Err(ClothShapeError::Origin { value: *origin });
                }
                Ok(())
            }
            Self::Mesh {
                positions,
                indices,
                uvs,
                weld_distance,
            } => {
                if !uvs.is_empty() && uvs.len() != positions.len() {
                    return Err(ClothShapeError::UvCount {
                        value: uvs.len(),
                        vertices: positions.len(),
                    });
                }
                if !(*weld_distance >= 0.0 && weld_distance.is_finite()) {
                    return Err(ClothShapeError::WeldDistance {
                        value: *weld_distance,
                    });
                }
                check_positions(positions.iter().copied())?;
                if indices.len() % 3 != 0 {
                    return Err(ClothShapeError::IndexCount {
                        value: indices.len(),
                    });
                }
                let vertices = positions.len();
                if let Some((at, value)) = indices
                    .iter()
                    .enumerate()
                    .find(|(_, i)| **i as usize >= vertices)
                {
                    return Err(ClothShapeError::IndexOutOfRange {
                        at,
                        value: *value,
                        vertices,
                    });
                }
                if indices.is_empty() {
                    return Err(ClothShapeError::NoTriangles {
                        vertices,
                        triangles: 0,
                    });
                }
                Ok(())
            }
        }
    }

    /// Positions of the particles at rest \[m\], in their original order; none where the shape is wrong.
    pub fn rest_positions(&self) -> Vec<Vec3> {
        if self.check().is_err() {
            return Vec::new();
        }
        match self {
            Self::Grid {
                size,
                resolution,
                origin,
            } => {
                let last = (resolution - 1).as_vec2();
                let mut positions = Vec::with_capacity((resolution.x * resolution.y) as usize);
                positions.extend(
                    (0..resolution.y)
                        .flat_map(|row| {
                            (0..resolution.x).map(move |column| UVec2::new(column, row))
                        })
                        .map(|at| (at.as_vec2() / last - *origin) * *size)
                        .map(|p| Vec3::new(p.x, -p.y, 0.0)),
                );
                positions
            }
            Self::Mesh {
                positions,
                indices,
                weld_distance,
                ..
            } => Repaired::new(positions, indices, *weld_distance, Vec3::ONE).positions,
        }
    }

    /// Width and height at rest \[m\] of a grid.
    pub fn size(&self) -> Option<Vec2> {
        match *self {
            Self::Grid { size, .. } => Some(size),
            Self::Mesh { .. } => None,
        }
    }

    /// Columns and rows of a grid.
    pub fn resolution(&self) -> Option<UVec2> {
        match *self {
            Self::Grid { resolution, .. } => Some(resolution),
            Self::Mesh { .. } => None,
        }
    }

    /// Fingerprint of a shape and its scale, never 0: shapes that differ do not share one in practice, so that none has to be kept to compare
    /// with.
    pub fn fingerprint(&self, scale: Vec3) -> u64 {
        let scale = scale.to_array().map(f32::to_bits);
        let print = match self {
            Self::Grid {
                size,
                resolution,
                origin,
            } => {
                let measures = [*size, *origin].map(|v| v.to_array().map(f32::to_bits));
                let kind = [0].into_iter().chain(scale).chain(resolution.to_array());
                fingerprint::of(kind.chain(measures.into_iter().flatten()))
            }
            Self::Mesh {
                positions,
                indices,
                uvs,
                weld_distance,
            } => {
                let counts = [1, positions.len() as u32, indices.len() as u32];
                let kind = counts.into_iter().chain(scale);
                let coordinates = positions.iter().flat_map(Vec3::to_array);
                let numbers = coordinates.chain(uvs.iter().flat_map(Vec2::to_array));
                let numbers = numbers.chain([*weld_distance]).map(f32::to_bits);
                fingerprint::of(kind.chain(numbers).chain(indices.iter().copied()))
            }
        };
        print.max(1)
    }
}

/// Checks the vertices of a mesh.
pub(crate) fn check_positions(
    positions: impl Iterator<Item = Vec3>,
) -> Result<(), ClothShapeError> {
    /// Largest coordinate \[m\]: f32 counts in steps of 6 cm there.
    const FARTHEST: f32 = 1e6;
    for (vertex, value) in positions.enumerate() {
        if !value.is_finite() {
            return Err(ClothShapeError::NonFinitePosition { vertex, value });
        }
        if value.abs().max_element() > FARTHEST {
            return Err(ClothShapeError::PositionTooFar { vertex, value });
        }
    }
    Ok(())
}
