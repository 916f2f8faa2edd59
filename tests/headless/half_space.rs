//! No particle is ever below a half-space, whatever both do.

use bevy::prelude::*;
use proptest::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Coordinates are rounded in the cloth's frame, when they are pushed out, on the way to the world, and here \[parts of the largest\].
const ROUNDING: f32 = 10.0 * f32::EPSILON;
/// Least value that passes for the largest \[m\].
const LEAST: f32 = 2.5;

fn vector(range: f32) -> impl Strategy<Value = Vec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

/// Depth of the deepest particle \[m\], and how much of it may be rounding.
fn deepest(sim: &Sim, cloth: Entity, plane: Transform) -> (f32, f32) {
    let thickness = sim.get::<ClothMaterial>(cloth).thickness;
    let normal = plane.rotation * Vec3::Y;
    let positions = sim.positions(cloth);
    let depths = positions
        .iter()
        .map(|p| thickness - normal.dot(*p - plane.translation));
    let depth = depths.fold(f32::NEG_INFINITY, f32::max);
    let sizes = positions.iter().map(|p| p.length());
    (depth, ROUNDING * sizes.fold(LEAST, f32::max))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_particle_is_below_after_a_drop(
        offset in vector(0.5),
        tilt in vector(0.6),
        turn in vector(3.0),
        speed in vector(20.0),
        substeps in 1u32..=8,
    ) {
        // Some begin inside.
        let at_once = |s: &mut ClothSettings| s.overlap_speed = f32::INFINITY;
        let mut sim = Sim::new().with_passes(substeps, 2).with_settings(at_once);
        let plane = Transform::from_translation(offset)
            .with_rotation(Quat::from_scaled_axis(tilt));
        sim.spawn((ClothCollider::half_space(), plane));
        let cloth = sim.spawn((
            square(8),
            Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_scaled_axis(turn)),
        ));
        sim.steps(0);
        sim.edit::<ClothForces>(cloth, |forces| {
            for i in 0..64 {
                forces.add_acceleration(i, speed / DT);
            }
        });
        for _ in 0..10 {
            sim.steps(2);
            let (depth, rounding) = deepest(&sim, cloth, plane);
            prop_assert!(depth <= rounding, "{depth:e} m below, {rounding:e} allowed");
        }
    }
}

#[test]
fn a_rising_floor_lifts_the_cloth() {
    for substeps in [1, 8] {
        let mut sim = Sim::new().with_passes(substeps, 2);
        let floor = sim.spawn((
            ClothCollider::half_space(),
            Transform::from_xyz(0.0, -0.2, 0.0),
        ));
        let cloth = sim.spawn((square(8), Transform::from_rotation(lying())));
        for k in 0..20 {
            let plane = Transform::from_xyz(0.0, -0.2 + 20.0 * k as f32 * DT, 0.0);
            sim.edit::<Transform>(floor, |t| *t = plane);
            sim.steps(1);
            let (depth, rounding) = deepest(&sim, cloth, plane);
            assert!(
                depth <= rounding,
                "{substeps}: {depth:e}, {rounding:e} allowed"
            );
        }
    }
}
