//! Diagonals: projections one after the other.

use crate::properties::*;
use bevy_math::{DVec3, Vec3};
use fearless_simd::Level;

use super::{Cloth, cases, cloths, momentum, vector};
use crate::{
    kernels::{
        mesh::solve_shear,
        packed::with_packed,
        shear::{self, Shear},
    },
    points::Points,
    topology::fabric::Springs,
};

/// Half a unit in the last place of a coordinate below 32 \[m\].
const ROUNDING: f64 = 9.6e-7;

/// One projection: Δx = ±w s d with s = 2 (q − L²)/((3 q + L²) W), W = max(w/2 + α̃, w), w being the sum of both inverse masses.
fn project(position: &mut [DVec3], inv_mass: &[f32], [a, b]: [usize; 2], length: f64, alpha: f64) {
    let [w_a, w_b] = [a, b].map(|i| f64::from(inv_mass[i]));
    let w = w_a + w_b;
    if w == 0.0 {
        return;
    }
    let d = position[b] - position[a];
    let (q, l2) = (d.length_squared(), length * length);
    let s = 2.0 * (q - l2) / ((3.0 * q + l2) * (0.5 * w + alpha).max(w));
    position[a] += w_a * s * d;
    position[b] -= w_b * s * d;
}

/// Even pairs of rows, then odd ones; in each pair one direction, then the other.
fn all_diagonals(cloth: &Cloth, shear: Shear) -> Vec<DVec3> {
    let mut position: Vec<_> = cloth.position.iter().map(|p| p.as_dvec3()).collect();
    let lengths = &cloth.lengths[0];
    for parity in 0..2 {
        for row in (parity..cloth.rows - 1).step_by(2) {
            for rising in [shear.rising_first, !shear.rising_first] {
                for column in 0..cloth.columns - 1 {
                    let corner = row * cloth.columns + column;
                    let across = [corner, corner + cloth.columns + 1];
                    let up = [corner + 1, corner + cloth.columns];
                    let ends = if rising { up } else { across };
                    let length = lengths.get(corner).unwrap_or(&shear.rest_length);
                    let alpha = f64::from(shear.alpha_tilde);
                    project(
                        &mut position,
                        &cloth.inv_mass,
                        ends,
                        f64::from(*length),
                        alpha,
                    );
                }
            }
        }
    }
    position
}

fn solved(cloth: &Cloth, shear: Shear) -> Vec<DVec3> {
    let level = Level::new();
    cloth.solved(|sheet| shear::solve(level, sheet, shear, 0..cloth.rows))
}

fn shears() -> impl Strategy<Value = Shear> {
    let alpha = prop_oneof![Just(0.0_f32), 1e-3_f32..0.5, 0.5_f32..20.0];
    (1.0_f32..1.8, alpha, any::<bool>()).prop_map(|(rest_length, alpha_tilde, rising_first)| {
        Shear {
            rest_length,
            alpha_tilde,
            rising_first,
        }
    })
}

/// A particle moves four times, each time by what rounding did before as well.
fn compare(cloth: &Cloth, shear: Shear) -> Result<(), TestCaseError> {
    let [is, wanted] = [solved(cloth, shear), all_diagonals(cloth, shear)];
    for (i, (is, wanted)) in is.iter().zip(&wanted).enumerate() {
        prop_assert!(is.distance(*wanted) < 30.0 * ROUNDING, "{i}: {is} {wanted}");
    }
    let start: Vec<_> = cloth.position.iter().map(|p| p.as_dvec3()).collect();
    if cloth.inv_mass.iter().all(|w| *w > 0.0) {
        let n = cloth.position.len() as f64;
        let sum = momentum(&start, &is, &cloth.inv_mass);
        // Masses of up to 5.
        prop_assert!(sum.length() < 20.0 * n * ROUNDING, "{sum}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn diagonals_are_projected_one_after_the_other(cloth in cloths(0.2, false, false), shear in shears()) {
        compare(&cloth, shear)?;
    }

    #[test]
    fn diagonals_are_projected_to_lengths_of_their_own(cloth in cloths(0.2, false, true), shear in shears()) {
        compare(&cloth, shear)?;
    }

    #[test]
    fn free_diagonals_keep_momentum(cloth in cloths(0.3, false, false), shear in shears()) {
        let inv_mass = cloth.inv_mass.iter().map(|w| w.max(0.2)).collect();
        compare(&Cloth { inv_mass, ..cloth }, shear)?;
    }

    /// The strain e = |d|/L − 1 becomes e³/(3 (1 + e)² + 1): it never goes too far.
    #[test]
    fn a_rigid_diagonal_is_left_with_the_cube_of_its_strain(strain in -0.5_f32..2.0, w in 0.1_f32..4.0, rising_first in any::<bool>()) {
        let cloth = cell(strain, [w, 1.0, 2.0, 0.0]);
        let solved = solved(&cloth, Shear { rest_length: 1.5, alpha_tilde: 0.0, rising_first });
        let e = f64::from(strain);
        let left = e.powi(3) / (3.0 * (1.0 + e).powi(2) + 1.0);
        for [a, b] in [[0, 3], [1, 2]] {
            let is = solved[a].distance(solved[b]) / 1.5 - 1.0;
            prop_assert!((is - left).abs() < 1e-6, "{is} {left}");
        }
    }

    /// α̃ + W/2 in place of W where that is more, so that compliance below W/2 changes nothing.
    #[test]
    fn compliance_shortens_the_displacement(alpha_tilde in 0.0_f32..10.0) {
        let start = cell(0.2, [1.0; 4]);
        let displacement = |alpha_tilde: f32| {
            let shear = Shear { rest_length: 1.5, alpha_tilde, rising_first: true };
            solved(&start, shear)[0].distance(start.position[0].as_dvec3())
        };
        let part = 2.0 / (f64::from(alpha_tilde) + 1.0).max(2.0);
        prop_assert!((displacement(alpha_tilde) - part * displacement(0.0)).abs() < 1e-6);
    }
}

/// Four particles whose diagonals are longer than 1.5 by this strain.
fn cell(strain: f32, inv_mass: [f32; 4]) -> Cloth {
    let side = 1.5 * (1.0 + strain) / std::f32::consts::SQRT_2;
    Cloth {
        columns: 2,
        rows: 2,
        position: [Vec3::ZERO, Vec3::X, Vec3::NEG_Y, Vec3::X - Vec3::Y]
            .map(|p| p * side)
            .to_vec(),
        inv_mass: inv_mass.to_vec(),
        normal: Vec::new(),
        lengths: [const { Vec::new() }; 2],
    }
}

prop_compose! {
    /// Particles of a lattice of 5 × 5, and springs across its cells, in any order.
    fn springs()(
        off in prop::collection::vec(vector(0.2), 25),
        inv_mass in prop::collection::vec(prop_oneof![1 => Just(0.0), 5 => 0.2_f32..2.0], 25),
        springs in prop::collection::vec((0_usize..4, 0_usize..4, any::<bool>(), 1.2_f32..1.7, 0.2_f32..2.0), 20),
    ) -> (Vec<Vec3>, Vec<f32>, Springs) {
        let at = |i: usize| Vec3::new((i % 5) as f32, (i / 5) as f32, 0.0);
        let mut all = Springs::default();
        for (column, row, rising, length, scale) in springs {
            let corner = (5 * row + column) as u32;
            all.ends.push(if rising { [corner + 1, corner + 5] } else { [corner + 6, corner] });
            all.rest_length.push(length);
            all.scale.push(scale);
        }
        ((0..).zip(off).map(|(i, off)| at(i) + off).collect(), inv_mass, all)
    }
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn springs_of_a_mesh_are_projected_one_after_the_other((start, inv_mass, springs) in springs(), alpha in 0.0_f32..4.0) {
        let mut position: Points = start.iter().copied().collect();
        with_packed(&mut position, &inv_mass, |all| solve_shear(&springs, &springs.rest_length, alpha, all));
        let start: Vec<_> = start.iter().map(|p| p.as_dvec3()).collect();
        let mut wanted = start.clone();
        for (k, ends) in springs.ends.iter().enumerate() {
            let [length, scale] = [springs.rest_length[k], springs.scale[k]].map(f64::from);
            project(&mut wanted, &inv_mass, ends.map(|i| i as usize), length, scale * f64::from(alpha));
        }
        let is: Vec<_> = position.iter().map(Vec3::as_dvec3).collect();
        for (i, (is, wanted)) in is.iter().zip(&wanted).enumerate() {
            // Coordinates below 8, whose last place is a quarter of those above.
            prop_assert!(is.distance(*wanted) < 30.0 * 0.25 * ROUNDING, "{i}: {is} {wanted}");
        }
        if inv_mass.iter().all(|w| *w > 0.0) {
            prop_assert!(momentum(&start, &is, &inv_mass).length() < 1e-4);
        }
    }
}
