//! Normals of triangles and, weighted by area, of particles.

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, SharedPoints, V3, each_window};
use crate::{points::Points, topology::lattice::Lattice};

/// Unit normals of the triangles. One without area keeps the normal it had.
///
/// # Panics
/// When a corner is not below the number of particles, or there are fewer normals than triangles.
pub fn flat(triangles: &[[u32; 3]], position: &Points, normals: &mut Points) {
    for (k, triangle) in triangles.iter().enumerate() {
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

/// What [`smooth`] does, for the triangles of a sheet (see `topology::grid`): cells side by side.
///
/// # Panics
/// When there are not as many positions and normals as particles.
pub fn smooth_lattice(level: Level, lattice: &Lattice, position: &Points, normals: &mut Points) {
    let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
    assert_eq!(position.len(), columns * rows, "positions of a sheet");
    assert_eq!(normals.len(), columns * rows, "normals of a sheet");
    normals.fill(Vec3::ZERO);
    let normals = SharedPoints::new(normals);
    dispatch!(level, simd => smooth_lattice_with(simd, columns, rows, position, normals));
}

#[inline(always)]
fn smooth_lattice_with<S: Simd>(
    simd: S,
    columns: usize,
    rows: usize,
    position: &Points,
    normals: SharedPoints,
) {
    for row in 0..rows - 1 {
        let upper = row * columns;
        let lower = upper + columns;
        // Up to the middle the diagonals of the upper half fall to the right, those of the lower half rise.
        let middle = columns / 2;
        let top = 2 * row < rows - 1;
        for (cells, left) in [(0..middle, true), (middle..columns - 1, false)] {
            let falling = left == top;
            // First the corners on the left of all cells, then those on the right: then the order in which a particle's sum
            // is made does not depend on how many cells lie side by side.
            for right in [0, 1] {
                each_window(
                    simd,
                    cells.clone(),
                    #[inline(always)]
                    |window| {
                        let at = |offset| position.window::<S>(simd, window, offset);
                        let (tl, tr) = (at(upper), at(upper + 1));
                        let (bl, br) = (at(lower), at(lower + 1));
                        let (first, second) = if falling {
                            ((bl - tl).cross(br - tl), (br - tl).cross(tr - tl))
                        } else {
                            ((bl - tl).cross(tr - tl), (bl - tr).cross(br - tr))
                        };
                        let both = first + second;
                        let (above, below) = match (falling, right) {
                            (true, 0) => (both, first),
                            (true, _) => (second, both),
                            (false, 0) => (first, both),
                            (false, _) => (both, second),
                        };
                        for (offset, part) in [(upper + right, above), (lower + right, below)] {
                            let sum: V3<S> = normals.load_at(simd, window, offset) + part;
                            normals.store_at(simd, window, offset, sum);
                        }
                    },
                );
            }
        }
    }
    let (up, least) = (V3::splat(simd, Vec3::Z), S::f32s::splat(simd, 1e-30));
    each_window(
        simd,
        0..columns * rows,
        #[inline(always)]
        |window| {
            let sum: V3<S> = normals.load_at(simd, window, 0);
            let q = sum.dot(sum);
            let unit = Factor(S::f32s::splat(simd, 1.0) / q.sqrt()) * sum;
            normals.store_at(simd, window, 0, unit.select(q.simd_gt(least), up));
        },
    );
}

#[cfg(test)]
mod tests {
    use bevy_math::{UVec2, Vec2};

    use super::*;
    use crate::{cloth::Cloth, solver::kernels::lanes::levels, topology::Topology};

    #[test]
    fn side_by_side_agrees_with_one_by_one() {
        for (columns, rows) in [(2, 2), (3, 2), (5, 7), (17, 4), (33, 34), (64, 50)] {
            let cloth = Cloth::grid(Vec2::new(2.0, 1.0), UVec2::new(columns, rows));
            let topology = Topology::build(&cloth.shape, Vec3::ONE).expect("valid");
            let lattice = topology.lattice.expect("a grid");
            let position: Points = topology
                .rest_positions
                .iter()
                .map(|p| *p + Vec3::Z * (7.0 * p.x + 3.0 * p.y * p.y).sin() * 0.2)
                .collect();
            let mut expected = Points::zeroed(position.len());
            smooth(&topology.triangles, &position, &mut expected);
            let mut first = None;
            for level in levels() {
                let mut normals = Points::zeroed(position.len());
                smooth_lattice(level, &lattice, &position, &mut normals);
                for (a, b) in normals.iter().zip(expected.iter()) {
                    assert!(a.distance(b) < 1e-4, "{columns}x{rows} {level:?}: {a} {b}");
                }
                assert_eq!(first.get_or_insert_with(|| normals.clone()), &normals);
            }
        }
    }
}
