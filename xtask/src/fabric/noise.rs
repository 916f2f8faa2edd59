//! Noise on lattices that wrap around.

/// Periodic noise along a line of its own for each `row`, -1 to 1. `t` goes from 0 to 1 over `cells` cells.
pub fn wave(seed: u32, row: u32, t: f32, cells: u32) -> f32 {
    let place = t * cells as f32;
    let cell = place.floor() as i32;
    let value = |cell: i32| hash(seed, row, wrap(cell, cells));
    2.0 * mix(value(cell), value(cell + 1), ease(place - place.floor())) - 1.0
}

/// Periodic noise over a plane, -1 to 1, that repeats after `x_cells` by `y_cells` cells of size 1.
pub fn surface(seed: u32, x: f32, x_cells: u32, y: f32, y_cells: u32) -> f32 {
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let value = |column: i32, row: i32| hash(seed, wrap(column, x_cells), wrap(row, y_cells));
    let line = |row: i32| {
        mix(
            value(column, row),
            value(column + 1, row),
            ease(x - x.floor()),
        )
    };
    2.0 * mix(line(row), line(row + 1), ease(y - y.floor())) - 1.0
}

/// A number from 0 to 1 that is always the same for the same three integers.
pub fn hash(a: u32, b: u32, c: u32) -> f32 {
    let mut bits =
        a.wrapping_mul(0x9E37_79B1) ^ b.wrapping_mul(0x85EB_CA77) ^ c.wrapping_mul(0xC2B2_AE3D);
    for _ in 0..2 {
        bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
        bits = (bits ^ (bits >> 12)).wrapping_mul(0x297A_2D39);
    }
    bits ^= bits >> 15;
    (bits >> 8) as f32 / 16_777_216.0
}

pub fn wrap(index: i32, count: u32) -> u32 {
    index.rem_euclid(count as i32) as u32
}

pub fn mix(from: f32, to: f32, share: f32) -> f32 {
    from + (to - from) * share
}

pub fn ease(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// The two nearest of points scattered one to each of `cells` by `cells` cells of a tile: distances in cells, and which is nearest.
pub fn scattered(seed: u32, u: f32, v: f32, cells: u32) -> ([f32; 2], u32) {
    let (x, y) = (u * cells as f32, v * cells as f32);
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let mut nearest = [f32::MAX; 2];
    let mut which = 0;
    for k in 0..25 {
        let (column, row) = (column + k % 5 - 2, row + k / 5 - 2);
        let cell = [column, row].map(|k| wrap(k, cells));
        let at = |axis: u32| 0.15 + 0.7 * hash(seed + axis, cell[0], cell[1]);
        let (dx, dy) = (column as f32 + at(0) - x, row as f32 + at(1) - y);
        let distance = dx.hypot(dy);
        if distance < nearest[0] {
            nearest = [distance, nearest[0]];
            which = cell[0] + cells * cell[1];
        } else if distance < nearest[1] {
            nearest[1] = distance;
        }
    }
    (nearest, which)
}
