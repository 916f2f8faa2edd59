//! Tethers: no particle gets further from a pin than the way along the sheet.
//!
//! What a chain corrects in a pass is a Newton step, exact for small strains alone. A sheet that falls into two pins sees large
//! ones there; tethers take them away at once, whatever the number of edges between (Kim, Chentanez, Müller 2012).

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, Reading, Shared, SharedPoints, V3, each_window};
use super::lattice::Sheet;

/// A pin, and how far each particle gets from it.
#[derive(Clone, Copy)]
pub(crate) struct Tether<'a> {
    /// Where the pin is \[m\].
    pub anchor: Vec3,
    /// The way along the sheet at rest, for each particle \[m\].
    pub lengths: Reading<'a>,
}

/// Pulls the free particles of a range back to where their tethers, `slack` times as long as at rest, are taut.
pub(crate) fn solve(
    level: Level,
    sheet: Sheet,
    tethers: &[Option<Tether>],
    slack: f32,
    particles: Range<usize>,
) {
    sheet.check();
    dispatch!(level, simd => solve_with(simd, sheet.position, sheet.inv_mass, tethers, slack, particles));
}

#[inline(always)]
fn solve_with<S: Simd>(
    simd: S,
    position: SharedPoints,
    inv_mass: Shared,
    tethers: &[Option<Tether>],
    slack: f32,
    particles: Range<usize>,
) {
    let zero = S::f32s::splat(simd, 0.0);
    each_window(
        simd,
        particles.clone(),
        #[inline(always)]
        |window| {
            let start: V3<S> = position.load_at(simd, window, 0);
            let mut p = start;
            let mut taut = false;
            for tether in tethers.iter().flatten() {
                let length = tether.lengths.load_at(simd, window) * slack;
                // Lanes of a short window are 0, and so is their length: nothing comes of them.
                let d = p - V3::splat(simd, tether.anchor);
                let (q, l2) = (d.dot(d), length * length);
                let beyond = q.simd_gt(l2);
                if beyond.any_true() {
                    taut = true;
                    let excess = q - l2;
                    let s = (excess + excess) / (q * 3.0 + l2);
                    p = p - Factor(beyond.select(s, zero)) * d;
                }
            }
            if taut {
                let free = inv_mass.load_at(simd, window, 0).simd_gt(zero);
                position.store_at(simd, window, 0, p.select(free, start));
            }
        },
    );
}
