//! Directions of vectors of about a known length, without a root.

use bevy_math::{DVec3, Vec3};

use crate::kernels::{contact::unit_of_about, lanes::V3};

/// Unit vector by the series, from a vector of this expected length.
fn unit_of(v: Vec3, expected: f32) -> DVec3 {
    let simd = fearless_simd::Fallback::new();
    let all = simd_mask(simd);
    let unit = unit_of_about(simd, V3::splat(simd, v), expected, all);
    DVec3::new(
        f64::from(unit.x.as_slice()[0]),
        f64::from(unit.y.as_slice()[0]),
        f64::from(unit.z.as_slice()[0]),
    )
}

fn simd_mask(
    simd: fearless_simd::Fallback,
) -> <fearless_simd::Fallback as fearless_simd::Simd>::mask32s {
    use fearless_simd::prelude::*;
    type Numbers = <fearless_simd::Fallback as fearless_simd::Simd>::f32s;
    Numbers::splat(simd, 1.0).simd_gt(Numbers::splat(simd, 0.0))
}

/// The series of 1/√(1 + e) is right to 10⁻⁹: the lengths of many unit vectors are 1 but for rounding, which has no preference.
#[test]
fn the_series_of_the_inverse_root_has_no_bias() {
    for part in [-0.0195, -0.01, -0.001, 0.001, 0.01, 0.0195] {
        let mut sum = 0.0;
        let count = 4000;
        for k in 0..count {
            let random = |seed| crate::topology::test_meshes::random(k, seed) - 0.5;
            let direction =
                DVec3::new(random(1).into(), random(2).into(), random(3).into()).normalize();
            // Not quite the same number each time.
            let square = 1.0 + part + 1e-3 * f64::from(random(4)) * part;
            let v = (direction * square.sqrt() * 1.3).as_vec3();
            let unit = unit_of(v, 1.3);
            // Two units in the last place of components below 1.
            assert!(
                unit.distance(v.as_dvec3().normalize()) < 2.4e-7,
                "{part}: {unit}"
            );
            sum += unit.length() - 1.0;
        }
        // Rounding of 6 · 10⁻⁸, of which a mean of 4000 leaves 10⁻⁹; that of the constants 1/1.3 is the same for all.
        let bias = sum / f64::from(count as u32);
        assert!(bias.abs() < 5e-8, "{part}: {bias}");
    }
}
