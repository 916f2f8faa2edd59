//! Triangle meshes.

use std::sync::Arc;

use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::fingerprint;

use crate::error::ClothErrorKind;

/// A surface of triangles. A clone shares them.
///
/// A closed surface, with all triangles counter-clockwise seen from outside, is solid: particles that get inside are pushed out. Any other
/// is a sheet, which keeps particles on the side where they are.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct TriMesh {
    data: Arc<MeshData>,
}

#[derive(Debug, PartialEq)]
struct MeshData {
    fingerprint: u64,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Triangles between these positions \[m\].
    ///
    /// # Errors
    /// [`ClothErrorKind::ColliderPoint`], [`ClothErrorKind::ColliderIndex`], [`ClothErrorKind::NoColliderTriangles`].
    pub fn new(
        positions: impl Into<Vec<Vec3>>,
        triangles: impl Into<Vec<[u32; 3]>>,
    ) -> Result<Self, ClothErrorKind> {
        let (positions, mut triangles) = (positions.into(), triangles.into());
        if let Some((index, value)) = positions.iter().enumerate().find(|(_, p)| !p.is_finite()) {
            return Err(ClothErrorKind::ColliderPoint {
                shape: "triangle mesh".into(),
                index,
                value: *value,
            });
        }
        let len = positions.len();
        let all = triangles.iter().flatten().enumerate();
        if let Some((at, value)) = all.into_iter().find(|(_, k)| **k as usize >= len) {
            return Err(ClothErrorKind::ColliderIndex {
                at,
                value: *value,
                vertices: len,
            });
        }
        let given = triangles.len();
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|k| positions[k as usize]);
            (b - a).cross(c - a).length_squared() > 0.0
        });
        if triangles.is_empty() {
            return Err(ClothErrorKind::NoColliderTriangles { triangles: given });
        }
        Ok(Self {
            data: Arc::new(MeshData {
                fingerprint: fingerprint::of_triangles(&positions, &triangles),
                positions,
                triangles,
            }),
        })
    }

    /// Its corners \[m\].
    pub fn positions(&self) -> &[Vec3] {
        &self.data.positions
    }

    /// Its triangles that have an area.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.data.triangles
    }

    /// Equal for equal ones.
    pub(super) fn fingerprint(&self) -> u64 {
        self.data.fingerprint
    }
}
