//! The constraints of a sheet of columns × rows particles, in the form that the vector kernels want.
//!
//! Columns lie side by side in memory and are solved where they are. Rows are transposed, a block of them at a time, into
//! scratch that has the form of columns, solved by the same kernel, and transposed back.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Factor, Shared, SharedPoints, V3, WIDEST, Window, each_window, with_scratch},
    line::{self, LineStiffness, Lines},
};

/// Particles of a sheet, in row-major order.
#[derive(Clone, Copy)]
pub(crate) struct Sheet<'a> {
    pub columns: usize,
    pub rows: usize,
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 where there is none; empty where nothing is in contact.
    pub normal: Option<SharedPoints<'a>>,
}

impl Sheet<'_> {
    /// Makes sure that all of columns × rows particles are there.
    ///
    /// # Panics
    /// Where they are not.
    #[inline(always)]
    pub fn check(&self) {
        let n = self.columns * self.rows;
        let points = |p: SharedPoints| [p.x.len(), p.y.len(), p.z.len()] == [n; 3];
        assert!(
            points(self.position) && self.inv_mass.len() == n && self.normal.is_none_or(points),
            "a sheet of {} x {} particles",
            self.columns,
            self.rows
        );
    }
}

/// Solves each column of a range.
pub(crate) fn solve_columns(
    level: Level,
    sheet: Sheet,
    stiffness: LineStiffness,
    columns: Range<usize>,
) {
    sheet.check();
    with_scratch(sheet.rows * WIDEST * 9, |scratch| {
        dispatch!(level, simd => solve_columns_with(simd, sheet, stiffness, columns, scratch));
    });
}

#[inline(always)]
fn solve_columns_with<S: Simd>(
    simd: S,
    sheet: Sheet,
    stiffness: LineStiffness,
    columns: Range<usize>,
    scratch: &mut [f32],
) {
    let (m, n) = (sheet.rows, S::f32s::LEN);
    let mut lines = Lines {
        position: sheet.position,
        inv_mass: sheet.inv_mass,
        normal: sheet.normal.unwrap_or(sheet.position),
        offset: columns.start,
        stride: sheet.columns,
        len: m,
    };
    let contact = sheet.normal.is_some();
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    while lines.offset + n <= columns.end {
        solve_block(simd, lines, stiffness, contact, factors);
        lines.offset += n;
    }
    let count = columns.end - lines.offset;
    if count == 0 {
        return;
    }
    let block = Block::new(rest, m, n);
    let window = Window::short(count);
    for k in 0..m {
        let from = lines.offset + k * sheet.columns;
        let p: V3<S> = sheet.position.load_at(simd, window, from);
        block.position.store(k * n, p);
        let w = sheet.inv_mass.load_at(simd, window, from);
        block.inv_mass.store::<S>(k * n, w);
        if let Some(normal) = sheet.normal {
            let normal: V3<S> = normal.load_at(simd, window, from);
            block.normal.store(k * n, normal);
        }
    }
    solve_block(simd, block.lines(m, n), stiffness, contact, factors);
    for k in 0..m {
        let p: V3<S> = block.position.load(simd, k * n);
        let to = lines.offset + k * sheet.columns;
        sheet.position.store_at(simd, window, to, p);
    }
}

/// Solves each row of a range.
pub(crate) fn solve_rows(level: Level, sheet: Sheet, stiffness: LineStiffness, rows: Range<usize>) {
    sheet.check();
    with_scratch(sheet.columns * WIDEST * 9, |scratch| {
        dispatch!(level, simd => solve_rows_with(simd, sheet, stiffness, rows, scratch));
    });
}

#[inline(always)]
fn solve_rows_with<S: Simd>(
    simd: S,
    sheet: Sheet,
    stiffness: LineStiffness,
    rows: Range<usize>,
    scratch: &mut [f32],
) {
    let (m, n) = (sheet.columns, S::f32s::LEN);
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let block = Block::new(rest, m, n);
    let contact = sheet.normal.is_some();
    let mut row = rows.start;
    while row < rows.end {
        let tile = Tile {
            sheet_offset: row * m,
            rows: (rows.end - row).min(n),
            columns: m,
        };
        tile.load(simd, sheet.position.x, block.position.x);
        tile.load(simd, sheet.position.y, block.position.y);
        tile.load(simd, sheet.position.z, block.position.z);
        tile.load(simd, sheet.inv_mass, block.inv_mass);
        if let Some(normal) = sheet.normal {
            tile.load(simd, normal.x, block.normal.x);
            tile.load(simd, normal.y, block.normal.y);
            tile.load(simd, normal.z, block.normal.z);
        }
        solve_block(simd, block.lines(m, n), stiffness, contact, factors);
        tile.store(simd, block.position.x, sheet.position.x);
        tile.store(simd, block.position.y, sheet.position.y);
        tile.store(simd, block.position.z, sheet.position.z);
        row += tile.rows;
    }
}

#[inline(always)]
fn solve_block<S: Simd>(
    simd: S,
    lines: Lines,
    stiffness: LineStiffness,
    contact: bool,
    factors: Shared,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            if contact {
                line::solve::<S, _, true, true>(simd, lines, stiffness, stiffness.bend, factors);
            } else {
                line::solve::<S, _, true, false>(simd, lines, stiffness, stiffness.bend, factors);
            }
        },
    );
}

/// Scratch in the form of columns.
pub(super) struct Block<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    pub normal: SharedPoints<'a>,
}

impl<'a> Block<'a> {
    #[inline(always)]
    pub fn new(scratch: &'a mut [f32], len: usize, width: usize) -> Self {
        let (mut parts, _) = scratch.split_at_mut(7 * len * width);
        let mut next = || {
            let (part, rest) = std::mem::take(&mut parts).split_at_mut(len * width);
            parts = rest;
            Shared::new(part)
        };
        let mut points = || SharedPoints {
            x: next(),
            y: next(),
            z: next(),
        };
        let (position, normal) = (points(), points());
        Self {
            position,
            normal,
            inv_mass: next(),
        }
    }

    #[inline(always)]
    pub fn lines(&self, len: usize, width: usize) -> Lines<'a> {
        Lines {
            position: self.position,
            inv_mass: self.inv_mass,
            normal: self.normal,
            offset: 0,
            stride: width,
            len,
        }
    }
}

/// Up to as many rows as a vector has lanes, and where they lie as columns of a block.
#[derive(Clone, Copy)]
struct Tile {
    sheet_offset: usize,
    rows: usize,
    columns: usize,
}

impl Tile {
    /// Transposes rows of the sheet to columns of the block. Lanes without a row get 0.
    #[inline(always)]
    fn load<S: Simd>(self, simd: S, sheet: Shared, block: Shared) {
        let n = S::f32s::LEN;
        let mut column = 0;
        if self.rows == n {
            while column + n <= self.columns {
                let mut tile = [S::f32s::splat(simd, 0.0); WIDEST];
                for (r, vector) in tile[..n].iter_mut().enumerate() {
                    *vector = sheet.load(simd, self.sheet_offset + r * self.columns + column);
                }
                let tile = transpose::<S>(tile);
                for (c, vector) in tile[..n].iter().enumerate() {
                    block.store::<S>((column + c) * n, *vector);
                }
                column += n;
            }
        }
        for c in column..self.columns {
            for r in 0..n {
                let value = if r < self.rows {
                    sheet.get(self.sheet_offset + r * self.columns + c)
                } else {
                    0.0
                };
                block.set(c * n + r, value);
            }
        }
    }

    /// Transposes columns of the block back to rows of the sheet.
    #[inline(always)]
    fn store<S: Simd>(self, simd: S, block: Shared, sheet: Shared) {
        let n = S::f32s::LEN;
        let mut column = 0;
        if self.rows == n {
            while column + n <= self.columns {
                let mut tile = [S::f32s::splat(simd, 0.0); WIDEST];
                for (c, vector) in tile[..n].iter_mut().enumerate() {
                    *vector = block.load(simd, (column + c) * n);
                }
                let tile = transpose::<S>(tile);
                for (r, vector) in tile[..n].iter().enumerate() {
                    sheet.store::<S>(self.sheet_offset + r * self.columns + column, *vector);
                }
                column += n;
            }
        }
        for c in column..self.columns {
            for r in 0..self.rows {
                let value = block.get(c * n + r);
                sheet.set(self.sheet_offset + r * self.columns + c, value);
            }
        }
    }
}

/// Transposes a square of as many vectors as they have lanes: in each round, vector i and the one half a square further are
/// interleaved.
#[inline(always)]
fn transpose<S: Simd>(mut tile: [S::f32s; WIDEST]) -> [S::f32s; WIDEST] {
    let n = S::f32s::LEN;
    let mut rounds = n;
    while rounds > 1 {
        let mut next = tile;
        for i in 0..n / 2 {
            let (low, high) = tile[i].interleave(tile[i + n / 2]);
            next[2 * i] = low;
            next[2 * i + 1] = high;
        }
        tile = next;
        rounds /= 2;
    }
    tile
}

/// What the diagonals of the cells resist with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// L \[m\].
    pub rest_length: f32,
    /// α̃ = α/h² [1/kg].
    pub alpha_tilde: f32,
    /// Whether the diagonals that rise to the right come first.
    pub rising_first: bool,
}

/// Projects both diagonals of the cells between each row of a range and the next, every second row.
///
/// Without a square root: s = 2 (q − L²)/(3 q + L²) is 1 − L/|d| to second order around rest, and never more than that.
pub(crate) fn solve_shear(level: Level, sheet: Sheet, shear: Shear, rows: Range<usize>) {
    sheet.check();
    dispatch!(level, simd => solve_shear_with(simd, sheet, shear, rows));
}

#[inline(always)]
fn solve_shear_with<S: Simd>(simd: S, sheet: Sheet, shear: Shear, rows: Range<usize>) {
    for row in rows.step_by(2) {
        if row + 1 >= sheet.rows {
            break;
        }
        let (upper, lower) = (row * sheet.columns, (row + 1) * sheet.columns);
        for rising in [shear.rising_first, !shear.rising_first] {
            if rising {
                diagonals(simd, sheet, shear, upper + 1, lower);
            } else {
                diagonals(simd, sheet, shear, upper, lower + 1);
            }
        }
    }
}

/// The springs from `a + j` to `b + j` for each of the cells j of a row.
#[inline(always)]
fn diagonals<S: Simd>(simd: S, sheet: Sheet, shear: Shear, a: usize, b: usize) {
    let l2 = S::f32s::splat(simd, shear.rest_length * shear.rest_length);
    let alpha = S::f32s::splat(simd, shear.alpha_tilde);
    let least = S::f32s::splat(simd, 1e-30);
    let cells = 0..sheet.columns - 1;
    each_window(
        simd,
        cells.clone(),
        #[inline(always)]
        |window| {
            let p_a: V3<S> = sheet.position.load_at(simd, window, a);
            let p_b: V3<S> = sheet.position.load_at(simd, window, b);
            let w_a = sheet.inv_mass.load_at(simd, window, a);
            let w_b = sheet.inv_mass.load_at(simd, window, b);
            let d = p_b - p_a;
            let q = d.dot(d);
            let excess = q - l2;
            // As for bending: see `line`.
            let w = w_a + w_b;
            let w = (w * 0.5 + alpha).max(w).max(least);
            let s = (excess + excess) / ((q * 3.0 + l2) * w);
            let push = Factor(s) * d;
            sheet
                .position
                .store_at(simd, window, a, p_a + Factor(w_a) * push);
            sheet
                .position
                .store_at(simd, window, b, p_b - Factor(w_b) * push);
        },
    );
}
