//! Damping of tangles: of particles at edges that are squeezed to much less than their length.
//!
//! Nothing ordinary squeezes an edge that far: cloth buckles first. It happens where a sheet is wound up in itself, after pins that jumped
//! or a step of a second, and rows and columns contradict each other. Such a tangle would move for ever; with the rigid motion of the whole
//! in place of its own it mostly comes to rest, and often undoes itself.

use bevy_math::Vec2;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{SharedPoints, Window, each_window},
    lattice::Sheet,
    rigid_motion::RigidMotion,
    vectors::V3,
};

/// Least q/L² of an edge whose ends keep a motion of their own.
pub const LEAST: f32 = 0.5;

/// Survey of the edges along rows and columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// True if any edge is squeezed.
    pub squeezed: bool,
    /// Part of the edges that is longer than allowed [-].
    pub strained: f32,
    /// Length of the longest strained edge, as a multiple of its length at rest [-]; 0 where none is strained.
    pub longest: f32,
}

/// Surveys all edges; an edge is strained if it is longer than `allowed` times its length at rest.
pub fn survey(level: Level, sheet: Sheet, spacing: Vec2, allowed: f32) -> Survey {
    sheet.check();
    dispatch!(level, simd => survey_with(simd, sheet, spacing, allowed))
}

#[inline(always)]
fn survey_with<S: Simd>(simd: S, sheet: Sheet, spacing: Vec2, allowed: f32) -> Survey {
    let columns = sheet.columns;
    let [least, most] = [LEAST, allowed * allowed].map(|part| spacing * spacing * part);
    let per_square = (spacing * spacing).recip();
    let mut squeezed = false;
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    // Whole numbers, which add up to the same in any order.
    let mut strained = 0;
    let mut farthest = zero;
    for row in 0..sheet.rows {
        let first = row * columns;
        let below = if row + 1 < sheet.rows { columns } else { 0 };
        let mut of_row = zero;
        for (count, to, least, most, per_square) in [
            (columns - 1, 1, least.x, most.x, per_square.x),
            (below, columns, least.y, most.y, per_square.y),
        ] {
            let (least, most) = (S::f32s::splat(simd, least), S::f32s::splat(simd, most));
            each_window(
                simd,
                0..count,
                #[inline(always)]
                |window| {
                    let from: V3<S> = sheet.position.load_at(simd, window, first);
                    let d = sheet.position.load_at(simd, window, first + to) - from;
                    let q = d.dot(d);
                    let (short, long) = (q.simd_lt(least), q.simd_gt(most));
                    if (short | long).any_true() {
                        squeezed |= short.any_true();
                        let long = long & window.todo(simd);
                        farthest = farthest.max(long.select(q * per_square, zero));
                        of_row += long.select(one, zero);
                    }
                },
            );
        }
        if of_row.simd_gt(zero).any_true() {
            strained += of_row.as_slice().iter().map(|n| *n as usize).sum::<usize>();
        }
    }
    let edges = sheet.rows * (columns - 1) + (sheet.rows - 1) * columns;
    Survey {
        squeezed,
        strained: strained as f32 / edges as f32,
        longest: (farthest.as_slice().iter().copied())
            .fold(0.0, f32::max)
            .sqrt(),
    }
}

/// Gives free particles (`inv_mass` > 0) at the ends of squeezed edges along rows and columns the rigid motion of the whole, by moving
/// `previous`. `spacing` is between columns and between rows \[m\].
pub fn stop(level: Level, sheet: Sheet, previous: SharedPoints, spacing: Vec2, whole: RigidMotion) {
    sheet.check();
    let n = sheet.columns * sheet.rows;
    assert!(previous.has(n), "one of each for {n} particles");
    dispatch!(level, simd => stop_with(simd, sheet, previous, spacing, whole));
}

#[inline(always)]
fn stop_with<S: Simd>(
    simd: S,
    sheet: Sheet,
    previous: SharedPoints,
    spacing: Vec2,
    whole: RigidMotion,
) {
    let columns = sheet.columns;
    let least = spacing * spacing * LEAST;
    for row in 0..sheet.rows {
        let first = row * columns;
        let below = if row + 1 < sheet.rows { columns } else { 0 };
        for (count, to, least) in [(columns - 1, 1, least.x), (below, columns, least.y)] {
            each_window(
                simd,
                0..count,
                #[inline(always)]
                |window| {
                    let ends = [first, first + to];
                    stop_ends(simd, sheet, previous, window, ends, least, whole);
                },
            );
        }
    }
}

/// Stops the ends of the edges from `ends[0]` to `ends[1]`, each with the window added.
#[inline(always)]
fn stop_ends<S: Simd>(
    simd: S,
    sheet: Sheet,
    previous: SharedPoints,
    window: Window,
    ends: [usize; 2],
    least: f32,
    whole: RigidMotion,
) {
    let zero = S::f32s::splat(simd, 0.0);
    let places: [V3<S>; 2] = [
        sheet.position.load_at(simd, window, ends[0]),
        sheet.position.load_at(simd, window, ends[1]),
    ];
    let d = places[1] - places[0];
    let squeezed = d.dot(d).simd_lt(S::f32s::splat(simd, least));
    if !squeezed.any_true() {
        return;
    }
    let rotation = V3::splat(simd, whole.rotation);
    let at_origin = V3::splat(simd, whole.at_origin());
    for (place, end) in places.into_iter().zip(ends) {
        let from = place - (rotation.cross(place) + at_origin);
        let free = sheet.inv_mass.load_at(simd, window, end).simd_gt(zero);
        let before: V3<S> = previous.load_at(simd, window, end);
        previous.store_at(simd, window, end, from.select(squeezed & free, before));
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::Vec3;

    use super::*;
    use crate::{
        kernels::{
            lanes::{Shared, levels},
            lines::Give,
        },
        points::Points,
    };

    #[test]
    fn those_at_squeezed_edges_move_as_the_whole_and_no_others() {
        for [columns, rows] in [[2, 2], [5, 7], [17, 33]] {
            for squeezed in 0..columns * rows {
                for level in levels() {
                    let at = |i: usize| Vec3::new((i % columns) as f32, (i / columns) as f32, 0.0);
                    let mut position: Points = (0..columns * rows).map(at).collect();
                    // Half way to the neighbour on the right, and out of the plane, so that the edge to the left is longer and that to the
                    // right shorter.
                    let moved = at(squeezed) + Vec3::new(0.5, 0.0, 0.1);
                    position.set(squeezed, moved);
                    let mut previous: Points = position.iter().map(|p| p - Vec3::Z).collect();
                    let mut inv_mass = vec![1.0; columns * rows];
                    inv_mass[0] = 0.0;
                    let sheet = Sheet {
                        columns,
                        rows,
                        position: SharedPoints::new(&mut position),
                        inv_mass: Shared::new(&mut inv_mass),
                        normal: None,
                        pressed: None,
                        give: Give::default(),
                        lengths: None,
                    };
                    let whole = RigidMotion {
                        displacement: Vec3::Y,
                        ..RigidMotion::default()
                    };
                    let previous_points = SharedPoints::new(&mut previous);
                    stop(level, sheet, previous_points, Vec2::ONE, whole);
                    for i in 0..columns * rows {
                        let right = squeezed % columns + 1 < columns;
                        let ends = [squeezed, squeezed + 1];
                        let stops = right && ends.contains(&i) && i != 0;
                        let velocity = if stops { Vec3::Y } else { Vec3::Z };
                        let is = position.get(i) - previous.get(i);
                        assert!(
                            is.distance(velocity) < 1e-6,
                            "{columns}x{rows}: {i}, {squeezed}"
                        );
                    }
                }
            }
        }
    }
}
