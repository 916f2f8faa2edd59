//! Internal viscosity of a sheet, which damps its trembling at rest, and inertia in the same sweep over its rows.
//!
//! One pass over rows, columns, diagonals and contacts never agrees with itself exactly, so that at rest the parts push against each other.
//! Friction inside the fabric removes that motion: neighbours along rows and columns exchange momentum in proportion to the difference of
//! their velocities, Δv_i = w_i κ Σ_j (v_j − v_i), after the rigid motion of the whole was subtracted: a sheet that swings or turns as one
//! is not slowed.
//!
//! In a sheet of mass m₀ for each particle κ = c m₀/4, so that c is the part by which a particle comes nearer to the mean of its
//! neighbours.
//!
//! The velocities of three rows are kept; when those of row r + 1 are known, row r is moved (see [`super::verlet`]), so that all values of
//! a particle are read and written once.
//!
//! # Several threads
//!
//! Blocks of rows can be moved at the same time. Each needs the velocities of the row above it and the row below it, as they were before
//! any block moved, so there are two phases: first [`SheetMotion::save_row`] saves the velocities of the first and the last row of every block,
//! and when all are saved, [`SheetMotion::sweep`] moves each block, with the saved rows of its neighbours. One block of all rows needs no first
//! phase.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Factor, Shared, SharedPoints, V3, WIDEST, each_window, with_scratch},
    lattice::Sheet,
    rigid_motion::RigidMotion,
    verlet::Verlet,
};
use crate::points::Points;

/// Largest `c`: a corner, which has a quarter of the mass and half of the neighbours, then gets the velocity of its neighbours, and no
/// more.
pub const LARGEST: f32 = 0.5;

/// Number of rows of velocities that are kept at a time: three are needed.
const KEPT: usize = 3;

/// A substep of a sheet without its constraints: inertia and viscosity.
#[derive(Clone, Copy)]
pub struct SheetMotion<'a> {
    pub sheet: Sheet<'a>,
    /// Positions a substep before \[m\].
    pub previous: SharedPoints<'a>,
    /// Rounding error of the displacement of the substep before \[m\].
    pub lost: SharedPoints<'a>,
    /// Acceleration in addition to gravity [m/s²].
    pub acceleration: Option<&'a Points>,
    /// κ \[kg\].
    pub conductance: f32,
    /// Rigid motion of the whole, which viscosity does not slow.
    pub rigid: RigidMotion,
    pub verlet: Verlet,
}

/// Velocities of the rows above and below a block, from [`SheetMotion::save_row`]; `None` at the border of the sheet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside<'a> {
    pub above: Option<&'a [f32]>,
    pub below: Option<&'a [f32]>,
}

impl SheetMotion<'_> {
    /// Checks that each array has one element for each particle.
    ///
    /// # Panics
    /// When one has not.
    fn check(&self) {
        self.sheet.check();
        let n = self.sheet.columns * self.sheet.rows;
        let all = self.previous.has(n) && self.lost.has(n);
        assert!(
            all && self.acceleration.is_none_or(|a| a.has(n)),
            "one of each for {n} particles"
        );
    }

    /// Number of values that [`Self::save_row`] writes.
    pub fn saved_len(&self) -> usize {
        3 * self.stride()
    }

    /// Step from one axis of a row of velocities to the next.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.sheet.columns + 2 * WIDEST
    }

    /// Saves the velocities of a row for the blocks beside it.
    pub fn save_row(self, level: Level, row: usize, saved: &mut [f32]) {
        self.check();
        assert_eq!(saved.len(), self.saved_len(), "a row of velocities");
        let saved = Row {
            scratch: Shared::new(saved),
            at: WIDEST,
            stride: self.stride(),
        };
        dispatch!(level, simd => self.velocities(simd, row, saved));
    }

    /// Lets the neighbours of a block of rows exchange momentum, and moves its free particles (`inv_mass` > 0): see
    /// [`Verlet::step`].
    pub fn sweep(self, level: Level, rows: Range<usize>, beside: Beside) {
        self.check();
        let fits = |row: &[f32]| row.len() == self.saved_len();
        assert!(
            beside.above.is_none_or(fits) && beside.below.is_none_or(fits),
            "rows of velocities"
        );
        with_scratch(self.saved_len() * KEPT, |scratch| {
            let scratch = Shared::new(scratch);
            dispatch!(level, simd => self.sweep_with(simd, rows, beside, scratch));
        });
    }

    /// Computes the velocities of a row, less the rigid motion, times the length of the substep.
    #[inline(always)]
    fn velocities<S: Simd>(self, simd: S, r: usize, row: Row) {
        let at_origin: V3<S> = V3::splat(simd, self.rigid.at_origin());
        let rotation = V3::splat(simd, self.rigid.rotation);
        let first = r * self.sheet.columns;
        each_window(
            simd,
            0..self.sheet.columns,
            #[inline(always)]
            |window| {
                let x: V3<S> = self.sheet.position.load_at(simd, window, first);
                let v = x - self.previous.load_at(simd, window, first);
                row.store(window.at, v - (rotation.cross(x) + at_origin));
            },
        );
        row.extend(self.sheet.columns);
    }

    #[inline(always)]
    fn sweep_with<S: Simd>(self, simd: S, rows: Range<usize>, beside: Beside, scratch: Shared) {
        let stride = self.stride();
        let row_of = |r: usize| Row {
            scratch,
            at: (r % KEPT) * 3 * stride + WIDEST,
            stride,
        };
        // Row r − 1 uses the scratch of row r + 2.
        if let Some(above) = beside.above {
            row_of(rows.start + KEPT - 1).copy_from(above);
        }
        for r in rows.start..=rows.end {
            if r < rows.end {
                self.velocities(simd, r, row_of(r));
            } else if let Some(below) = beside.below {
                row_of(r).copy_from(below);
            }
            if r == rows.start {
                continue;
            }
            // At a border the missing neighbour has the velocity of the particle itself.
            let here = r - 1;
            let above = if here == rows.start && beside.above.is_none() {
                here
            } else {
                here + KEPT - 1
            };
            let below = if r == rows.end && beside.below.is_none() {
                here
            } else {
                r
            };
            self.move_row(simd, here, [above, here, below].map(row_of));
        }
    }

    #[inline(always)]
    fn move_row<S: Simd>(self, simd: S, r: usize, [above, here, below]: [Row; 3]) {
        let zero = S::f32s::splat(simd, 0.0);
        let nothing = V3::splat(simd, bevy_math::Vec3::ZERO);
        let h2 = self.verlet.seconds * self.verlet.seconds;
        let fall = V3::splat(simd, self.verlet.gravity * h2);
        let kept = Factor(S::f32s::splat(simd, self.verlet.kept()));
        let (four, h2) = (S::f32s::splat(simd, 4.0), S::f32s::splat(simd, h2));
        let first = r * self.sheet.columns;
        each_window(
            simd,
            0..self.sheet.columns,
            #[inline(always)]
            |window| {
                let i = window.at;
                let v: V3<S> = here.load(simd, i);
                let beside = here.load_left(simd, i) + here.load(simd, i + 1);
                let around = (above.load(simd, i) + below.load(simd, i)) + beside;
                let w = self.sheet.inv_mass.load_at(simd, window, first);
                let change = Factor(w * self.conductance) * (around - Factor(four) * v);

                let now: V3<S> = self.sheet.position.load_at(simd, window, first);
                let before = self.previous.load_at(simd, window, first);
                let lost = self.lost.load_at(simd, window, first);
                let mut displacement = kept * ((now - before) + lost + change) + fall;
                if let Some(acceleration) = self.acceleration {
                    displacement =
                        displacement + Factor(h2) * acceleration.window(simd, window, first);
                }
                let free = w.simd_gt(zero);
                let displacement = displacement.select(free, nothing);
                let next = now + displacement;
                self.sheet.position.store_at(simd, window, first, next);
                self.lost
                    .store_at(simd, window, first, displacement - (next - now));
                self.previous
                    .store_at(simd, window, first, now.select(free, before));
            },
        );
    }
}

/// A row of vectors in scratch, with room on both sides.
#[derive(Clone, Copy)]
struct Row<'a> {
    scratch: Shared<'a>,
    at: usize,
    stride: usize,
}

impl Row<'_> {
    #[inline(always)]
    fn load<S: Simd>(self, simd: S, i: usize) -> V3<S> {
        self.load_from(simd, self.at + i)
    }

    /// Loads the left neighbour of each vector.
    #[inline(always)]
    fn load_left<S: Simd>(self, simd: S, i: usize) -> V3<S> {
        self.load_from(simd, self.at + i - 1)
    }

    #[inline(always)]
    fn load_from<S: Simd>(self, simd: S, at: usize) -> V3<S> {
        V3 {
            x: self.scratch.load(simd, at),
            y: self.scratch.load(simd, at + self.stride),
            z: self.scratch.load(simd, at + 2 * self.stride),
        }
    }

    #[inline(always)]
    fn store<S: Simd>(self, i: usize, value: V3<S>) {
        let at = self.at + i;
        self.scratch.store::<S>(at, value.x);
        self.scratch.store::<S>(at + self.stride, value.y);
        self.scratch.store::<S>(at + 2 * self.stride, value.z);
    }

    /// Copies the first and the last of `len` vectors to the places beside them.
    #[inline(always)]
    fn extend(self, len: usize) {
        for axis in 0..3 {
            let first = self.at + axis * self.stride;
            self.scratch.set(first - 1, self.scratch.get(first));
            self.scratch
                .set(first + len, self.scratch.get(first + len - 1));
        }
    }

    /// Copies a saved row, with the places beside it.
    fn copy_from(self, saved: &[f32]) {
        for (i, value) in saved.iter().enumerate() {
            self.scratch.set(self.at - WIDEST + i, *value);
        }
    }
}
