//! The range of coordinates, and whether they are finite.

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Reading, each_window};

/// The lowest and the highest of these numbers and of `low` and `high`; NaN does not count.
pub fn range(level: Level, values: &[f32], (low, high): (f32, f32)) -> (f32, f32) {
    dispatch!(level, simd => range_with(simd, values, (low, high)))
}

#[inline(always)]
fn range_with<S: Simd>(simd: S, values: &[f32], (low, high): (f32, f32)) -> (f32, f32) {
    let chunks = values.chunks_exact(S::f32s::LEN);
    let rest = chunks.remainder();
    let (mut lowest, mut highest) = (S::f32s::splat(simd, low), S::f32s::splat(simd, high));
    for chunk in chunks {
        let values = S::f32s::from_slice(simd, chunk);
        lowest = lowest.min(values);
        highest = highest.max(values);
    }
    let lowest = lowest.as_slice().iter().chain(rest);
    let highest = highest.as_slice().iter().chain(rest);
    (
        lowest.copied().fold(low, f32::min),
        highest.copied().fold(high, f32::max),
    )
}

/// Whether none of these numbers is infinite or NaN: 0 · v is 0 for finite ones alone.
pub fn is_finite(level: Level, values: &[f32]) -> bool {
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
    use crate::solver::kernels::lanes::levels;

    #[test]
    fn finds_the_ends_and_what_is_not_finite_wherever_they_are() {
        for level in levels() {
            for len in 1..70 {
                let mut values: Vec<f32> = (0..len).map(|i| (i as f32).sin()).collect();
                for i in 0..len {
                    let kept = values[i];
                    values[i] = -3.0;
                    assert_eq!(range(level, &values, (0.0, 2.0)), (-3.0, 2.0));
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
