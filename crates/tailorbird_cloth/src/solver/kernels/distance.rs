//! Distance constraints: C = |x_b − x_a| − L, by extended position-based dynamics (Macklin et al. 2016).
//!
//! Each correction goes half and half to two ends of equal mass: Δx_a = +w_a/(w_a + w_b + α̃) · C n, Δx_b = −w_b/(…) · C n
//! with n the unit vector from a to b. With α̃ = 0 this is Jakobsen's relaxation ("Advanced Character Physics", 2001).

use crate::points::Points;

/// A distance below this [m] has no direction; the constraint waits until something else separates its ends.
const SHORTEST: f32 = 1e-9;

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
    let n = inv_mass.len();
    let (x, y, z) = (
        &mut position.x[..n],
        &mut position.y[..n],
        &mut position.z[..n],
    );
    for (&[a, b], &rest) in ends.iter().zip(rest_lengths) {
        let (a, b) = (a as usize, b as usize);
        let (dx, dy, dz) = (x[b] - x[a], y[b] - y[a], z[b] - z[a]);
        let (w_a, w_b) = (inv_mass[a], inv_mass[b]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        let denominator = length * (w_a + w_b);
        if length < SHORTEST || denominator == 0.0 {
            continue;
        }
        let s = (length - rest) / denominator;
        let (s_a, s_b) = (s * w_a, s * w_b);
        x[a] += s_a * dx;
        y[a] += s_a * dy;
        z[a] += s_a * dz;
        x[b] -= s_b * dx;
        y[b] -= s_b * dy;
        z[b] -= s_b * dz;
    }
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
    let n = inv_mass.len();
    let (x, y, z) = (
        &mut position.x[..n],
        &mut position.y[..n],
        &mut position.z[..n],
    );
    for ((&[a, b], &rest), lambda) in ends.iter().zip(rest_lengths).zip(lambda) {
        let (a, b) = (a as usize, b as usize);
        let (dx, dy, dz) = (x[b] - x[a], y[b] - y[a], z[b] - z[a]);
        let (w_a, w_b) = (inv_mass[a], inv_mass[b]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        if length < SHORTEST || w_a + w_b == 0.0 {
            continue;
        }
        let delta = (rest - length - alpha_tilde * *lambda) / (w_a + w_b + alpha_tilde);
        *lambda += delta;
        let s = delta / length;
        let (s_a, s_b) = (s * w_a, s * w_b);
        x[a] -= s_a * dx;
        y[a] -= s_a * dy;
        z[a] -= s_a * dz;
        x[b] += s_b * dx;
        y[b] += s_b * dy;
        z[b] += s_b * dz;
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::Vec3;
    use proptest::prelude::*;

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
