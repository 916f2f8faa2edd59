//! Forces act for one step and are forgotten: m a, an impulse in all, an acceleration whatever the mass.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

fn floating(material: ClothMaterial) -> (Sim, Entity) {
    let mut sim = Sim::vacuum().without_gravity().with_passes(8, 2);
    let cloth = sim.spawn((square(6), material));
    sim.steps(1);
    (sim, cloth)
}

/// Momentum that rounding adds in this many steps: in each of eight substeps, and twice for each of the eight springs
/// of each of 36 particles of 0.15 kg in all, a coordinate below half a metre is rounded; as a random walk, three times its
/// standard deviation.
fn momentum_rounding(steps: f32) -> f32 {
    let roundings = steps * 8.0 * 16.0;
    3.0 * 0.15 * (roundings / 36.0).sqrt() * rounding(0.49) / (DT / 8.0)
}

/// A step divides the velocity by rounding of coordinates below 1 m in each of its substeps.
const SPEED_ROUNDING: f32 = 1e-4;

#[test]
fn a_force_gives_mass_times_acceleration_for_one_step() {
    let (mut sim, cloth) = floating(undamped());
    let force = Vec3::new(0.3, -0.1, 0.2);
    sim.edit::<ClothForces>(cloth, |forces| forces.add_force(14, force));
    sim.steps(1);
    let expected = force * DT;
    let momentum = sim.particles(cloth).momentum();
    assert!(
        (momentum - expected).length() < momentum_rounding(1.0),
        "{momentum} {expected}"
    );
    assert!(sim.get::<ClothForces>(cloth).is_empty());
    sim.steps(20);
    let momentum = sim.particles(cloth).momentum();
    assert!(
        (momentum - expected).length() < momentum_rounding(21.0),
        "{momentum} {expected}"
    );
}

#[test]
fn an_impulse_gives_its_momentum_however_it_is_shared() {
    for (point, radius) in [
        (Vec3::new(0.1, 0.2, 0.0), 0.3),
        (Vec3::new(0.1, 0.2, 0.0), 0.01),
        (Vec3::new(0.0, 3.0, 1.0), 0.5),
        (Vec3::ZERO, 100.0),
    ] {
        let (mut sim, cloth) = floating(undamped());
        let impulse = Vec3::new(0.01, 0.03, -0.02);
        sim.edit::<ClothForces>(cloth, |forces| {
            forces.add_impulse_at_point(impulse, point, radius);
        });
        sim.steps(1);
        let momentum = sim.particles(cloth).momentum();
        assert!(
            (momentum - impulse).length() < 0.15 * SPEED_ROUNDING,
            "{radius}: {momentum}"
        );
    }
}

#[test]
fn an_acceleration_does_not_depend_on_mass() {
    for material in [ClothMaterial::silk(), ClothMaterial::rubber()] {
        let (mut sim, cloth) = floating(ClothMaterial {
            damping: 0.0,
            ..material
        });
        sim.edit::<ClothForces>(cloth, |forces| {
            for i in 0..36 {
                forces.add_acceleration(i, Vec3::X * 6.0);
            }
        });
        sim.steps(1);
        for v in sim.velocities(cloth) {
            assert!((v - Vec3::X * 0.1).length() < SPEED_ROUNDING, "{v}");
        }
    }
}

#[test]
fn forces_are_in_world_axes() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn((
        square(6),
        undamped(),
        Transform::from_xyz(5.0, 0.0, 0.0).with_rotation(Quat::from_rotation_y(1.0)),
    ));
    sim.steps(1);
    sim.edit::<ClothForces>(cloth, |forces| {
        for i in 0..36 {
            forces.add_acceleration(i, Vec3::X * 6.0);
        }
    });
    sim.steps(1);
    let v = sim.weighted_mean(cloth, &sim.velocities(cloth));
    assert!((v - Vec3::X * 0.1).length() < SPEED_ROUNDING, "{v}");
}

#[test]
fn pinned_particles_feel_no_force() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn((square(6), ClothPins::particles([14])));
    sim.steps(1);
    let there = sim.at(cloth, 14);
    sim.edit::<ClothForces>(cloth, |forces| {
        forces.add_force(14, Vec3::X * 100.0);
        forces.add_acceleration(14, Vec3::X * 100.0);
    });
    sim.steps(3);
    assert_eq!(sim.at(cloth, 14), there);
}

#[test]
fn wrong_forces_are_errors_and_the_others_act() {
    let (mut sim, cloth) = floating(undamped());
    sim.record::<ClothError>();
    sim.edit::<ClothForces>(cloth, |forces| {
        forces.add_force(36, Vec3::X);
        forces.add_force(1, Vec3::NAN);
        forces.add_acceleration(2, Vec3::INFINITY);
        forces.add_impulse_at_point(Vec3::NAN, Vec3::ZERO, 0.1);
        forces.add_impulse_at_point(Vec3::X, Vec3::NAN, 0.1);
        forces.add_impulse_at_point(Vec3::X * 0.01, Vec3::ZERO, f32::NAN);
        for i in 0..36 {
            forces.add_acceleration(i, Vec3::X * 6.0);
        }
    });
    sim.steps(1);
    assert!(sim.all_finite(cloth));
    let errors = sim.errors(cloth);
    assert_eq!(errors.len(), 6, "{errors:?}");
    assert!(matches!(
        errors[0],
        ClothErrorKind::ParticleOutOfRange {
            value: 36,
            particles: 36,
            ..
        }
    ));
    assert_eq!(sim.recorded::<ClothError>().len(), 6);
    let v = sim.weighted_mean(cloth, &sim.velocities(cloth));
    assert!((v - Vec3::X * 0.1).length() < 2.0 * SPEED_ROUNDING, "{v}");
    // The forces are gone, and with them what was wrong.
    sim.steps(1);
    assert!(sim.errors(cloth).is_empty());
}
