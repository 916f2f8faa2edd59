//! The sheet as a triangle mesh in random order.

use bevy_math::{Vec2, Vec3};
use tailorbird_cloth::prelude::*;
use tailorbird_test::unit;

/// Largest displacement of inner vertices of the irregular sheet along each axis, as a part of the cells.
pub const JITTER: f32 = 0.25;

/// Vertices as near as this count as the same place [m].
pub const NEAR: f32 = 1e-4;

/// A sheet around the origin that stands upright, with so many columns and rows; inner vertices are moved by up to `jitter` of a
/// cell each way.
pub fn sheet([columns, rows]: [u32; 2], size: Vec2, jitter: f32) -> Cloth {
    let (n, m) = (columns as usize, rows as usize);
    let cell = size / Vec2::new((n - 1) as f32, (m - 1) as f32);
    let at = |i: usize| {
        let moved = |seed: u64, along: usize, last: usize| {
            let inner = along > 0 && along < last;
            if inner { jitter * nudge(i, seed) } else { 0.0 }
        };
        let (row, column) = (i / n, i % n);
        let x = column as f32 + moved(1, column, n - 1);
        let y = row as f32 - moved(2, row, m - 1);
        Vec3::new(x * cell.x - 0.5 * size.x, 0.5 * size.y - y * cell.y, 0.0)
    };
    shuffled([n, m], false, jitter > 0.0, at)
}

/// A tube around the y axis of this radius and height, with `size` columns around.
pub fn tube(size: u32, tube: Vec2, jitter: f32) -> Cloth {
    let columns = size.max(3) as usize;
    let around = std::f32::consts::TAU * tube.x;
    let rows = (tube.y / around * columns as f32).round().max(1.0) as usize + 1;
    let at = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let inner = row > 0 && row + 1 < rows;
        let up = if inner { jitter * nudge(i, 2) } else { 0.0 };
        let angle = (column as f32 + jitter * nudge(i, 1)) / columns as f32;
        let y = (0.5 - (row as f32 - up) / (rows - 1) as f32) * tube.y;
        let (sin, cos) = (std::f32::consts::TAU * angle).sin_cos();
        Vec3::new(tube.x * sin, y, tube.x * cos)
    };
    shuffled([columns, rows], true, jitter > 0.0, at)
}

/// By how much of a cell a vertex is moved that is moved by up to one.
fn nudge(i: usize, seed: u64) -> f32 {
    unit(i as u64 ^ seed << 40)
}

/// Columns and rows of vertices in random order, cells cut along random diagonals or, where they are irregular, the shorter one.
fn shuffled(
    [columns, rows]: [usize; 2],
    closed: bool,
    irregular: bool,
    at: impl Fn(usize) -> Vec3,
) -> Cloth {
    let n = columns;
    let mut order: Vec<usize> = (0..n * rows).collect();
    order.sort_by(|a, b| unit(*a as u64).total_cmp(&unit(*b as u64)).then(a.cmp(b)));
    let mut number = vec![0u32; n * rows];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new as u32;
    }
    let positions: Vec<Vec3> = order.iter().map(|&i| at(i)).collect();
    let mut triangles = Vec::with_capacity(2 * n * (rows - 1));
    for row in 0..rows - 1 {
        for column in 0..if closed { n } else { n - 1 } {
            let top = row * n + column;
            let next = row * n + (column + 1) % n;
            let [a, b, c, d] = [top, top + n, next + n, next].map(|i| number[i]);
            let [falling, rising] = [[a, c], [b, d]]
                .map(|[p, q]| positions[p as usize].distance(positions[q as usize]));
            let cut = if irregular {
                falling <= rising
            } else {
                unit(top as u64) > 0.0
            };
            triangles.extend(if cut {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [d, b, c]]
            });
        }
    }
    let key = |t: &[u32; 3]| unit(u64::from(t[0]) << 32 | u64::from(t[1]) << 16 | u64::from(t[2]));
    triangles.sort_by(|a, b| key(a).total_cmp(&key(b)));
    Cloth::mesh(positions, triangles.concat())
}
