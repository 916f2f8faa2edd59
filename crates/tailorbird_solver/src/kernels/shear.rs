//! The diagonals of the cells of a sheet.
//!
//! Each is projected by itself, without a square root: s = 2 (q − L²)/(3 q + L²) is 1 − L/|d| to second order around rest, and never more
//! than that. The cells of one pair of rows share no particle with the cells of the next pair but one, so there are two kinds of pairs:
//! even ones (0 and 1, 2 and 3, …), which come first, and odd ones (1 and 2, …).
//!
//! # Several threads
//!
//! Blocks of rows that start at even rows can be solved at the same time by [`solve`], which leaves out the pair whose lower row belongs to
//! the next block. When all blocks are done, [`solve_seam`] does these pairs, again all at the same time. The order in which a particle is
//! moved, and so the result, is the same for any blocks.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Factor, V3, each_window},
    lattice::Sheet,
};

/// Stiffness of the diagonals of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// L \[m\].
    pub rest_length: f32,
    /// α̃ = α/h² [1/kg].
    pub alpha_tilde: f32,
    /// True if the diagonals that rise to the right come first.
    pub rising_first: bool,
}

/// Projects both diagonals of the cells whose four corners are in a range of rows, the first of which has an even number.
pub fn solve(level: Level, sheet: Sheet, shear: Shear, rows: Range<usize>) {
    sheet.check();
    debug_assert!(rows.start.is_multiple_of(2), "blocks start at even rows");
    dispatch!(level, simd => solve_with(simd, sheet, shear, rows));
}

/// Projects both diagonals of the cells between a row, the last one of a block, and the next one.
pub fn solve_seam(level: Level, sheet: Sheet, shear: Shear, row: usize) {
    sheet.check();
    dispatch!(level, simd => {
        for rising in [shear.rising_first, !shear.rising_first] {
            diagonals(simd, sheet, shear, row..row + 2, rising);
        }
    });
}

/// Projects the even pairs, and each odd pair right after the even one before it, while both are in the cache. The two directions of a pair
/// take turns with those of the other pair: a vector that was just stored in two parts is loaded only when it has reached the cache.
#[inline(always)]
fn solve_with<S: Simd>(simd: S, sheet: Sheet, shear: Shear, rows: Range<usize>) {
    for even in (rows.start..rows.end + 3).step_by(2) {
        for rising in [shear.rising_first, !shear.rising_first] {
            if even + 1 < rows.end {
                diagonals(simd, sheet, shear, even..even + 2, rising);
            }
            if even >= rows.start + 3 && even - 2 < rows.end {
                diagonals(simd, sheet, shear, even - 3..even - 1, rising);
            }
        }
    }
}

/// Projects the springs of one direction in the cells between two rows.
#[inline(always)]
fn diagonals<S: Simd>(simd: S, sheet: Sheet, shear: Shear, rows: Range<usize>, rising: bool) {
    let (upper, lower) = (rows.start * sheet.columns, (rows.end - 1) * sheet.columns);
    // From `a + j` to `b + j` for each cell j.
    let (a, b) = if rising {
        (upper + 1, lower)
    } else {
        (upper, lower + 1)
    };
    let at_rest = S::f32s::splat(simd, shear.rest_length * shear.rest_length);
    let alpha = S::f32s::splat(simd, shear.alpha_tilde + 1e-30);
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
            let l2 = sheet.lengths.map_or(at_rest, |lengths| {
                let length = lengths.diagonals.load_at(simd, window, upper);
                length * length
            });
            let d = p_b - p_a;
            let q = d.dot(d);
            let excess = q - l2;
            // As for bending: see `line`.
            let w = w_a + w_b;
            let w = (w * 0.5 + alpha).max(w);
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
