//! Sums over the triangles around each particle of a sheet, whose cells are cut as in `topology::grid`: cells side by side.
//!
//! Each row of particles gathers the sums of the cells below and above it. So a task writes its own rows alone, and tasks for different
//! rows may run at the same time; each computes the row of cells above its first row once more.

use std::{mem::swap, ops::Range};

use fearless_simd::Simd;

use super::lanes::{Shared, SharedPoints, V3, Window, each_window, with_scratch};

/// Quantity that is summed over triangles.
pub trait AroundParticle<S: Simd>: Copy {
    /// Values that the sum needs of a corner.
    type Corner: Copy;

    /// Loads the corners at the particles of a window, `offset` further on.
    fn corner(self, simd: S, window: Window, offset: usize) -> Self::Corner;

    /// Contribution of a triangle to each of its corners, which are counter-clockwise seen from the front.
    fn triangle(self, simd: S, corners: [Self::Corner; 3]) -> V3<S>;

    /// Takes the sum over the triangles around the particles of a window, `offset` further on.
    fn take(self, simd: S, window: Window, offset: usize, sum: V3<S>);
}

/// Size of the scratch for a sheet of so many columns.
fn scratch_of(columns: usize) -> usize {
    columns * 6 * 3
}

/// Calls `f` with the scratch for [`gather`].
pub fn with_cells<R>(columns: usize, f: impl FnOnce(&mut [f32]) -> R) -> R {
    with_scratch(scratch_of(columns), f)
}

/// Contributions of a row of cells to the row of particles on one side of it.
#[derive(Clone, Copy)]
struct Side<'a> {
    /// For particle i the contribution of cell i, 0 for the last particle.
    right: SharedPoints<'a>,
    /// For particle i the contribution of cell i − 1, 0 for the first particle.
    left: SharedPoints<'a>,
}

impl<'a> Side<'a> {
    /// Takes its arrays from scratch, filled with 0.
    #[inline(always)]
    fn take(scratch: &mut &'a mut [f32], columns: usize) -> Self {
        let mut points = || {
            let [x, y, z] = [(); 3].map(|()| {
                let (numbers, rest) = std::mem::take(scratch).split_at_mut(columns);
                *scratch = rest;
                numbers.fill(0.0);
                Shared::new(numbers)
            });
            SharedPoints { x, y, z }
        };
        Self {
            right: points(),
            left: points(),
        }
    }

    #[inline(always)]
    fn clear(self) {
        for points in [self.right, self.left] {
            for axis in [points.x, points.y, points.z] {
                (0..axis.len()).for_each(|i| axis.set(i, 0.0));
            }
        }
    }

    #[inline(always)]
    fn sum<S: Simd>(self, simd: S, window: Window) -> V3<S> {
        let right: V3<S> = self.right.load_at(simd, window, 0);
        right + self.left.load_at(simd, window, 0)
    }
}

/// Gathers the sums for a range of rows of particles. The order of summation depends neither on the range nor on the number of cells that
/// lie side by side.
#[inline(always)]
pub fn gather<S: Simd, T: AroundParticle<S>>(
    simd: S,
    [columns, rows]: [usize; 2],
    range: Range<usize>,
    what: T,
    mut scratch: &mut [f32],
) {
    let below = Side::take(&mut scratch, columns);
    let mut above = Side::take(&mut scratch, columns);
    let mut next_above = Side::take(&mut scratch, columns);
    if range.start > 0 {
        cells(simd, [columns, rows], range.start - 1, what, [below, above]);
    }
    for row in range {
        if row + 1 < rows {
            cells(simd, [columns, rows], row, what, [below, next_above]);
        } else {
            below.clear();
        }
        each_window(
            simd,
            0..columns,
            #[inline(always)]
            |window| {
                let sum = below.sum::<S>(simd, window) + above.sum(simd, window);
                what.take(simd, window, row * columns, sum);
            },
        );
        swap(&mut above, &mut next_above);
    }
}

/// Adds a row of cells to two rows of sums: of the particles above the cells (which lie below these) and of the particles under them.
#[inline(always)]
fn cells<S: Simd, T: AroundParticle<S>>(
    simd: S,
    [columns, rows]: [usize; 2],
    row: usize,
    what: T,
    [upper, lower]: [Side; 2],
) {
    let at = row * columns;
    // Up to the middle the diagonals of the upper half fall to the right, those of the lower half rise.
    let middle = columns / 2;
    let top = 2 * row < rows - 1;
    for (cells, left) in [(0..middle, true), (middle..columns - 1, false)] {
        let falling = left == top;
        each_window(
            simd,
            cells,
            #[inline(always)]
            |window| {
                let corner = |offset| what.corner(simd, window, at + offset);
                let (tl, tr) = (corner(0), corner(1));
                let (bl, br) = (corner(columns), corner(columns + 1));
                let (first, second) = if falling {
                    let first = what.triangle(simd, [tl, bl, br]);
                    (first, what.triangle(simd, [tl, br, tr]))
                } else {
                    let first = what.triangle(simd, [tl, bl, tr]);
                    (first, what.triangle(simd, [tr, bl, br]))
                };
                let both = first + second;
                let of_corners = if falling {
                    [both, second, first, both]
                } else {
                    [first, both, both, second]
                };
                let [for_tl, for_tr, for_bl, for_br] = of_corners;
                upper.right.store_at(simd, window, 0, for_tl);
                upper.left.store_at(simd, window, 1, for_tr);
                lower.right.store_at(simd, window, 0, for_bl);
                lower.left.store_at(simd, window, 1, for_br);
            },
        );
    }
}
