//! Range of coordinates, and a check that they are finite.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Reading, each_window};
use crate::points::Points;

/// Box around some particles at two times: lowest and highest coordinates.
pub fn bounds(level: Level, times: [&Points; 2], particles: Range<usize>) -> (Vec3, Vec3) {
    dispatch!(level, simd => bounds_with(simd, times, particles))
}

#[inline(always)]
fn bounds_with<S: Simd>(
    simd: S,
    [now, before]: [&Points; 2],
    particles: Range<usize>,
) -> (Vec3, Vec3) {
    let (x, y, z) = (
        ends(simd, [&now.x, &before.x], particles.clone()),
        ends(simd, [&now.y, &before.y], particles.clone()),
        ends(simd, [&now.z, &before.z], particles),
    );
    (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1))
}

/// Lowest and highest of some numbers of two lists.
#[inline(always)]
fn ends<S: Simd>(simd: S, lists: [&[f32]; 2], at: Range<usize>) -> (f32, f32) {
    let lanes = S::f32s::LEN;
    let [a, b] = [&lists[0][at.clone()], &lists[1][at]];
    if a.len() < lanes {
        let all = a.iter().chain(b);
        return all.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
    }
    let mut lowest = S::f32s::splat(simd, f32::INFINITY);
    let mut highest = S::f32s::splat(simd, f32::NEG_INFINITY);
    for (a, b) in a.chunks_exact(lanes).zip(b.chunks_exact(lanes)) {
        let (a, b) = (S::f32s::from_slice(simd, a), S::f32s::from_slice(simd, b));
        lowest = lowest.min(a.min(b));
        highest = highest.max(a.max(b));
    }
    if a.len() % lanes != 0 {
        // The last vector of each list overlaps the vector before.
        let [a, b] = [a, b].map(|values| &values[values.len() - lanes..]);
        let (a, b) = (S::f32s::from_slice(simd, a), S::f32s::from_slice(simd, b));
        lowest = lowest.min(a.min(b));
        highest = highest.max(a.max(b));
    }
    (lowest.reduce_min(), highest.reduce_max())
}

/// Returns whether all coordinates of these points are finite, neither infinite nor NaN.
pub fn are_finite(level: Level, points: &Points) -> bool {
    [&points.x, &points.y, &points.z]
        .into_iter()
        .all(|values| is_finite(level, values))
}

/// Returns whether all of these numbers are finite: 0 · v is 0 for finite ones alone.
fn is_finite(level: Level, values: &[f32]) -> bool {
    dispatch!(level, simd => is_finite_with(simd, values))
}

#[inline(always)]
fn is_finite_with<S: Simd>(simd: S, values: &[f32]) -> bool {
    let zero = S::f32s::splat(simd, 0.0);
    let mut sum = zero;
    each_window(
        simd,
        0..values.len(),
        #[inline(always)]
        |window| sum += Reading(values).load_at(simd, window) * zero,
    );
    sum.as_slice().iter().all(|v| *v == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::lanes::levels;

    #[test]
    fn a_box_is_around_all_particles_at_both_times() {
        let point = |i: usize, seed: f32| {
            let t = i as f32 + seed;
            Vec3::new((2.1 * t).sin(), (3.7 * t).sin(), (5.3 * t).sin())
        };
        let times = [0.3, 17.0].map(|seed| (0..70).map(|i| point(i, seed)).collect::<Points>());
        for level in levels() {
            for start in [0, 3] {
                for end in start + 1..70 {
                    let all = || times.iter().flat_map(|p| (start..end).map(|i| p.get(i)));
                    let low = all().reduce(Vec3::min).unwrap();
                    let high = all().reduce(Vec3::max).unwrap();
                    let [now, before] = &times;
                    assert_eq!(bounds(level, [now, before], start..end), (low, high));
                }
            }
        }
    }

    #[test]
    fn finds_what_is_not_finite_wherever_it_is() {
        for level in levels() {
            for len in 1..70 {
                let mut values: Vec<f32> = (0..len).map(|i| (i as f32).sin()).collect();
                for i in 0..len {
                    let kept = values[i];
                    assert!(is_finite(level, &values));
                    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                        values[i] = wrong;
                        assert!(!is_finite(level, &values), "{i} of {len}, {level:?}");
                    }
                    values[i] = kept;
                }
            }
        }
    }
}
