//! The sheet as a triangle mesh in random order.

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

use super::scene::{SIZE, unit};

/// How far inner vertices of the irregular sheet are moved each way, as a part of the cells.
pub const JITTER: f32 = 0.25;

/// Vertices as near as this count as the same place [m].
pub const NEAR: f32 = 1e-4;

/// A square sheet around the origin that stands upright, with `size` vertices along each side; inner ones are moved by up to
/// `jitter` of a cell each way.
pub fn sheet(size: u32, jitter: f32) -> Cloth {
    let n = size as usize;
    let cell = SIZE / (n - 1) as f32;
    let mut order: Vec<usize> = (0..n * n).collect();
    order.sort_by(|a, b| unit(*a as u64).total_cmp(&unit(*b as u64)).then(a.cmp(b)));
    let mut number = vec![0u32; n * n];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new as u32;
    }
    let positions: Vec<Vec3> = order
        .iter()
        .map(|&i| {
            let (row, column) = (i / n, i % n);
            let moved = |seed: u64, along: usize| {
                let inner = along > 0 && along + 1 < n;
                if inner {
                    jitter * cell * unit(i as u64 ^ seed << 40)
                } else {
                    0.0
                }
            };
            Vec3::new(
                column as f32 * cell - 0.5 * SIZE + moved(1, column),
                0.5 * SIZE - row as f32 * cell + moved(2, row),
                0.0,
            )
        })
        .collect();
    let mut triangles = Vec::with_capacity(2 * (n - 1) * (n - 1));
    for row in 0..n - 1 {
        for column in 0..n - 1 {
            let top = row * n + column;
            let [a, b, c, d] = [top, top + n, top + n + 1, top + 1].map(|i| number[i]);
            let [falling, rising] = [[a, c], [b, d]]
                .map(|[p, q]| positions[p as usize].distance(positions[q as usize]));
            let cut = if jitter > 0.0 {
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
