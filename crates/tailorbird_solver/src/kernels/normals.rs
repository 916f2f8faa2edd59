//! Normals of triangles and, weighted by area, of particles.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    cells::{AroundParticle, gather, with_cells},
    lanes::{Factor, SharedPoints, V3, Window},
};
use crate::{points::Points, topology::lattice::Lattice};

/// Unit normals of the triangles. A triangle without area keeps the normal it had.
///
/// # Panics
/// When a corner is not below the number of particles, or there are fewer normals than triangles.
pub fn flat(triangles: impl Iterator<Item = [u32; 3]>, position: &Points, normals: &mut Points) {
    for (k, triangle) in triangles.enumerate() {
        let [a, b, c] = triangle.map(|i| position.get(i as usize));
        let normal = (b - a).cross(c - a).normalize_or(normals.get(k));
        normals.set(k, normal);
    }
}

/// Unit normals of the particles: the sum of the cross products of the triangles around each, whose lengths are twice their
/// areas. A particle without a triangle, or whose triangles cancel, gets +z.
///
/// # Panics
/// When a corner is not below the number of particles, or there are fewer normals than particles.
pub fn smooth(triangles: &[[u32; 3]], position: &Points, normals: &mut Points) {
    normals.fill(Vec3::ZERO);
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| position.get(i));
        let cross = (b - a).cross(c - a);
        for i in corners {
            normals.add(i, cross);
        }
    }
    for i in 0..normals.len() {
        normals.set(i, normals.get(i).normalize_or(Vec3::Z));
    }
}

/// Computes [`smooth`] for a range of the rows of a sheet whose cells are cut as in `topology::grid`: cells side by side. Only the normals
/// of these rows are written, so that several threads may do different rows.
///
/// # Panics
/// When there are not as many positions and normals as particles, or not as many rows.
pub fn smooth_lattice(
    level: Level,
    lattice: &Lattice,
    position: &Points,
    normals: SharedPoints,
    rows: Range<usize>,
) {
    let size = [lattice.columns, lattice.rows].map(|n| n as usize);
    let n = size[0] * size[1];
    assert!(position.has(n), "positions of a sheet");
    assert!(normals.has(n), "normals of a sheet");
    assert!(rows.end <= size[1], "rows of a sheet");
    let smooth = Smooth { position, normals };
    with_cells(size[0], |scratch| {
        dispatch!(level, simd => gather(simd, size, rows, smooth, scratch));
    });
}

/// Sum of normals around each particle.
#[derive(Clone, Copy)]
struct Smooth<'a> {
    position: &'a Points,
    normals: SharedPoints<'a>,
}

impl<S: Simd> AroundParticle<S> for Smooth<'_> {
    type Corner = V3<S>;

    #[inline(always)]
    fn corner(self, simd: S, window: Window, offset: usize) -> V3<S> {
        self.position.window(simd, window, offset)
    }

    #[inline(always)]
    fn triangle(self, _simd: S, [a, b, c]: [V3<S>; 3]) -> V3<S> {
        (b - a).cross(c - a)
    }

    #[inline(always)]
    fn take(self, simd: S, window: Window, offset: usize, sum: V3<S>) {
        let [one, least] = [1.0, 1e-30].map(|v| S::f32s::splat(simd, v));
        let q = sum.dot(sum);
        let unit = Factor(one / q.sqrt()) * sum;
        let normal = unit.select(q.simd_gt(least), V3::splat(simd, Vec3::Z));
        self.normals.store_at(simd, window, offset, normal);
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::{UVec2, Vec2};

    use super::*;
    use crate::{kernels::lanes::levels, shape::ClothShape, topology::Topology};

    #[test]
    fn side_by_side_agrees_with_one_by_one() {
        for (columns, rows) in [(2, 2), (3, 2), (5, 7), (17, 4), (33, 34), (64, 50)] {
            let cloth = ClothShape::grid(Vec2::new(2.0, 1.0), UVec2::new(columns, rows));
            let topology = Topology::build(&cloth, Vec3::ONE).expect("valid");
            let lattice = *topology.lattice().expect("a grid");
            let position: Points = topology
                .rest_positions
                .iter()
                .map(|p| *p + Vec3::Z * (7.0 * p.x + 3.0 * p.y * p.y).sin() * 0.2)
                .collect();
            let mut expected = Points::zeroed(position.len());
            let triangles: Vec<[u32; 3]> = topology.triangles().iter().collect();
            smooth(&triangles, &position, &mut expected);
            let mut first = None;
            for level in levels() {
                let mut normals = Points::zeroed(position.len());
                let shared = SharedPoints::new(&mut normals);
                smooth_lattice(level, &lattice, &position, shared, 0..rows as usize);
                for (a, b) in normals.iter().zip(expected.iter()) {
                    assert!(a.distance(b) < 1e-4, "{columns}x{rows} {level:?}: {a} {b}");
                }
                assert_eq!(first.get_or_insert_with(|| normals.clone()), &normals);

                let mut in_parts = Points::zeroed(position.len());
                let shared = SharedPoints::new(&mut in_parts);
                let half = rows as usize / 2;
                for rows in [half..rows as usize, 0..half] {
                    smooth_lattice(level, &lattice, &position, shared, rows);
                }
                assert_eq!(in_parts, normals);
            }
        }
    }
}
