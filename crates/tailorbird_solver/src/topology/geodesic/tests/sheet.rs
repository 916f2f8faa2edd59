//! Sheets that are cut into triangles in different ways.

use bevy_math::{Vec2, Vec3};

/// A sheet of n × m cells, its particles moved by up to `jitter` of a cell.
pub struct Sheet {
    pub flat: Vec<Vec2>,
    pub triangles: Vec<[u32; 3]>,
    /// Number of particles in a row.
    pub columns: u32,
}

/// Between −0.5 and 0.5.
fn noise(seed: u32) -> f32 {
    let mut x = seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
    for _ in 0..3 {
        x ^= x >> 15;
        x = x.wrapping_mul(0x85eb_ca6b);
        x ^= x >> 13;
    }
    x as f32 / u32::MAX as f32 - 0.5
}

/// Diagonal along which a cell is cut; the other one where that would turn a triangle over.
#[derive(Clone, Copy, Debug)]
pub enum Split {
    Same,
    Alternating,
    Shorter,
    Longer,
    Random,
}

impl Sheet {
    pub fn new(n: u32, m: u32, split: Split, jitter: f32, seed: u32, cell: Vec2) -> Self {
        let columns = n + 1;
        let flat: Vec<Vec2> = (0..columns * (m + 1))
            .map(|k| {
                let (i, j) = (k % columns, k / columns);
                let inside = Vec2::new(
                    f32::from(u8::from(i > 0 && i < n)),
                    f32::from(u8::from(j > 0 && j < m)),
                );
                let random = Vec2::new(noise(2 * k + seed), noise(2 * k + 1 + seed));
                (Vec2::new(i as f32, j as f32) + random * inside * 2.0 * jitter) * cell
            })
            .collect();
        let mut triangles = Vec::new();
        for j in 0..m {
            for i in 0..n {
                let [a, b] = [j * columns + i, j * columns + i + 1];
                let [c, d] = [a + columns, b + columns];
                let length = |p: u32, q: u32| flat[p as usize].distance(flat[q as usize]);
                let shorter = length(a, d) < length(b, c);
                let area = |t: [u32; 3]| {
                    let [p, q, r] = t.map(|i| flat[i as usize]);
                    (q - p).perp_dot(r - p)
                };
                let options = [[[a, b, d], [a, d, c]], [[a, b, c], [b, d, c]]];
                let least = options.map(|o| area(o[0]).min(area(o[1])));
                let first = match split {
                    _ if least[0].min(least[1]) <= 0.0 => least[0] > least[1],
                    Split::Same => true,
                    Split::Alternating => (i + j) % 2 == 0,
                    Split::Shorter => shorter,
                    Split::Longer => !shorter,
                    Split::Random => noise(a ^ seed) > 0.0,
                };
                assert!(least[0].max(least[1]) > 0.0, "too much jitter");
                triangles.extend(options[usize::from(!first)]);
            }
        }
        Self {
            flat,
            triangles,
            columns,
        }
    }

    /// Without the triangles whose middle is not inside.
    pub fn keep(mut self, mut inside: impl FnMut(Vec2) -> bool) -> Self {
        let flat = &self.flat;
        self.triangles
            .retain(|t| inside(t.iter().map(|&i| flat[i as usize]).sum::<Vec2>() / 3.0));
        self
    }

    pub fn positions(&self, bend: impl Fn(Vec2) -> Vec3) -> Vec<Vec3> {
        self.flat.iter().map(|&p| bend(p)).collect()
    }
}
