//! Coulomb: a sheet on a slope holds where the tangent of its angle is below the friction of the pair, the geometric mean
//! of both; above, it slides with g (sin θ − μ cos θ).

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Distance [m] that a sheet slides down a slope of this angle within a second.
fn slid(angle: f32, cloth_friction: f32, ground_friction: f32) -> f32 {
    let mut sim = Sim::vacuum();
    let slope = Quat::from_rotation_z(-angle);
    sim.spawn((
        ClothCollider::half_space().with_friction(ground_friction),
        Transform::from_rotation(slope),
    ));
    let material = ClothMaterial {
        friction: cloth_friction,
        ..undamped()
    };
    let normal = slope * Vec3::Y;
    let cloth = sim.spawn((
        square(8),
        material,
        Transform::from_translation(normal * material.thickness).with_rotation(slope * lying()),
    ));
    sim.steps(0);
    let downhill = slope * Vec3::X;
    sim.steps(1);
    let start = sim.center_of_mass(cloth).dot(downhill);
    sim.steps(59);
    sim.center_of_mass(cloth).dot(downhill) - start
}

#[test]
fn holds_below_the_angle_of_friction_and_slides_above_it() {
    // √(0.9 · 0.4) = 0.6.
    let (a, b, mu) = (0.9, 0.4, 0.6f32);
    let critical = mu.atan();
    let held = slid(critical - 0.05, a, b);
    println!("below: {held} m");
    assert!(held.abs() < 1e-3, "{held}");
    for angle in [critical + 0.05, critical + 0.2, 1.2] {
        let moved = slid(angle, a, b);
        let expected = 0.5 * G * (angle.sin() - mu * angle.cos());
        println!("{angle}: {moved} m, {expected} m expected");
        // A step of 60 is left out at the start: 2/60 of the way.
        assert!(
            (moved / expected - 1.0).abs() < 0.05,
            "{angle}: {moved} {expected}"
        );
    }
}

#[test]
fn one_slippery_surface_is_enough_to_slide() {
    let moved = slid(0.3, 0.9, 0.0);
    let expected = 0.5 * G * 0.3f32.sin();
    assert!((moved / expected - 1.0).abs() < 0.05, "{moved} {expected}");
}
