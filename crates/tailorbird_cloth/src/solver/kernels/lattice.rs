//! The constraints of a sheet of columns × rows particles, in the form that the vector kernels want.
//!
//! Columns lie side by side in memory and are solved where they are. Rows are transposed, a block of them at a time, into
//! scratch that has the form of columns, solved by the same kernel, and transposed back.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Shared, SharedPoints, V3, WIDEST, Window, with_scratch},
    line::{self, Edge, FREE, LineStiffness, Lines, PRESSED, TOUCHING},
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
    /// Where what pushes particles along their normals is added up.
    pub pressed: Option<Shared<'a>>,
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
            points(self.position)
                && self.inv_mass.len() == n
                && self.normal.is_none_or(points)
                && self.pressed.is_none_or(|pressed| pressed.len() == n),
            "a sheet of {} x {} particles",
            self.columns,
            self.rows
        );
    }
}

/// Calls a kernel with two instruction sets alone: sheets that carry bodies are few, and each takes long to compile.
macro_rules! for_bodies {
    ($level:expr, $simd:ident => $do:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let level = $level.as_avx2().map_or(Level::fallback(), Level::Avx2);
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let level = $level;
        match level {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $do,
            ),
            #[cfg(target_arch = "aarch64")]
            Level::Neon($simd) => $simd.vectorize(
                #[inline(always)]
                || $do,
            ),
            _ => {
                let $simd = fearless_simd::Fallback::new();
                $do
            }
        }
    }};
}
pub(super) use for_bodies;

/// Solves each column of a range.
pub(crate) fn solve_columns(
    level: Level,
    sheet: Sheet,
    stiffness: LineStiffness,
    columns: Range<usize>,
) {
    sheet.check();
    with_scratch(sheet.rows * WIDEST * 10, |scratch| {
        if sheet.pressed.is_some() {
            for_bodies!(level, simd => solve_columns_with::<_, true>(simd, sheet, stiffness, columns, scratch));
        } else {
            dispatch!(level, simd => solve_columns_with::<_, false>(simd, sheet, stiffness, columns, scratch));
        }
    });
}

#[inline(always)]
fn solve_columns_with<S: Simd, const BODIES: bool>(
    simd: S,
    sheet: Sheet,
    stiffness: LineStiffness,
    columns: Range<usize>,
    scratch: &mut [f32],
) {
    let (m, n) = (sheet.rows, S::f32s::LEN);
    let contact = sheet.normal.is_some();
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let block = Block::new(rest, m, n);
    let mut lines = Lines {
        position: sheet.position,
        inv_mass: sheet.inv_mass,
        normal: sheet.normal.unwrap_or(sheet.position),
        pressed: sheet.pressed.unwrap_or(sheet.inv_mass),
        bent: block.position,
        offset: columns.start,
        stride: sheet.columns,
        len: m,
    };
    let of_lines = |first| stiffness.of_lines(simd, first, sheet.columns);
    while lines.offset + n <= columns.end {
        solve_block::<S, BODIES>(simd, lines, of_lines(lines.offset), contact, factors);
        lines.offset += n;
    }
    let count = columns.end - lines.offset;
    if count == 0 {
        return;
    }
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
        if let (true, Some(pressed)) = (BODIES, sheet.pressed) {
            let sum = pressed.load_at(simd, window, from);
            block.pressed.store::<S>(k * n, sum);
        }
    }
    let stiffness = of_lines(lines.offset);
    solve_block::<S, BODIES>(simd, block.lines(m, n), stiffness, contact, factors);
    for k in 0..m {
        let p: V3<S> = block.position.load(simd, k * n);
        let to = lines.offset + k * sheet.columns;
        sheet.position.store_at(simd, window, to, p);
        if let (true, Some(pressed)) = (BODIES, sheet.pressed) {
            let sum = block.pressed.load(simd, k * n);
            pressed.store_at::<S>(simd, window, to, sum);
        }
    }
}

/// Solves each row of a range.
pub(crate) fn solve_rows(level: Level, sheet: Sheet, stiffness: LineStiffness, rows: Range<usize>) {
    sheet.check();
    with_scratch(sheet.columns * WIDEST * 10, |scratch| {
        if sheet.pressed.is_some() {
            for_bodies!(level, simd => solve_rows_with::<_, true>(simd, sheet, stiffness, rows, scratch));
        } else {
            dispatch!(level, simd => solve_rows_with::<_, false>(simd, sheet, stiffness, rows, scratch));
        }
    });
}

#[inline(always)]
fn solve_rows_with<S: Simd, const BODIES: bool>(
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
        if let (true, Some(pressed)) = (BODIES, sheet.pressed) {
            tile.load(simd, pressed, block.pressed);
        }
        let stiffness = stiffness.of_lines(simd, row, sheet.rows);
        solve_block::<S, BODIES>(simd, block.lines(m, n), stiffness, contact, factors);
        tile.store(simd, block.position.x, sheet.position.x);
        tile.store(simd, block.position.y, sheet.position.y);
        tile.store(simd, block.position.z, sheet.position.z);
        if let (true, Some(pressed)) = (BODIES, sheet.pressed) {
            tile.store(simd, block.pressed, pressed);
        }
        row += tile.rows;
    }
}

#[inline(always)]
fn solve_block<S: Simd, const BODIES: bool>(
    simd: S,
    lines: Lines,
    (edge, bend): (Edge<S>, S::f32s),
    contact: bool,
    factors: Shared,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            if BODIES {
                line::solve::<S, _, true, PRESSED>(simd, lines, edge, bend, factors);
            } else if contact {
                line::solve::<S, _, true, TOUCHING>(simd, lines, edge, bend, factors);
            } else {
                line::solve::<S, _, true, FREE>(simd, lines, edge, bend, factors);
            }
        },
    );
}

/// Scratch in the form of columns.
pub(super) struct Block<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    pub normal: SharedPoints<'a>,
    pub pressed: Shared<'a>,
}

impl<'a> Block<'a> {
    #[inline(always)]
    pub fn new(scratch: &'a mut [f32], len: usize, width: usize) -> Self {
        let (mut parts, _) = scratch.split_at_mut(8 * len * width);
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
            pressed: next(),
        }
    }

    #[inline(always)]
    pub fn lines(&self, len: usize, width: usize) -> Lines<'a> {
        Lines {
            position: self.position,
            inv_mass: self.inv_mass,
            normal: self.normal,
            pressed: self.pressed,
            bent: self.position,
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
                let from = [self.sheet_offset + column, self.columns];
                transpose(simd, sheet, from, block, [column * n, n]);
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
                let to = [self.sheet_offset + column, self.columns];
                transpose(simd, block, [column * n, n], sheet, to);
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

/// Transposes a square of as many lines as a vector has lanes. The places are those of the first line, and how far it is to the
/// next.
#[inline(always)]
fn transpose<S: Simd>(
    simd: S,
    from: Shared,
    [at, stride]: [usize; 2],
    to: Shared,
    [to_at, to_stride]: [usize; 2],
) {
    let n = S::f32s::LEN;
    if n == WIDEST {
        let mut tile = [S::f32s::splat(simd, 0.0); WIDEST];
        for (k, vector) in tile.iter_mut().enumerate() {
            *vector = from.load(simd, at + k * stride);
        }
        for (k, vector) in interleaved(tile).into_iter().enumerate() {
            to.store::<S>(to_at + k * to_stride, vector);
        }
        return;
    }
    // By fours: AVX2 has no cheap way to interleave more.
    for k in (0..n).step_by(4) {
        for l in (0..n).step_by(4) {
            let line = |i| from.load_four(simd, at + (k + i) * stride + l);
            let tile = interleaved([line(0), line(1), line(2), line(3)]);
            for (i, vector) in tile.into_iter().enumerate() {
                to.store_four(to_at + (l + i) * to_stride + k, vector);
            }
        }
    }
}

/// Transposes a square of as many vectors as they have lanes: in each round, vector i and the one half a square further are
/// interleaved.
#[inline(always)]
fn interleaved<S: Simd, V: SimdBase<S>, const N: usize>(mut tile: [V; N]) -> [V; N] {
    let mut rounds = N;
    while rounds > 1 {
        let mut next = tile;
        for i in 0..N / 2 {
            let (low, high) = tile[i].interleave(tile[i + N / 2]);
            next[2 * i] = low;
            next[2 * i + 1] = high;
        }
        tile = next;
        rounds /= 2;
    }
    tile
}
