//! Meshes for tests.

use bevy_math::Vec3;

/// A grid in the x-y plane with columns along +x, rows along −y, whose cells are cut as `rising` says.
pub fn grid(
    columns: usize,
    rows: usize,
    size: [f32; 2],
    rising: impl Fn(usize, usize) -> bool,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let positions = (0..rows * columns)
        .map(|i| {
            Vec3::new(
                (i % columns) as f32 * size[0],
                -((i / columns) as f32) * size[1],
                0.0,
            )
        })
        .collect();
    let mut triangles = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let a = (row * columns + column) as u32;
            let [b, c, d] = [a + columns as u32, a + columns as u32 + 1, a + 1];
            if rising(column, row) {
                triangles.extend([[a, b, d], [d, b, c]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (positions, triangles)
}

/// The order of `n` things by a hash of each.
fn shuffled(n: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|i| hash(*i, seed));
    order
}

/// A number that looks random.
pub fn hash(i: usize, seed: u64) -> u64 {
    let mut x = (i as u64 ^ seed.rotate_left(17)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^ (x >> 32)
}

/// The same mesh with vertices and triangles in another order.
pub fn shuffle(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    seed: u64,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let order = shuffled(positions.len(), seed);
    let mut number = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new as u32;
    }
    let positions = order.iter().map(|i| positions[*i]).collect();
    let triangles = shuffled(triangles.len(), seed + 1)
        .into_iter()
        .map(|t| {
            let mut triangle = triangles[t].map(|i| number[i as usize]);
            triangle.rotate_left(hash(t, seed) as usize % 3);
            triangle
        })
        .collect();
    (positions, triangles)
}

/// A number from 0 to 1 that looks random.
pub fn random(i: usize, seed: u64) -> f32 {
    (hash(i, seed) >> 40) as f32 / (1u64 << 24) as f32
}

/// A square of side 1 with about `n`² points, a row of evenly spaced ones along each border and others scattered no
/// closer than 0.7 / n, as a Delaunay triangulation (Bowyer and Watson).
pub fn delaunay(n: usize, seed: u64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let step = 1.0 / n as f32;
    let mut positions: Vec<Vec3> = (0..n)
        .flat_map(|i| {
            let t = i as f32 * step;
            [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]]
        })
        .map(|[x, y]| Vec3::new(x, y, 0.0))
        .collect();
    for i in 0..n * n * 20 {
        let p = Vec3::new(random(2 * i, seed), random(2 * i + 1, seed), 0.0);
        let margin = 0.5 * step;
        let inside = (p - 0.5).abs().truncate().max_element() < 0.5 - margin;
        if inside
            && positions
                .iter()
                .all(|q| q.distance_squared(p) > (0.7 * step).powi(2))
        {
            positions.push(p);
        }
    }
    let points = positions.len() as u32;
    let nudge = |i: usize| 1e-6 * f64::from(random(i, 99));
    let mut at: Vec<[f64; 2]> = positions
        .iter()
        .enumerate()
        .map(|(i, p)| {
            [
                f64::from(p.x) + nudge(2 * i),
                f64::from(p.y) + nudge(2 * i + 1),
            ]
        })
        .collect();
    at.extend([[-20.0, -20.0], [20.0, -20.0], [0.0, 20.0]]);
    let mut triangles = vec![[points, points + 1, points + 2]];
    for i in 0..points {
        let p = at[i as usize];
        let inside = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| {
                let q = at[k as usize];
                let d = [q[0] - p[0], q[1] - p[1]];
                [d[0], d[1], d[0] * d[0] + d[1] * d[1]]
            });
            let minor = |u: [f64; 3], v: [f64; 3]| u[0] * v[1] - u[1] * v[0];
            a[2] * minor(b, c) + b[2] * minor(c, a) + c[2] * minor(a, b) > 0.0
        };
        let (gone, mut kept): (Vec<_>, Vec<_>) = triangles.into_iter().partition(inside);
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let all: Vec<[u32; 2]> = gone.iter().flat_map(sides).collect();
        for &[a, b] in &all {
            if !all.contains(&[b, a]) {
                kept.push([a, b, i]);
            }
        }
        triangles = kept;
    }
    triangles.retain(|t| {
        let [a, b, c] = t.map(|k| at[k as usize]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        t.iter().all(|k| *k < points) && area > 1e-4 * f64::from(step * step)
    });
    (positions, triangles)
}
