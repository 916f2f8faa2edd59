//! Wind on the triangles of sheets: cells side by side.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::Air;
use crate::{
    kernels::{
        cells::{AroundParticle, gather, with_cells},
        lanes::{Factor, Reading, SharedPoints, V3, Window},
    },
    points::Points,
    topology::lattice::Lattice,
};

/// Particles of a sheet in the air, whose cells are cut as in `topology::grid`.
#[derive(Clone, Copy)]
pub struct AirSheet<'a> {
    pub lattice: &'a Lattice,
    /// Position \[m\].
    pub position: &'a Points,
    /// Position a substep before \[m\].
    pub previous: &'a Points,
    /// Inverse mass [1/kg].
    pub inv_mass: &'a [f32],
    /// Accelerations that the wind's are added to [m/s²].
    pub acceleration: SharedPoints<'a>,
}

impl AirSheet<'_> {
    /// Columns and rows.
    ///
    /// # Panics
    /// When there are fewer of anything than particles in columns and rows.
    fn check(&self) -> [usize; 2] {
        let size = [self.lattice.columns, self.lattice.rows].map(|n| n as usize);
        let n = size[0] * size[1];
        assert!(
            self.position.has(n)
                && self.previous.has(n)
                && self.inv_mass.len() >= n
                && self.acceleration.has(n),
            "a sheet of {} x {} particles",
            size[0],
            size[1]
        );
        size
    }

    /// Adds `factor` times a sum and the inverse mass to the accelerations of a window, `offset` further on.
    #[inline(always)]
    fn accelerate<S: Simd>(
        self,
        simd: S,
        window: Window,
        offset: usize,
        sum: V3<S>,
        factor: S::f32s,
    ) {
        let w: S::f32s = Reading(&self.inv_mass[offset..]).load_at(simd, window);
        let before = self.acceleration.load_at(simd, window, offset);
        let after = before + Factor(w * factor) * sum;
        self.acceleration.store_at(simd, window, offset, after);
    }
}

/// Computes [`drag_and_lift`](super::drag_and_lift) for a range of the rows of a sheet. Only the accelerations of these rows are written,
/// so that several threads may do different rows.
///
/// # Panics
/// When an array does not have one element for each particle, or there are not as many rows.
pub fn drag_and_lift_on_sheet(
    level: Level,
    sheet: AirSheet,
    air: Air,
    per_second: f32,
    rows: Range<usize>,
) {
    let size = sheet.check();
    assert!(rows.end <= size[1], "rows of the sheet");
    let rest_area = 0.5 * sheet.lattice.spacing.x * sheet.lattice.spacing.y;
    let drag = Drag {
        sheet,
        air,
        third: per_second / 3.0,
        rate: 0.25 * air.density / (rest_area * air.areal_density) * air.seconds,
        factor: air.third(rest_area),
    };
    with_cells(size[0], |scratch| {
        dispatch!(level, simd => gather(simd, size, rows, drag, scratch));
    });
}

/// Computes [`classic`](super::classic) for a range of the rows of a sheet. Only the accelerations of these rows are written, so that
/// several threads may do different rows.
///
/// # Panics
/// When an array does not have one element for each particle, or there are not as many rows.
pub fn classic_on_sheet(level: Level, sheet: AirSheet, wind: Vec3, rows: Range<usize>) {
    let size = sheet.check();
    assert!(rows.end <= size[1], "rows of the sheet");
    let classic = Classic { sheet, wind };
    with_cells(size[0], |scratch| {
        dispatch!(level, simd => gather(simd, size, rows, classic, scratch));
    });
}

/// Change of velocity of each triangle.
#[derive(Clone, Copy)]
struct Drag<'a> {
    sheet: AirSheet<'a>,
    air: Air,
    /// Factor from the sum of three displacements to a velocity [1/s].
    third: f32,
    /// ½ ρ/σ Δt divided by twice the area at rest; the area is a multiple of that at rest [s/m³].
    rate: f32,
    /// A third of the mass of a triangle, by the length of the step [kg/s].
    factor: f32,
}

impl<S: Simd> AroundParticle<S> for Drag<'_> {
    /// Position, and displacement since the substep before.
    type Corner = [V3<S>; 2];

    #[inline(always)]
    fn corner(self, simd: S, window: Window, offset: usize) -> Self::Corner {
        let place: V3<S> = self.sheet.position.window(simd, window, offset);
        [
            place,
            place - self.sheet.previous.window(simd, window, offset),
        ]
    }

    #[inline(always)]
    fn triangle(self, simd: S, [a, b, c]: [Self::Corner; 3]) -> V3<S> {
        let [zero, one] = [0.0, 1.0].map(|v| S::f32s::splat(simd, v));
        let normal = (b[0] - a[0]).cross(c[0] - a[0]);
        let double_area = normal.dot(normal).sqrt();
        let third = Factor(S::f32s::splat(simd, self.third));
        let u = third * (a[1] + b[1] + c[1]) - V3::splat(simd, self.air.wind);
        let speed = u.dot(u).sqrt();
        let n = Factor(one / double_area) * normal;
        let u_n = u.dot(n);
        let rate = double_area * self.rate;
        let g = rate * speed * self.air.lift;
        let e = rate * (u_n * u_n / speed) * (self.air.drag - self.air.lift);
        let turned = u - Factor(u_n * (g / (g + one))) * n;
        let after = if self.air.drag >= self.air.lift {
            Factor(one / (e + one)) * turned
        } else {
            // With more lift than drag, the part along û pushes forward: at most to the speed before.
            let pushed = Factor(one - e) * turned;
            let length = pushed.dot(pushed).sqrt();
            Factor((speed / length).min(one)) * pushed
        };
        let moves = double_area.simd_gt(zero) & speed.simd_gt(zero);
        (after - u).select(moves, V3::splat(simd, Vec3::ZERO))
    }

    #[inline(always)]
    fn take(self, simd: S, window: Window, offset: usize, sum: V3<S>) {
        let factor = S::f32s::splat(simd, self.factor);
        self.sheet.accelerate(simd, window, offset, sum, factor);
    }
}

/// Classic force on each triangle, along the wind.
#[derive(Clone, Copy)]
struct Classic<'a> {
    sheet: AirSheet<'a>,
    wind: Vec3,
}

impl<S: Simd> AroundParticle<S> for Classic<'_> {
    type Corner = V3<S>;

    #[inline(always)]
    fn corner(self, simd: S, window: Window, offset: usize) -> V3<S> {
        self.sheet.position.window(simd, window, offset)
    }

    #[inline(always)]
    fn triangle(self, simd: S, [a, b, c]: [V3<S>; 3]) -> V3<S> {
        let through = V3::splat(simd, self.wind).dot((b - a).cross(c - a));
        let direction = V3::splat(simd, self.wind.normalize_or_zero());
        Factor(through.max(-through)) * direction
    }

    #[inline(always)]
    fn take(self, simd: S, window: Window, offset: usize, sum: V3<S>) {
        let sixth = S::f32s::splat(simd, 1.0 / 6.0);
        self.sheet.accelerate(simd, window, offset, sum, sixth);
    }
}

#[cfg(test)]
#[path = "sheet_tests.rs"]
mod tests;
