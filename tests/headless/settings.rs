//! Pause, single steps, and changes at run time; what is invalid leaves the last valid settings in force.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

#[test]
fn paused_cloth_stands_still_and_does_single_steps() {
    let mut sim = Sim::new();
    let cloth = sim.spawn((square(6), ClothPins::corners(ClothCorner::TOP)));
    let mut free = Sim::new();
    let other = free.spawn((square(6), ClothPins::corners(ClothCorner::TOP)));
    sim.steps(10);
    free.steps(10);
    sim.settings().paused = true;
    let stands = sim.hash(cloth);
    sim.steps(5);
    assert_eq!(sim.hash(cloth), stands);
    // The two ends of the interpolation agree.
    let particles = sim.particles(cloth);
    assert_eq!(particles.points(), particles.previous_points());

    sim.settings().step_once();
    sim.settings().step_once();
    sim.steps(5);
    free.steps(2);
    assert_eq!(sim.hash(cloth), free.hash(other));
    assert_eq!(sim.settings().pending_steps, 0);
    sim.settings().paused = false;
    sim.steps(3);
    free.steps(3);
    assert_eq!(sim.hash(cloth), free.hash(other));
}

#[test]
fn cloth_that_is_spawned_while_paused_is_built_and_stands_still() {
    let mut sim = Sim::new().with_settings(|s| s.paused = true);
    let cloth = sim.spawn((square(6), ClothPins::corners(ClothCorner::TOP)));
    sim.steps(3);
    let rest = sim.get::<Cloth>(cloth).rest_positions();
    assert_eq!(sim.positions(cloth), rest);
}

#[test]
fn invalid_settings_leave_the_last_valid_ones_in_force() {
    let spoil: [fn(&mut ClothSettings); 4] = [
        |s| s.substeps = Some(0),
        |s| s.substeps = Some(u32::MAX),
        |s| s.iterations = u32::MAX,
        |s| s.gravity = Vec3::NAN,
    ];
    let run = |spoil: Option<fn(&mut ClothSettings)>| {
        let mut sim = Sim::new().with_passes(4, 3);
        let cloth = sim.spawn((square(6), ClothPins::corners([ClothCorner::TopLeft])));
        sim.steps(5);
        if let Some(spoil) = spoil {
            spoil(&mut sim.settings());
        }
        sim.steps(20);
        sim.hash(cloth)
    };
    let valid = run(None);
    for spoil in spoil {
        assert_eq!(run(Some(spoil)), valid);
    }
}

#[test]
fn invalid_settings_from_the_start_leave_the_defaults_in_force() {
    let mut sim = Sim::new().with_settings(|s| s.gravity = Vec3::NAN);
    let cloth = sim.spawn(square(6));
    sim.steps(20);
    assert!(sim.all_finite(cloth) && sim.at(cloth, 0).y < 0.4);
}

#[test]
fn without_iterations_particles_fall_freely() {
    let mut sim = Sim::vacuum().with_passes(1, 0);
    // Viscosity would pull at the particles beside the pins.
    let free = ClothMaterial {
        viscosity: 0.0,
        ..undamped()
    };
    let cloth = sim.spawn((square(4), free, ClothPins::edges([ClothEdge::Top])));
    sim.steps(30);
    let n = 30.0;
    let fallen = -G * DT * DT * n * (n + 1.0) / 2.0;
    let last = sim.at(cloth, 15).y;
    assert!((last - (-0.5 + fallen)).abs() < 1e-4, "{last}");
}

#[test]
fn a_change_of_the_substeps_keeps_the_velocity() {
    let run = |changes: &[u32]| {
        let mut sim = Sim::vacuum().with_passes(8, 2);
        let cloth = sim.spawn((square(5), undamped()));
        sim.steps(0);
        sim.edit::<ClothForces>(cloth, |forces| {
            for i in 0..25 {
                forces.add_acceleration(i, Vec3::new(2.0, 3.0, 0.0) / DT);
            }
        });
        sim.steps(1);
        for &substeps in changes {
            sim.settings().substeps = Some(substeps);
            sim.steps(10);
        }
        sim.center_of_mass(cloth)
    };
    let (steady, changed) = (run(&[8, 8, 8, 8]), run(&[3, 16, 1, 8]));
    // Symplectic Euler is off by g h t / 2 from the parabola: at most 9.81/60 · 0.67/2 m for a single substep, and less for
    // those of more; across, nothing changes.
    println!("{steady} {changed}");
    assert!((steady.x - changed.x).abs() < 1e-3);
    assert!((steady.y - changed.y).abs() < G * DT * 40.0 * DT / 2.0);
    // While it was pushed it went (1 + … + 8)/8² = 9/16 of the way of a step. What is lost or won at a change would show in x.
    let expected = 2.0 * DT * (40.0 + 9.0 / 16.0);
    assert!(
        (changed.x / expected - 1.0).abs() < 1e-3,
        "{changed} {expected}"
    );
}

#[test]
fn the_step_tells_what_is_in_force() {
    let mut sim = Sim::new().with_passes(5, 7);
    sim.steps(12);
    let step = sim.app.world().resource::<ClothStep>();
    assert_eq!((step.substeps(), step.iterations()), (5, 7));
    assert_eq!(step.steps(), 12);
    assert!((step.elapsed() - 11.0 / HZ).abs() < 1e-6);
    assert!((step.seconds() - DT).abs() < 1e-7);
}
