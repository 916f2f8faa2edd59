//! Air: its effect on a plate and on triangles, and breezes.

use crate::properties::*;
use bevy_math::{DMat3, DVec3, Isometry3d, Quat, Vec3};
use fearless_simd::Level;

use super::{cases, vector};
use crate::{
    kernels::{
        aerodynamics::{Air, classic, drag_and_lift},
        breeze::{Breeze, add},
        lanes::SharedPoints,
    },
    points::Points,
    wind::{WAVES, Wave, WindRegion},
};

/// The part along the normal by 1/(1 + g), then all of it by 1/(1 + e); more lift than drag pushes by 1 − e, and never beyond the speed there was.
fn change(air: Air, u: DVec3, n: DVec3, stretched: f64) -> DVec3 {
    let [rho, sigma, drag, lift, dt] = [
        air.density,
        air.areal_density,
        air.drag,
        air.lift,
        air.seconds,
    ]
    .map(f64::from);
    let speed = u.length();
    let (g, cos) = (
        0.5 * rho * stretched / sigma * lift * speed * dt,
        u.dot(n) / speed,
    );
    let e = 0.5 * rho * stretched / sigma * (drag - lift) * cos * cos * speed * dt;
    let turned = u - n * u.dot(n) * (1.0 - 1.0 / (1.0 + g));
    if e >= 0.0 {
        turned / (1.0 + e) - u
    } else {
        (turned * (1.0 - e)).clamp_length_max(speed) - u
    }
}

prop_compose! {
    fn airs()(
        wind in vector(10.0), density in 0.5_f32..2.0, areal_density in 0.1_f32..1.0, drag in 0.0_f32..2.0, lift in 0.0_f32..2.0,
        seconds in 1e-3_f32..0.1,
    ) -> Air {
        Air { wind, density, areal_density, drag, lift, seconds }
    }
}

/// 3 t² − 2 t³ at a depth of t times the falloff.
fn strength(depth: f64, falloff: f64) -> f64 {
    if falloff == 0.0 {
        return f64::from(u8::from(depth >= 0.0));
    }
    let t = (depth / falloff).clamp(0.0, 1.0);
    3.0 * t * t - 2.0 * t * t * t
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn a_plate_in_the_air_is_as_stated(air in airs(), u in vector(20.0), n in vector(1.0), stretched in 0.5_f32..2.0) {
        prop_assume!(n.length() > 0.1 && u.length() > 0.1);
        let n = n.normalize();
        let is = air.velocity_change(u, n, stretched).as_dvec3();
        let wanted = change(air, u.as_dvec3(), n.as_dvec3(), stretched.into());
        // A dozen operations with speeds below 35.
        prop_assert!(is.distance(wanted) < 3e-5, "{is} {wanted}");
    }

    /// A triangle's change of momentum is shared by its corners: a third of its mass each.
    #[test]
    fn triangles_share_what_the_air_gives_them(
        air in airs(), corners in [vector(1.0), vector(1.0), vector(1.0)], moved in [vector(0.1), vector(0.1), vector(0.1)],
        rest_area in 0.2_f32..1.0, inv_mass in [0.0_f32..3.0, 0.1_f32..3.0, 0.1_f32..3.0],
    ) {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        prop_assume!(normal.length() > 0.1);
        let position: Points = corners.into_iter().collect();
        let previous: Points = corners.iter().zip(moved).map(|(p, moved)| p - moved).collect();
        let mut is = Points::zeroed(3);
        drag_and_lift(&[[0, 1, 2]], &[rest_area], air, &position, &previous, 60.0, &inv_mass, &mut is);
        let velocity = (0..3).map(|i| (position.get(i).as_dvec3() - previous.get(i).as_dvec3()) * 60.0).sum::<DVec3>() / 3.0;
        let stretched = 0.5 * normal.length() / f64::from(rest_area);
        let change = change(air, velocity - air.wind.as_dvec3(), normal.normalize(), stretched);
        let third = f64::from(air.areal_density) * f64::from(rest_area) / 3.0;
        for (i, w) in inv_mass.into_iter().map(f64::from).enumerate() {
            let wanted = change * third * w / f64::from(air.seconds);
            // Velocities of 60 times a difference that is off by 10⁻⁷, of up to a third of the mass, in a thousandth of a second.
            prop_assert!(is.get(i).as_dvec3().distance(wanted) <= 5e-5 * w / f64::from(air.seconds));
        }

        let mut is = Points::zeroed(3);
        classic(&[[0, 1, 2]], air.wind, &position, &inv_mass, &mut is);
        let wind = air.wind.as_dvec3();
        let force = wind.normalize_or_zero() * wind.dot(normal.normalize()).abs() * 0.5 * normal.length();
        for (i, w) in inv_mass.into_iter().map(f64::from).enumerate() {
            let wanted = force / 3.0 * w;
            prop_assert!(is.get(i).as_dvec3().distance(wanted) < 1e-4, "{} {wanted}", is.get(i));
        }
    }

    /// The sum of the waves, each to a thousandth of its amplitude, and as strong as the place is inside.
    #[test]
    fn a_breeze_blows_as_stated(
        velocity in vector(5.0), waves in prop::option::of(prop::collection::vec((vector(1.0), vector(0.5), 0.0_f32..1.0), WAVES)),
        kind in 0..3, size in [0.5_f32..2.0, 0.5_f32..2.0, 0.5_f32..2.0], falloff in prop_oneof![Just(0.0_f32), 0.1_f32..1.0],
        turn in vector(2.0), shift in vector(1.0), places in prop::collection::vec(vector(2.0), 1..40), seconds in 0.01_f32..1.0,
    ) {
        let shape = match kind {
            0 => WindRegion::Everywhere,
            1 => WindRegion::Cuboid { half_size: size.into() },
            _ => WindRegion::Sphere { radius: size[0] },
        };
        let to_own = Isometry3d::new(shift, Quat::from_scaled_axis(turn));
        let all = waves.map(|waves| {
            let mut all = [Wave::default(); WAVES];
            for (to, (amplitude, turns, phase)) in all.iter_mut().zip(waves) {
                *to = Wave { amplitude, turns, phase };
            }
            all
        });
        let breeze = Breeze { velocity, waves: all, shape, falloff, to_own };
        let position: Points = places.iter().copied().collect();
        let mut out: Points = places.iter().map(|p| p * 0.5).collect();
        add(Level::new(), &breeze, seconds, &position, SharedPoints::new(&mut out), 0..places.len());
        let own = DMat3::from_quat(to_own.rotation.as_dquat());
        for (i, place) in places.iter().enumerate() {
            let p = place.as_dvec3();
            let (mut wanted, mut most) = (velocity.as_dvec3(), 0.0);
            for wave in all.iter().flatten() {
                let turns = wave.turns.as_dvec3().dot(p) + f64::from(wave.phase);
                wanted += wave.amplitude.as_dvec3() * (std::f64::consts::TAU * turns).sin();
                most += 1.2e-3 * f64::from(wave.amplitude.length());
            }
            let inside = own * p + shift.as_dvec3();
            let depth = match shape {
                WindRegion::Everywhere => f64::INFINITY,
                WindRegion::Cuboid { half_size } => (half_size.as_dvec3() - inside.abs()).min_element(),
                WindRegion::Sphere { radius } => f64::from(radius) - inside.length(),
            };
            prop_assume!(depth.abs() > 1e-5);
            let part = if kind == 0 { 1.0 } else { strength(depth, falloff.into()) };
            let displacement = wanted * part * f64::from(seconds);
            let is = out.get(i).as_dvec3() - (place * 0.5).as_dvec3();
            prop_assert!(is.distance(displacement) < most * f64::from(seconds) + 2e-4, "{is} {displacement}");
        }
    }
}
