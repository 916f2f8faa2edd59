//! Internal viscosity of a sheet: what quiets the simmer.
//!
//! One pass over rows, columns, diagonals and contacts never agrees with itself exactly, so that at rest the parts push against
//! each other. Friction inside the fabric takes that away: neighbours along rows and columns exchange momentum in proportion
//! to the difference of their velocities, Δv_i = w_i κ Σ_j (v_j − v_i), after the rigid motion of the whole was subtracted: a
//! sheet that swings or turns as one is not slowed.
//!
//! In a sheet of mass m₀ for each particle κ = c m₀/4, so that c is the part by which a particle comes nearer to the mean of
//! its neighbours.

#![expect(clippy::doc_markdown, reason = "formulas")]

use bevy_math::{DMat3, DVec3, Vec3};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Factor, Shared, SharedPoints, V3, WIDEST, each_window, with_scratch},
    lattice::Sheet,
};
use crate::points::Points;

/// The largest `c`: a corner, which has a quarter of the mass and half of the neighbours, then comes to where its neighbours
/// are, and no further.
pub const LARGEST: f32 = 0.5;

/// Rows of velocities that are kept at a time: three are needed.
const KEPT: usize = 3;

/// A rigid motion during a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// Centre of mass \[m\].
    pub center: Vec3,
    /// What the centre moves by \[m\].
    pub displacement: Vec3,
    /// What the whole turns by: axis times angle \[rad\].
    pub rotation: Vec3,
}

/// How many particles a rigid motion is measured by, at least.
const SAMPLES: usize = 256;

impl RigidMotion {
    /// The rigid motion that has the linear and the angular momentum of these particles, of which it takes a sample.
    /// Without rotation where they lie in a line.
    pub fn fit(mass: &[f32], position: &Points, previous: &Points) -> Self {
        // Odd, so that the sample is not one column of a sheet.
        let every = (mass.len() / SAMPLES) | 1;
        let sample = || {
            (0..mass.len()).step_by(every).map(|i| {
                let x = position.get(i).as_dvec3();
                (f64::from(mass[i]), x, x - previous.get(i).as_dvec3())
            })
        };
        let (total, moment, momentum) = sample()
            .fold((0.0, DVec3::ZERO, DVec3::ZERO), |sum, (m, x, v)| {
                (sum.0 + m, sum.1 + x * m, sum.2 + v * m)
            });
        if total <= 0.0 {
            return Self::default();
        }
        let center = moment / total;
        let (inertia, momentum_of_spin) =
            sample().fold((DMat3::ZERO, DVec3::ZERO), |sum, (m, x, v)| {
                let r = x - center;
                let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
                let own = (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer) * m;
                (sum.0 + own, sum.1 + r.cross(v) * m)
            });
        let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        let rotation = if inertia.determinant() > 1e-9 * size * size * size {
            inertia.inverse() * momentum_of_spin
        } else {
            DVec3::ZERO
        };
        Self {
            center: center.as_vec3(),
            displacement: (momentum / total).as_vec3(),
            rotation: rotation.as_vec3(),
        }
    }
}

/// Moves the velocities x − x⁻ of neighbours towards each other, by moving x⁻. `conductance` is κ \[kg\]; what rounding
/// takes from a change is added to `lost`, so that momentum is kept.
pub(crate) fn damp(
    level: Level,
    sheet: Sheet,
    previous: SharedPoints,
    lost: SharedPoints,
    motion: RigidMotion,
    conductance: f32,
) {
    sheet.check();
    let stride = sheet.columns + 2 * WIDEST;
    with_scratch(3 * stride * KEPT, |scratch| {
        let scratch = Shared::new(scratch);
        dispatch!(level, simd => damp_with(simd, sheet, previous, lost, motion, conductance, scratch));
    });
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

    /// What lies to the left of each.
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

    /// Makes what lies beside the first and the last of `len` vectors equal to them.
    #[inline(always)]
    fn extend(self, len: usize) {
        for axis in 0..3 {
            let first = self.at + axis * self.stride;
            self.scratch.set(first - 1, self.scratch.get(first));
            self.scratch
                .set(first + len, self.scratch.get(first + len - 1));
        }
    }
}

#[inline(always)]
fn damp_with<S: Simd>(
    simd: S,
    sheet: Sheet,
    previous: SharedPoints,
    lost: SharedPoints,
    motion: RigidMotion,
    conductance: f32,
    scratch: Shared,
) {
    let (columns, rows) = (sheet.columns, sheet.rows);
    let stride = columns + 2 * WIDEST;
    let row_of = |r: usize| Row {
        scratch,
        at: (r % KEPT) * 3 * stride + WIDEST,
        stride,
    };
    let center = V3::splat(simd, motion.center);
    let displacement = V3::splat(simd, motion.displacement);
    let rotation = V3::splat(simd, motion.rotation);
    let kappa = S::f32s::splat(simd, conductance);
    for r in 0..=rows {
        if r < rows {
            let row = row_of(r);
            each_window(
                simd,
                0..columns,
                #[inline(always)]
                |window| {
                    let x: V3<S> = sheet.position.load_at(simd, window, r * columns);
                    let v = x - previous.load_at(simd, window, r * columns);
                    let rigid = displacement + rotation.cross(x - center);
                    row.store(window.at, v - rigid);
                },
            );
            row.extend(columns);
        }
        if r == 0 {
            continue;
        }
        // At a border the missing neighbour has the velocity of the particle itself.
        let middle = r - 1;
        let (above, here, below) = (
            row_of(middle.saturating_sub(1)),
            row_of(middle),
            row_of(r.min(rows - 1)),
        );
        each_window(
            simd,
            0..columns,
            #[inline(always)]
            |window| {
                let i = window.at;
                let v: V3<S> = here.load(simd, i);
                let vertical = (above.load(simd, i) - v) + (below.load(simd, i) - v);
                let horizontal = (here.load_left(simd, i) - v) + (here.load(simd, i + 1) - v);
                let w = sheet.inv_mass.load_at(simd, window, middle * columns);
                let first = middle * columns;
                let before: V3<S> = previous.load_at(simd, window, first);
                let change = Factor(w * kappa) * (vertical + horizontal);
                let after = before - change;
                let taken: V3<S> = lost.load_at(simd, window, first);
                lost.store_at(simd, window, first, taken + (change - (before - after)));
                previous.store_at(simd, window, first, after);
            },
        );
    }
}
