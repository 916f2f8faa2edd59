//! Convex hulls of points.

use std::sync::Arc;

use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use parry3d::transformation::try_convex_hull;
use tailorbird_solver::fingerprint;

use crate::error::ClothErrorKind;

/// The convex hull of points. A clone shares them.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct ConvexHull {
    data: Arc<HullData>,
}

#[derive(Debug, PartialEq)]
struct HullData {
    fingerprint: u64,
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl ConvexHull {
    /// The hull of these points \[m\].
    ///
    /// # Errors
    /// [`ClothErrorKind::ColliderPoint`], [`ClothErrorKind::FlatHull`].
    pub fn new(points: &[Vec3]) -> Result<Self, ClothErrorKind> {
        if let Some((index, value)) = points.iter().enumerate().find(|(_, p)| !p.is_finite()) {
            return Err(ClothErrorKind::ColliderPoint {
                shape: "convex hull".into(),
                index,
                value: *value,
            });
        }
        let flat = ClothErrorKind::FlatHull {
            points: points.len(),
        };
        if points.len() < 4 {
            return Err(flat);
        }
        let Ok((points, triangles)) = try_convex_hull(points) else {
            return Err(flat);
        };
        let hull = Self {
            data: Arc::new(HullData {
                fingerprint: fingerprint::of_triangles(&points, &triangles),
                points,
                triangles,
            }),
        };
        if hull.volume() > 0.0 {
            Ok(hull)
        } else {
            Err(flat)
        }
    }

    /// The corners of the hull \[m\].
    pub fn points(&self) -> &[Vec3] {
        &self.data.points
    }

    /// Its triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.data.triangles
    }

    /// Its volume \[m³\].
    pub fn volume(&self) -> f32 {
        let points = self.points();
        let center = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
        let six = self.triangles().iter().map(|corners| {
            let [a, b, c] = corners.map(|k| points[k as usize] - center);
            a.dot(b.cross(c))
        });
        six.sum::<f32>() / 6.0
    }

    /// Equal for equal ones.
    pub(super) fn fingerprint(&self) -> u64 {
        self.data.fingerprint
    }
}
