//! The constraints of a sheet of columns × rows particles, in the form that the vector kernels want.
//!
//! Columns lie side by side in memory and are solved where they are. Rows are transposed, a block of them at a time, into
//! scratch that has the form of columns, solved by the same kernel, and transposed back.
//!
//! ```text
//!            column 0     1     2     3     4        particle = row · columns + column
//!
//!     row 0         o─────o─────o─────o─────o        ─ edges of a row, │ edges of a column
//!                   │ ╲ ╱ │ ╲ ╱ │ ╲ ╱ │ ╲ ╱ │
//!                   │  ╳  │  ╳  │  ╳  │  ╳  │        ╲ ╱ both diagonals of a cell (`shear`)
//!                   │ ╱ ╲ │ ╱ ╲ │ ╱ ╲ │ ╱ ╲ │
//!     row 1         o─────o─────o─────o─────o
//!                   │ ╲ ╱ │ ╲ ╱ │ ╲ ╱ │ ╲ ╱ │
//!
//!     n rows of the sheet                  block of scratch, n lanes
//!
//!     row 0    a0 a1 a2 a3 │ a4            link 0    a0 b0 c0 d0
//!     row 1    b0 b1 b2 b3 │ b4            link 1    a1 b1 c1 d1        lane = row, link = column
//!     row 2    c0 c1 c2 c3 │ c4     ⇄      link 2    a2 b2 c2 d2
//!     row 3    d0 d1 d2 d3 │ d4            link 3    a3 b3 c3 d3
//!              ╰─  tile  ─╯                link 4    a4 b4 c4 d4
//! ```
//!
//! A square tile of n × n numbers is transposed in registers; the columns that remain on the right, fewer than n, are moved one by one
//! (`tile`).

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    bend,
    edges::{Edge, LineStiffness, Whole},
    edges::{LineLengths, SheetLines},
    lanes::{Shared, SharedPoints, V3, WIDEST, Window, with_scratch},
    line,
    lines::{FREE, Give, Lines, PRESSED, TOUCHING},
    tile::Tile,
};
use crate::instruction_set::for_few;

/// Particles of a sheet, in row-major order.
#[derive(Clone, Copy)]
pub struct Sheet<'a> {
    pub columns: usize,
    pub rows: usize,
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 for particles without contact; `None` where nothing is in contact.
    pub normal: Option<SharedPoints<'a>>,
    /// Sums of the impulses on particles along their normals.
    pub pressed: Option<Shared<'a>>,
    /// Limits of compliance and tension.
    pub give: Give,
    /// Prescribed lengths of the edges where they differ from those at rest; `None` where the sheet carries bodies.
    pub lengths: Option<Lengths<'a>>,
}

/// Prescribed lengths of the edges of a sheet, each at the edge's first particle \[m\].
#[derive(Clone, Copy)]
pub struct Lengths<'a> {
    /// Edges along rows: to the next particle.
    pub rows: Shared<'a>,
    /// Edges along columns: to the particle of the next row.
    pub columns: Shared<'a>,
    /// Both diagonals of the cell.
    pub diagonals: Shared<'a>,
}

impl Sheet<'_> {
    /// Checks that there are columns × rows particles in each array.
    ///
    /// # Panics
    /// When there are not.
    #[inline(always)]
    pub fn check(&self) {
        let n = self.columns * self.rows;
        // Particles that are split off the sheet follow those of its columns and rows.
        assert!(
            self.position.has(n)
                && self.inv_mass.len() >= n
                && self.normal.is_none_or(|normal| normal.has(n))
                && self.pressed.is_none_or(|pressed| pressed.len() >= n)
                && self.lengths.is_none_or(|lengths| lengths.are_of(n)),
            "a sheet of {} x {} particles",
            self.columns,
            self.rows
        );
    }
}

impl Lengths<'_> {
    #[inline(always)]
    fn are_of(&self, n: usize) -> bool {
        [self.rows, self.columns, self.diagonals].map(Shared::len) == [n; 3]
    }
}

/// Kinds of a sheet: a plain one, one that carries bodies, one whose prescribed edge lengths differ from those at rest.
const PLAIN: u8 = 0;
const BODIES: u8 = 1;
const GRANTED: u8 = 2;

/// Size of the scratch of lines, for each particle and lane: a block, the factors of edges and those of bending.
const SCRATCH: usize = 11 + 2 + bend::Factors::SIZE;

/// Solves each column of a range.
pub fn solve_columns(level: Level, sheet: Sheet, stiffness: LineStiffness, columns: Range<usize>) {
    sheet.check();
    with_scratch(sheet.rows * WIDEST * SCRATCH, |scratch| {
        if sheet.pressed.is_some() {
            for_few!(level, simd => solve_columns_with::<_, BODIES>(simd, sheet, stiffness, columns, scratch));
        } else if sheet.lengths.is_some() {
            for_few!(level, simd => solve_columns_with::<_, GRANTED>(simd, sheet, stiffness, columns, scratch));
        } else {
            dispatch!(level, simd => solve_columns_with::<_, PLAIN>(simd, sheet, stiffness, columns, scratch));
        }
    });
}

#[inline(always)]
fn solve_columns_with<S: Simd, const KIND: u8>(
    simd: S,
    sheet: Sheet,
    stiffness: LineStiffness,
    columns: Range<usize>,
    scratch: &mut [f32],
) {
    let (m, n) = (sheet.rows, S::f32s::LEN);
    let how = [stiffness.bend.is_finite(), sheet.normal.is_some()];
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let (of_bending, rest) = rest.split_at_mut(bend::Factors::SIZE * m * n);
    let mut of_bending = bend::Factors::new(of_bending, m, n);
    let block = Block::new(rest, m, n);
    let mut lines = Lines {
        position: sheet.position,
        inv_mass: sheet.inv_mass,
        normal: sheet.normal.unwrap_or(sheet.position),
        pressed: sheet.pressed.unwrap_or(sheet.inv_mass),
        shared: block.shared,
        give: sheet.give,
        offset: columns.start,
        stride: sheet.columns,
        len: m,
    };
    let of_lines = |first| stiffness.of_lines(simd, first, sheet.columns);
    while lines.offset + n <= columns.end {
        let lengths = sheet
            .lengths
            .map_or(block.pressed, |lengths| lengths.columns);
        let lengths = LineLengths {
            lengths,
            at: lines.offset,
            stride: sheet.columns,
        };
        solve_block::<S, KIND>(
            simd,
            lines,
            of_lines(lines.offset),
            lengths,
            how,
            factors,
            &mut of_bending,
        );
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
        if let (true, Some(pressed)) = (KIND == BODIES, sheet.pressed) {
            let sum = pressed.load_at(simd, window, from);
            block.pressed.store::<S>(k * n, sum);
        }
        if let (true, Some(lengths)) = (KIND == GRANTED, sheet.lengths) {
            let length = lengths.columns.load_at(simd, window, from);
            block.pressed.store::<S>(k * n, length);
        }
    }
    let stiffness = of_lines(lines.offset);
    solve_block::<S, KIND>(
        simd,
        block.lines(m, n, sheet.give),
        stiffness,
        block.lengths(n),
        how,
        factors,
        &mut of_bending,
    );
    for k in 0..m {
        let p: V3<S> = block.position.load(simd, k * n);
        let to = lines.offset + k * sheet.columns;
        sheet.position.store_at(simd, window, to, p);
        if let (true, Some(pressed)) = (KIND == BODIES, sheet.pressed) {
            let sum = block.pressed.load(simd, k * n);
            pressed.store_at::<S>(simd, window, to, sum);
        }
    }
}

/// Solves each row of a range.
pub fn solve_rows(level: Level, sheet: Sheet, stiffness: LineStiffness, rows: Range<usize>) {
    sheet.check();
    with_scratch(sheet.columns * WIDEST * SCRATCH, |scratch| {
        if sheet.pressed.is_some() {
            for_few!(level, simd => solve_rows_with::<_, BODIES>(simd, sheet, stiffness, rows, scratch));
        } else if sheet.lengths.is_some() {
            for_few!(level, simd => solve_rows_with::<_, GRANTED>(simd, sheet, stiffness, rows, scratch));
        } else {
            dispatch!(level, simd => solve_rows_with::<_, PLAIN>(simd, sheet, stiffness, rows, scratch));
        }
    });
}

#[inline(always)]
fn solve_rows_with<S: Simd, const KIND: u8>(
    simd: S,
    sheet: Sheet,
    stiffness: LineStiffness,
    rows: Range<usize>,
    scratch: &mut [f32],
) {
    let (m, n) = (sheet.columns, S::f32s::LEN);
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let (of_bending, rest) = rest.split_at_mut(bend::Factors::SIZE * m * n);
    let mut of_bending = bend::Factors::new(of_bending, m, n);
    let block = Block::new(rest, m, n);
    let how = [stiffness.bend.is_finite(), sheet.normal.is_some()];
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
        if let (true, Some(pressed)) = (KIND == BODIES, sheet.pressed) {
            tile.load(simd, pressed, block.pressed);
        }
        if let (true, Some(lengths)) = (KIND == GRANTED, sheet.lengths) {
            tile.load(simd, lengths.rows, block.pressed);
        }
        let stiffness = stiffness.of_lines(simd, row, sheet.rows);
        solve_block::<S, KIND>(
            simd,
            block.lines(m, n, sheet.give),
            stiffness,
            block.lengths(n),
            how,
            factors,
            &mut of_bending,
        );
        tile.store(simd, block.position.x, sheet.position.x);
        tile.store(simd, block.position.y, sheet.position.y);
        tile.store(simd, block.position.z, sheet.position.z);
        if let (true, Some(pressed)) = (KIND == BODIES, sheet.pressed) {
            tile.store(simd, block.pressed, pressed);
        }
        row += tile.rows;
    }
}

#[inline(always)]
fn solve_block<S: Simd, const KIND: u8>(
    simd: S,
    lines: Lines,
    (edge, whole): (Edge<S>, Whole<S>),
    lengths: LineLengths,
    [bends, contact]: [bool; 2],
    factors: Shared,
    of_bending: &mut bend::Factors,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            if bends {
                bend::solve(simd, lines, whole, of_bending);
            }
            if KIND == BODIES {
                line::solve::<S, _, PRESSED>(simd, lines, edge, whole.bears, factors);
            } else if KIND == GRANTED {
                let edges = SheetLines { edge, lengths };
                if contact {
                    line::solve::<S, _, TOUCHING>(simd, lines, edges, whole.bears, factors);
                } else {
                    line::solve::<S, _, FREE>(simd, lines, edges, whole.bears, factors);
                }
            } else if contact {
                line::solve::<S, _, TOUCHING>(simd, lines, edge, whole.bears, factors);
            } else {
                line::solve::<S, _, FREE>(simd, lines, edge, whole.bears, factors);
            }
        },
    );
}

/// Scratch in the form of columns.
pub(super) struct Block<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    pub normal: SharedPoints<'a>,
    /// Impulses along normals of a sheet that carries bodies; prescribed edge lengths of a sheet where these differ from those at rest.
    pub pressed: Shared<'a>,
    pub shared: SharedPoints<'a>,
}

impl<'a> Block<'a> {
    #[inline(always)]
    pub fn new(scratch: &'a mut [f32], len: usize, width: usize) -> Self {
        let (mut parts, _) = scratch.split_at_mut(11 * len * width);
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
        let [position, normal, shared] = [points(), points(), points()];
        Self {
            position,
            normal,
            inv_mass: next(),
            pressed: next(),
            shared,
        }
    }

    #[inline(always)]
    fn lengths(&self, width: usize) -> LineLengths<'a> {
        LineLengths {
            lengths: self.pressed,
            at: 0,
            stride: width,
        }
    }

    #[inline(always)]
    pub fn lines(&self, len: usize, width: usize, give: Give) -> Lines<'a> {
        Lines {
            position: self.position,
            inv_mass: self.inv_mass,
            normal: self.normal,
            pressed: self.pressed,
            shared: self.shared,
            give,
            offset: 0,
            stride: width,
            len,
        }
    }
}

#[cfg(test)]
#[path = "lattice_tests.rs"]
mod tests;
