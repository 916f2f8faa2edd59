//! Tethers: no particle gets further from a pin than the shortest path along the sheet.
//!
//! The correction of a chain in a pass is a Newton step, exact for small strains alone. A sheet that falls into two pins has large strains
//! there; tethers remove them at once, whatever the number of edges between (Kim, Chentanez, Müller 2012).

use std::ops::Range;

use bevy_math::{Vec2, Vec3};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, Reading, V3, Window, each_window, lane_numbers};
use super::{lattice::Sheet, recovery::Recovery};

/// A pin, and the largest distance of each particle from it.
#[derive(Clone, Copy)]
pub struct Tether<W> {
    /// Position of the pin \[m\].
    pub anchor: Vec3,
    /// Position of the pin at the start of the substep \[m\].
    pub anchor_before: Vec3,
    /// Factor of the lengths [-]: above 1 where pins are further apart than the sheet between them is long.
    pub longer: f32,
    /// Largest distance of each particle from the pin.
    pub distances: W,
}

/// Distances along a sheet that is flat at rest: straight lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight {
    /// Column of the pin.
    pub column: u32,
    /// Row of the pin.
    pub row: u32,
    /// Spacing of columns and of rows \[m\].
    pub spacing: Vec2,
}

impl Straight {
    /// Distance of a particle \[m\].
    pub fn length(self, column: u32, row: u32) -> f32 {
        let cells = [column.abs_diff(self.column), row.abs_diff(self.row)];
        (Vec2::from(cells.map(|n| n as f32)) * self.spacing).length()
    }
}

/// Pulls the free particles of a range back to where their tethers, `slack` times as long as at rest, are taut. Tethers have one length for
/// each particle \[m\].
pub fn solve(
    level: Level,
    sheet: Sheet,
    tethers: &[Option<Tether<Reading>>],
    (slack, recovery): (f32, Option<Recovery>),
    particles: Range<usize>,
) {
    sheet.check();
    dispatch!(level, simd => {
        each_window(
            simd,
            particles.clone(),
            #[inline(always)]
            |window| {
                pull(
                    simd,
                    sheet,
                    (tethers, recovery),
                    window,
                    0,
                    #[inline(always)]
                    |lengths, longer| {
                        let length = lengths.load_at(simd, window) * (slack * longer);
                        length * length
                    },
                );
            },
        );
    });
}

/// Pulls the free particles of a range of rows back to where their tethers, `slack` times as long as at rest, are taut.
pub fn solve_straight(
    level: Level,
    sheet: Sheet,
    tethers: &[Option<Tether<Straight>>],
    (slack, recovery): (f32, Option<Recovery>),
    rows: Range<usize>,
) {
    sheet.check();
    dispatch!(level, simd => {
        for row in rows {
            each_window(
                simd,
                0..sheet.columns,
                #[inline(always)]
                |window| {
                    pull(
                        simd,
                        sheet,
                        (tethers, recovery),
                        window,
                        row * sheet.columns,
                        #[inline(always)]
                        |distances, longer| {
                            let [dx, dy] = (distances.spacing * (slack * longer)).to_array();
                            let along = dy * (row as f32 - distances.row as f32);
                            let first = window.at as f32 - distances.column as f32;
                            let across = (lane_numbers(simd) + first) * dx;
                            across * across + along * along
                        },
                    );
                },
            );
        }
    });
}

/// Pulls the particles of a window, from `first` on. `l2` computes the squares of the largest distances.
///
/// A particle that is too far away already when the substep begins comes back no faster than the [`Recovery`] allows, where there is one,
/// and a particle in contact moves along the surface alone.
#[inline(always)]
fn pull<S: Simd, W: Copy>(
    simd: S,
    sheet: Sheet,
    (tethers, recovery): (&[Option<Tether<W>>], Option<Recovery>),
    window: Window,
    first: usize,
    l2: impl Fn(W, f32) -> S::f32s,
) {
    let zero = S::f32s::splat(simd, 0.0);
    let start: V3<S> = sheet.position.load_at(simd, window, first);
    let mut p = start;
    let mut taut = false;
    for tether in tethers.iter().flatten() {
        // Lanes beyond a short window have no effect: they are not stored.
        let mut l2 = l2(tether.distances, tether.longer);
        let d = p - V3::splat(simd, tether.anchor);
        let q = d.dot(d);
        let beyond = q.simd_gt(l2);
        if beyond.any_true() {
            taut = true;
            if let Some(recovery) = recovery {
                let before: V3<S> = recovery.start.load_at(simd, window, first);
                let before = before - V3::splat(simd, tether.anchor_before);
                l2 = recovery.target::<S>(before.dot(before), l2);
            }
            let excess = (q - l2).max(zero);
            let s = (excess + excess) / (q * 3.0 + l2);
            p = p - Factor(beyond.select(s, zero)) * d;
        }
    }
    if taut {
        if let (Some(normal), None) = (sheet.normal, sheet.pressed) {
            let n: V3<S> = normal.load_at(simd, window, first);
            p = p - Factor(n.dot(p - start)) * n;
        }
        let w = sheet.inv_mass.load_at(simd, window, first);
        let free = w.simd_gt(zero);
        sheet
            .position
            .store_at(simd, window, first, p.select(free, start));
    }
}
