//! Rows as columns: squares of numbers are transposed in registers.

use fearless_simd::{Simd, prelude::*};

use super::lanes::{Shared, WIDEST};

/// Up to as many rows as a vector has lanes, and their place as columns of a block.
#[derive(Clone, Copy)]
pub(super) struct Tile {
    pub sheet_offset: usize,
    pub rows: usize,
    pub columns: usize,
}

impl Tile {
    /// Transposes rows of the sheet to columns of the block. Lanes without a row get 0.
    #[inline(always)]
    pub fn load<S: Simd>(self, simd: S, sheet: Shared, block: Shared) {
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
    pub fn store<S: Simd>(self, simd: S, block: Shared, sheet: Shared) {
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

/// Transposes a square of as many lines as a vector has lanes. `at` and `to_at` are the places of the first line, `stride` and `to_stride`
/// the steps to the next.
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

/// Transposes a square of as many vectors as they have lanes: in each round, vector i and vector i + N/2 are interleaved.
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

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::kernels::lanes::levels;

    /// Rows of a sheet as columns of a block, and the same rows of a sheet of which nothing else is known.
    #[inline(always)]
    fn there_and_back<S: Simd>(simd: S, rows: usize, columns: usize) {
        let n = S::f32s::LEN;
        let rows = rows.min(n);
        let tile = Tile {
            sheet_offset: 2 * columns,
            rows,
            columns,
        };
        let mut sheet: Vec<f32> = (0..(rows + 3) * columns).map(|i| i as f32).collect();
        let mut block = vec![-1.0; columns * n];
        let mut back = vec![-1.0; sheet.len()];
        tile.load(simd, Shared::new(&mut sheet), Shared::new(&mut block));
        for (i, is) in block.iter().enumerate() {
            let (column, row) = (i / n, i % n);
            let wanted = if row < rows {
                sheet[(row + 2) * columns + column]
            } else {
                0.0
            };
            assert_eq!(*is, wanted);
        }
        tile.store(simd, Shared::new(&mut block), Shared::new(&mut back));
        for (i, is) in back.into_iter().enumerate() {
            let here = (2..rows + 2).contains(&(i / columns));
            assert_eq!(is, if here { sheet[i] } else { -1.0 });
        }
    }

    #[test]
    fn rows_become_columns_and_rows_again() {
        for level in levels() {
            for (rows, columns) in (1..=WIDEST).flat_map(|rows| (1..40).map(move |c| (rows, c))) {
                dispatch!(level, simd => there_and_back(simd, rows, columns));
            }
        }
    }
}
