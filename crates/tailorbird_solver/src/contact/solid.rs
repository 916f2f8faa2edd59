//! Shapes at the scale of their entities, as the kernels take them.

use std::{collections::BTreeMap, fmt, sync::Arc};

use bevy_math::{Isometry3d, Mat3, UVec2, Vec2, Vec3, Vec4};

use super::surface::Surface;
use crate::{fingerprint, kernels::planes::PlaneList};

/// A shape at the scale of its entity.
#[derive(Clone)]
pub enum Solid {
    Sphere { radius: f32 },
    HalfSpace,
    Capsule { radii: [f32; 2], half_length: f32 },
    Cuboid { half_size: Vec3 },
    Cylinder { radius: f32, half_height: f32 },
    Hull(Arc<Hull>),
    Mesh(Arc<Surface>),
    Terrain { field: Field, scale: Vec3 },
}

impl fmt::Debug for Solid {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:?}", self.kind())
    }
}

/// Kind of a solid: one kind is solved after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidKind {
    Sphere,
    HalfSpace,
    Capsule,
    Cuboid,
    Other,
}

impl SolidKind {
    /// All kinds, in the order in which they are solved.
    pub const ALL: [Self; 5] = [
        Self::Sphere,
        Self::HalfSpace,
        Self::Capsule,
        Self::Cuboid,
        Self::Other,
    ];
}

/// Heights above the x-z plane in a grid around the origin, columns along +x, rows along +z.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Equal for equal fields.
    pub fingerprint: u64,
    /// Row by row \[m\].
    pub heights: Arc<[f32]>,
    /// Columns and rows.
    pub resolution: UVec2,
    /// Distance between the first and the last row and column \[m\].
    pub size: Vec2,
    /// Lowest and highest value \[m\].
    pub range: (f32, f32),
}

impl Field {
    /// The field of these heights \[m\].
    pub fn new(heights: Arc<[f32]>, resolution: UVec2, size: Vec2) -> Self {
        let measures = size.to_array().map(f32::to_bits);
        let numbers = resolution.to_array().into_iter().chain(measures);
        Self {
            fingerprint: fingerprint::of(numbers.chain(heights.iter().map(|h| h.to_bits()))),
            range: heights.iter().fold((f32::MAX, f32::MIN), |(low, high), h| {
                (low.min(*h), high.max(*h))
            }),
            heights,
            resolution,
            size,
        }
    }
}

/// A convex hull at the scale of its entity.
#[derive(Debug)]
pub struct Hull {
    /// Equal for equal hulls at equal scales.
    fingerprint: u64,
    pub planes: PlaneList,
    pub size: f32,
    range: (Vec3, Vec3),
}

impl Hull {
    /// Distance from an edge or corner to the point where planes at a distance of 1 meet, above which it gets a plane of its own.
    const SHARP: f32 = 2.0;

    /// Hull of these corners and triangles, counter-clockwise seen from outside, at a scale; `None` where nothing is left of it.
    pub fn new(corners: &[Vec3], triangles: &[[u32; 3]], scale: Vec3) -> Option<Self> {
        let points: Vec<Vec3> = corners.iter().map(|p| *p * scale).collect();
        let center = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
        let mut planes: Vec<Vec4> = Vec::new();
        // Normals of the faces at each corner and each edge.
        let mut around = BTreeMap::<[u32; 2], Vec<Vec3>>::new();
        for &[a, b, c] in triangles {
            let [p, q, r] = [a, b, c].map(|k| points[k as usize]);
            let normal = (q - p).cross(r - p).normalize_or_zero();
            if normal == Vec3::ZERO {
                continue;
            }
            let normal = if normal.dot(p - center) < 0.0 {
                -normal
            } else {
                normal
            };
            add(&mut planes, normal, p);
            for [i, j] in [[a, b], [b, c], [c, a], [a, a], [b, b], [c, c]] {
                around.entry([i.min(j), i.max(j)]).or_default().push(normal);
            }
        }
        for ([i, _], normals) in around {
            let middle = normals.iter().sum::<Vec3>().normalize_or_zero();
            let sharp = normals.iter().any(|n| n.dot(middle) < 1.0 / Self::SHARP);
            if sharp && middle != Vec3::ZERO {
                add(&mut planes, middle, points[i as usize]);
            }
        }
        // No corner must be outside by rounding.
        for plane in &mut planes {
            let heights = points.iter().map(|p| plane.truncate().dot(*p));
            plane.w = heights.fold(f32::MIN, f32::max);
        }
        let inside = planes
            .iter()
            .map(|plane| plane.w - plane.truncate().dot(center));
        let size = inside.fold(f32::MAX, f32::min);
        let low = points.iter().copied().reduce(Vec3::min)?;
        let high = points.iter().copied().reduce(Vec3::max)?;
        (planes.len() > 3 && size > 0.0).then(|| Self {
            fingerprint: fingerprint::of_triangles(&points, triangles),
            planes: PlaneList::new(&planes),
            size,
            range: (low, high),
        })
    }
}

/// Adds a plane unless it is there.
fn add(planes: &mut Vec<Vec4>, normal: Vec3, point: Vec3) {
    const SAME: f32 = 1.0 - 1e-6;
    if planes
        .iter()
        .all(|plane| plane.truncate().dot(normal) < SAME)
    {
        planes.push(normal.extend(normal.dot(point)));
    }
}

impl Solid {
    pub fn kind(&self) -> SolidKind {
        match self {
            Self::Sphere { .. } => SolidKind::Sphere,
            Self::HalfSpace => SolidKind::HalfSpace,
            Self::Capsule { .. } => SolidKind::Capsule,
            Self::Cuboid { .. } => SolidKind::Cuboid,
            _ => SolidKind::Other,
        }
    }

    /// Box around it in its own axes; `None` for one without end.
    pub fn range(&self) -> Option<(Vec3, Vec3)> {
        let around = |half: Vec3| (-half, half);
        Some(match self {
            Self::Sphere { radius } => around(Vec3::splat(*radius)),
            Self::HalfSpace => return None,
            Self::Capsule { radii, half_length } => {
                let radius = radii[0].max(radii[1]);
                around(Vec3::new(radius, half_length + radius, radius))
            }
            Self::Cuboid { half_size } => around(*half_size),
            Self::Cylinder {
                radius,
                half_height,
            } => around(Vec3::new(*radius, *half_height, *radius)),
            Self::Hull(hull) => hull.range,
            Self::Mesh(surface) => surface.range(),
            Self::Terrain { field, scale } => {
                let half = 0.5 * field.size * Vec2::new(scale.x, scale.z).abs();
                let (low, high) = field.range;
                let high = (low * scale.y).max(high * scale.y);
                (
                    Vec3::new(-half.x, -DEEP, -half.y),
                    Vec3::new(half.x, high, half.y),
                )
            }
        })
    }

    /// Bits that identify the solid.
    pub fn bits(&self) -> [u64; 3] {
        let two = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        match self {
            Self::Sphere { radius } => [1, two(*radius, 0.0), 0],
            Self::HalfSpace => [2, 0, 0],
            Self::Capsule { radii, half_length } => {
                [3, two(radii[0], radii[1]), two(*half_length, 0.0)]
            }
            Self::Cuboid { half_size } => [4, two(half_size.x, half_size.y), two(half_size.z, 0.0)],
            Self::Cylinder {
                radius,
                half_height,
            } => [5, two(*radius, *half_height), 0],
            Self::Hull(hull) => [6, hull.fingerprint, 0],
            Self::Mesh(surface) => [7, surface.fingerprint, 0],
            Self::Terrain { field, scale } => [
                8,
                field.fingerprint ^ two(scale.y, 0.0),
                two(scale.x, scale.z),
            ],
        }
    }
}

/// Depth below its surface down to which terrain is searched \[m\].
const DEEP: f32 = 1e4;

/// Box around a box that moves from one pose to another, including the poses between.
pub fn swept((low, high): (Vec3, Vec3), start: &Isometry3d, end: &Isometry3d) -> (Vec3, Vec3) {
    let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
    let [a, b] = [start, end].map(|at| {
        let middle = at.rotation * center + Vec3::from(at.translation);
        let m = Mat3::from_quat(at.rotation);
        let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        (middle - half, middle + half)
    });
    // Between the poses it turns: a point at the distance r from the axis leaves the chord by r (1 − cos(angle/2)) at most.
    let half_turn = start.rotation.dot(end.rotation).abs().min(1.0);
    let bulge = Vec3::splat((1.0 - half_turn) * (center.length() + half.length()));
    (a.0.min(b.0) - bulge, a.1.max(b.1) + bulge)
}
