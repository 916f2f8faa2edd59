//! Conservation: momentum of free sheets, energy of sheets that nothing drives.

use bevy_math::{DVec3, UVec2, Vec2, Vec3};
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet, rigid};

/// Throws a sheet without gravity, air and damping: how far momentum and angular momentum get from what they were after the
/// throw within 10 s, as parts of it.
fn drift(viscosity: f32, substeps: u32) -> [f64; 2] {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::new(24, 31),
        material: ClothMaterial {
            damping: 0.0,
            viscosity,
            ..rigid()
        },
        gravity: Vec3::ZERO,
        substeps: Some(substeps),
        ..Scene::default()
    });
    let (velocity, spin) = (Vec3::new(0.5, 0.3, -0.4), Vec3::new(2.0, 1.0, 3.0));
    let thrown: Vec<Vec3> = sheet
        .particles()
        .positions()
        // Not rigid, so that the sheet folds.
        .map(|p| velocity + spin.cross(p) + Vec3::Z * (3.0 * p.x).sin() * (2.0 * p.y).cos())
        .collect();
    sheet.change(|forces: &mut ClothForces| {
        for (i, velocity) in thrown.into_iter().enumerate() {
            forces.add_acceleration(i as u32, velocity * 60.0);
        }
    });
    sheet.step();
    let now = |sheet: &Sheet| -> [DVec3; 2] {
        let particles = sheet.particles();
        [particles.momentum(), particles.angular_momentum()].map(Vec3::as_dvec3)
    };
    let start = now(&sheet);
    let mut worst = [0.0; 2];
    for _ in 0..600 {
        sheet.step();
        for ((worst, now), start) in worst.iter_mut().zip(now(&sheet)).zip(start) {
            *worst = now.distance(start).max(*worst * start.length()) / start.length();
        }
    }
    assert_eq!(sheet.complaint(), None);
    worst
}

/// Particles that turn at ω lose ½ ω² h t of their spin in a time t to substeps of length h: a step along the tangent is pulled back to the
/// circle along the new radius, which leaves it shorter.
#[test]
fn a_thrown_sheet_keeps_its_momentum_and_loses_no_more_spin_than_its_integrator_must() {
    for viscosity in [0.0, rigid().viscosity] {
        for substeps in [4, 16] {
            let [linear, angular] = drift(viscosity, substeps);
            println!(
                "viscosity {viscosity}, {substeps} substeps: momentum {linear:.2e}, spin {angular:.2e}"
            );
            // A step's displacement, 12 mm, is shared out to the substeps and rounded to 0.5 µm in each.
            assert!(
                linear < 3.3e-3,
                "{viscosity}, {substeps}: momentum off by {linear}"
            );
            // (2² + 1² + 3²)/s² of the spin and up to 3²/s² of the folding.
            let rate = 0.5 * (14.0 + 9.0) / (60.0 * f64::from(substeps));
            let lost = 1.0 - (-rate * 10.0).exp();
            assert!(
                angular < lost,
                "{viscosity}, {substeps}: spin off by {angular}"
            );
        }
    }
}

#[test]
fn a_swinging_sheet_gains_no_energy() {
    let mut sheet = Sheet::new(&Scene {
        material: ClothMaterial {
            damping: 0.0,
            viscosity: 0.0,
            ..rigid()
        },
        ..Scene::hang(UVec2::splat(32))
    });
    let gravity = Vec3::NEG_Z * G;
    // Of a sheet that lies 2 m below the pins.
    let lowest = -sheet.mass() * f64::from(G) * 2.0;
    let energy = |sheet: &Sheet| {
        let particles = sheet.particles();
        // Where particles were half a substep ago, when they had their velocity.
        let back = gravity.dot(particles.momentum()) * 0.5 * sheet.substep_seconds();
        particles.kinetic_energy() + particles.potential_energy(gravity) + f64::from(back) - lowest
    };
    let start = energy(&sheet);
    let (mut most, mut when) = (0.0_f64, 0);
    let mut at = Vec::new();
    for step in 1..=3600 {
        sheet.step();
        let now = energy(&sheet) / start;
        if now > most {
            (most, when) = (now, step);
        }
        if step % 600 == 0 || step == 60 {
            at.push(format!("{now:.4}"));
        }
    }
    println!("most {most:.6} of the start in step {when}; after 1, 10, 20 … s: {at:?}");
    assert_eq!(sheet.complaint(), None);
    assert!(most <= 1.0 + 1e-5, "{most} of the start in step {when}");
}

/// Bending that asks for the opposite of what the edges do would become motion. Boards of few lines do gain energy (docs/limits.md).
#[test]
fn a_thrown_board_keeps_its_momentum_and_gains_no_energy() {
    for (columns, rows, stiffest) in [(3, 3, 0.1), (2, 9, 0.1), (33, 5, 0.1), (17, 17, 0.0)] {
        for bend_compliance in [stiffest, stiffest + 1e-3, 1.0] {
            for substeps in [None, Some(32)] {
                let mut board = Sheet::new(&Scene {
                    size: Vec2::ONE,
                    resolution: UVec2::new(columns, rows),
                    material: ClothMaterial {
                        bend_compliance,
                        damping: 0.0,
                        viscosity: 0.0,
                        ..rigid()
                    },
                    gravity: Vec3::ZERO,
                    substeps,
                    ..Scene::default()
                });
                let (velocity, spin) = (Vec3::new(0.5, 0.3, -0.4), Vec3::new(1.0, 0.5, 0.7));
                let wave = |p: Vec3| Vec3::Z * (5.0 * p.x + 0.3).sin() * (4.0 * p.y + 0.7).cos();
                let at = board.particles().positions();
                let thrown: Vec<Vec3> = at.map(|p| velocity + spin.cross(p) + wave(p)).collect();
                let masses = (0..thrown.len()).map(|i| board.particles().mass(i));
                let (mut energy, mut momentum, mut mass) = (0.0, Vec3::ZERO, 0.0);
                for (v, m) in thrown.iter().zip(masses) {
                    energy += 0.5 * m * v.length_squared();
                    momentum += m * *v;
                    mass += m;
                }
                board.change(|forces: &mut ClothForces| {
                    for (i, velocity) in thrown.into_iter().enumerate() {
                        forces.add_acceleration(i as u32, velocity * 60.0);
                    }
                });
                let what = format!("{columns} x {rows}, {bend_compliance}, {substeps:?}");
                let (mut most, mut off) = (0.0_f64, 0.0_f32);
                for _ in 0..300 {
                    board.step();
                    let particles = board.particles();
                    most = most.max(particles.kinetic_energy() / f64::from(energy));
                    off = off.max(
                        particles.momentum().distance(momentum) / (2.0 * mass * energy).sqrt(),
                    );
                }
                println!("{what}: energy {most:.4}, momentum off by {off:.1e}");
                assert_eq!(board.complaint(), None, "{what}");
                // Single precision: in 32 substeps of a step each place changes by little more than its last digits.
                let rounded = if substeps.is_some() { 0.08 } else { 4e-3 };
                assert!(most < 1.01 && off < rounded, "{what}: {most}, {off}");
            }
        }
    }
}
