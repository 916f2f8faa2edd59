//! Distance constraints: C = |x_b − x_a| − L, by extended position-based dynamics (Macklin et al. 2016).
//!
//! Each correction goes half and half to two ends of equal mass: Δx_a = +w_a/(w_a + w_b + α̃) · C n, Δx_b = −w_b/(…) · C n
//! with n the unit vector from a to b. With α̃ = 0 this is Jakobsen's relaxation ("Advanced Character Physics", 2001).
//!
//! The constraints of a pass must share no particle; so their order does not matter, and the bits do not depend on whether
//! they are solved one by one or several at once.

#![expect(clippy::doc_markdown, reason = "formulas")]

use crate::points::Points;

/// A distance below this \[m\] has no direction: such a constraint moves its ends less, in proportion to the distance.
const SHORTEST: f32 = 1e-9;

/// Smallest inverse mass [1/kg] in the denominator, so that a constraint between two held ends does not divide by 0.
const HEAVIEST: f32 = 1e-20;

/// Length from which on a run of constraints is solved side by side.
const SHORTEST_RUN: usize = 8;

/// One pass over rigid constraints (α = 0).
///
/// # Panics
/// When an end is not below the number of particles.
pub fn solve_rigid(
    ends: &[[u32; 2]],
    rest_lengths: &[f32],
    inv_mass: &[f32],
    position: &mut Points,
) {
    // Nothing is remembered: units take no space.
    let mut nothing = vec![(); ends.len()];
    let scale = |length: f32, rest: f32, w: f32, (): &mut ()| (length - rest) / (length * w);
    pass(ends, rest_lengths, inv_mass, &mut nothing, position, scale);
}

/// One pass over compliant constraints: Δλ = (−C − α̃ λ)/(w_a + w_b + α̃), with α̃ = α/h² [1/kg]. `lambda` [kg m] adds up
/// over the passes of a substep and starts at 0.
///
/// # Panics
/// When an end is not below the number of particles.
pub fn solve_compliant(
    ends: &[[u32; 2]],
    rest_lengths: &[f32],
    alpha_tilde: f32,
    inv_mass: &[f32],
    lambda: &mut [f32],
    position: &mut Points,
) {
    let scale = |length: f32, rest: f32, w: f32, lambda: &mut f32| {
        let delta = (rest - length - alpha_tilde * *lambda) / (w + alpha_tilde);
        *lambda += delta;
        -delta / length
    };
    pass(ends, rest_lengths, inv_mass, lambda, position, scale);
}

/// Moves the ends of each constraint by Δx_a = w_a s d and Δx_b = −w_b s d, where d = x_b − x_a and s is
/// `scale`(|d|, L, w_a + w_b, memory). Constraints without direction or without a free end move nothing.
#[inline(always)]
fn pass<M>(
    ends: &[[u32; 2]],
    rest_lengths: &[f32],
    inv_mass: &[f32],
    memory: &mut [M],
    position: &mut Points,
    scale: impl Fn(f32, f32, f32, &mut M) -> f32,
) {
    let n = inv_mass.len();
    let (x, y, z) = (
        &mut position.x[..n],
        &mut position.y[..n],
        &mut position.z[..n],
    );
    let mut start = 0;
    while start < ends.len() {
        let run = start..start + run_length(&ends[start..]);
        start = run.end;
        let (ends, rest_lengths) = (&ends[run.clone()], &rest_lengths[run.clone()]);
        let memory = &mut memory[run];
        if ends.len() >= SHORTEST_RUN {
            let ranges = ends[0].map(|i| i as usize..i as usize + ends.len());
            let inv_mass = ranges.clone().map(|range| &inv_mass[range]);
            if let (Ok(x), Ok(y), Ok(z)) = (
                x.get_disjoint_mut(ranges.clone()),
                y.get_disjoint_mut(ranges.clone()),
                z.get_disjoint_mut(ranges),
            ) {
                solve_run(x, y, z, inv_mass, rest_lengths, memory, &scale);
                continue;
            }
        }
        for ((&[a, b], &rest), memory) in ends.iter().zip(rest_lengths).zip(memory) {
            let (a, b) = (a as usize, b as usize);
            let (dx, dy, dz) = (x[b] - x[a], y[b] - y[a], z[b] - z[a]);
            let (w_a, w_b) = (inv_mass[a], inv_mass[b]);
            let length = at_least(SHORTEST, (dx * dx + dy * dy + dz * dz).sqrt());
            let s = scale(length, rest, at_least(HEAVIEST, w_a + w_b), memory);
            let (s_a, s_b) = (s * w_a, s * w_b);
            x[a] += s_a * dx;
            y[a] += s_a * dy;
            z[a] += s_a * dz;
            x[b] -= s_b * dx;
            y[b] -= s_b * dy;
            z[b] -= s_b * dz;
        }
    }
}

/// Number of constraints, from the first on, that join one run of neighbouring particles to another: grids have long runs.
#[inline(always)]
fn run_length(ends: &[[u32; 2]]) -> usize {
    let Some([a, b]) = ends.first() else { return 0 };
    let breaks = (0..)
        .zip(ends)
        .skip(1)
        .position(|(k, end)| *end != [a + k, b + k]);
    breaks.map_or(ends.len(), |at| at + 1)
}

/// The larger one, as one instruction (`f32::max` takes care of NaN as well).
#[inline(always)]
fn at_least(least: f32, value: f32) -> f32 {
    if value > least { value } else { least }
}

/// Applies [`pass`] to each constraint of a run, in a form that compilers turn into vector instructions: no branch, no index to look up,
/// and arguments that cannot overlap.
#[inline(never)]
fn solve_run<M>(
    [x_a, x_b]: [&mut [f32]; 2],
    [y_a, y_b]: [&mut [f32]; 2],
    [z_a, z_b]: [&mut [f32]; 2],
    [w_a, w_b]: [&[f32]; 2],
    rest_lengths: &[f32],
    memory: &mut [M],
    scale: impl Fn(f32, f32, f32, &mut M) -> f32,
) {
    let n = rest_lengths.len();
    let (x_a, y_a, z_a) = (&mut x_a[..n], &mut y_a[..n], &mut z_a[..n]);
    let (x_b, y_b, z_b) = (&mut x_b[..n], &mut y_b[..n], &mut z_b[..n]);
    let (w_a, w_b, memory) = (&w_a[..n], &w_b[..n], &mut memory[..n]);
    for k in 0..n {
        let (dx, dy, dz) = (x_b[k] - x_a[k], y_b[k] - y_a[k], z_b[k] - z_a[k]);
        let length = at_least(SHORTEST, (dx * dx + dy * dy + dz * dz).sqrt());
        let w = at_least(HEAVIEST, w_a[k] + w_b[k]);
        let s = scale(length, rest_lengths[k], w, &mut memory[k]);
        let (s_a, s_b) = (s * w_a[k], s * w_b[k]);
        x_a[k] += s_a * dx;
        y_a[k] += s_a * dy;
        z_a[k] += s_a * dz;
        x_b[k] -= s_b * dx;
        y_b[k] -= s_b * dy;
        z_b[k] -= s_b * dz;
    }
}

#[cfg(test)]
mod tests {
    use crate::properties::*;
    use bevy_math::Vec3;

    use super::*;

    fn point() -> impl Strategy<Value = Vec3> {
        (-10.0f32..10.0, -10.0f32..10.0, -10.0f32..10.0).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn one_pass_satisfies_one_constraint_and_keeps_the_center_of_mass(
            a in point(), b in point(), rest in 0.1f32..5.0, w_a in 0.1f32..10.0, w_b in 0.1f32..10.0,
        ) {
            prop_assume!(a.distance(b) > 0.01);
            let mut position = Points::from_iter([a, b]);
            solve_rigid(&[[0, 1]], &[rest], &[w_a, w_b], &mut position);
            let (a2, b2) = (position.get(0), position.get(1));
            prop_assert!((a2.distance(b2) - rest).abs() < 1e-4);
            // Neither goes through the other.
            prop_assert!((b2 - a2).dot(b - a) > 0.0);
            let shift = (a2 - a) / w_a + (b2 - b) / w_b;
            prop_assert!(shift.length() < 1e-4 * (1.0 / w_a + 1.0 / w_b) * 10.0);
        }

        #[test]
        fn a_compliant_constraint_settles_where_spring_and_inertia_balance(
            stretch in 0.01f32..2.0, alpha_tilde in 0.01f32..10.0, passes in 1usize..20,
        ) {
            let mut position = Points::from_iter([Vec3::ZERO, Vec3::X * (1.0 + stretch)]);
            let mut lambda = [0.0];
            for _ in 0..passes {
                solve_compliant(&[[0, 1]], &[1.0], alpha_tilde, &[0.0, 1.0], &mut lambda, &mut position);
            }
            // One constraint is solved in one pass, further passes change nothing.
            let left = stretch * alpha_tilde / (1.0 + alpha_tilde);
            prop_assert!((position.get(1).x - 1.0 - left).abs() < 1e-4);
        }
    }

    proptest! {
        #[test]
        fn side_by_side_gives_the_same_bits_as_one_by_one(
            points in prop::collection::vec(point(), 40), light in prop::collection::vec(0.0f32..1000.0, 40),
            first in 0u32..20, run in 1u32..20,
        ) {
            let ends: Vec<[u32; 2]> = (0..run.min(20 - first)).map(|k| [first + k, 20 + k]).collect();
            // Some ends are held.
            let inv_mass: Vec<f32> = light.into_iter().map(|w| (w - 200.0).max(0.0)).collect();
            let rest_lengths = vec![1.5; ends.len()];
            let start: Points = points.into_iter().collect();
            for alpha_tilde in [0.0, 10.0] {
                let (mut together, mut apart) = (start.clone(), start.clone());
                let mut lambda = vec![0.5; ends.len()];
                let mut lambda_apart = lambda.clone();
                if alpha_tilde == 0.0 {
                    solve_rigid(&ends, &rest_lengths, &inv_mass, &mut together);
                } else {
                    solve_compliant(&ends, &rest_lengths, alpha_tilde, &inv_mass, &mut lambda, &mut together);
                }
                for (ends, lambda) in ends.chunks(1).zip(lambda_apart.chunks_mut(1)) {
                    if alpha_tilde == 0.0 {
                        solve_rigid(ends, &[1.5], &inv_mass, &mut apart);
                    } else {
                        solve_compliant(ends, &[1.5], alpha_tilde, &inv_mass, lambda, &mut apart);
                    }
                }
                prop_assert_eq!(together, apart);
                prop_assert_eq!(&lambda, &lambda_apart);
            }
        }
    }

    #[test]
    fn no_direction_and_no_mass_do_no_harm() {
        let mut position = Points::from_iter([Vec3::ONE, Vec3::ONE, Vec3::ZERO]);
        let before = position.clone();
        solve_rigid(
            &[[0, 1], [0, 2]],
            &[1.0, 1.0],
            &[0.0, 1.0, 0.0],
            &mut position,
        );
        solve_compliant(
            &[[0, 1], [0, 2]],
            &[1.0; 2],
            0.0,
            &[0.0, 1.0, 0.0],
            &mut [0.0; 2],
            &mut position,
        );
        assert_eq!(position, before);
    }
}
