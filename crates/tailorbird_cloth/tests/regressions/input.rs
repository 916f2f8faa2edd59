//! Bugs of what comes from outside: pins, transforms, colliders, time.

use std::time::Duration;

use bevy_app::Update;
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, UVec2, Vec2, Vec3};
use bevy_time::{Time, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{DT, Scene, Sheet, Sim, external, rigid};

/// The velocities of all particles after each substep [m/s].
#[derive(Resource, Default)]
struct Substeps(Vec<Vec<Vec3>>);

fn note(mut substeps: ResMut<Substeps>, cloth: Single<&ClothParticles>) {
    let velocities = (0..cloth.len()).map(|i| cloth.velocity(i));
    substeps.0.push(velocities.collect());
}

/// A sheet of half a metre without gravity, of which each substep is noted.
fn noted(pins: ClothPins) -> Sheet {
    let mut sheet = Sheet::new(&Scene {
        size: Vec2::splat(0.5),
        resolution: UVec2::splat(9),
        gravity: Vec3::ZERO,
        pins,
        ..Scene::default()
    });
    sheet.sim.app.init_resource::<Substeps>();
    let stage = note.after(ClothSubstepSystems::Collide);
    sheet.sim.app.add_systems(ClothSubstep, stage);
    sheet
}

const SPEED: f32 = 10.0;

/// In each substep of every step the same speed, not all of it in the first one.
#[test]
fn a_velocity_spike_when_a_kinematic_vertex_is_applied_only_in_the_first_substep() {
    // Pins that the game moves.
    let mut sheet = noted(ClothPins::edges([ClothEdge::Top]));
    let rest: Vec<Vec3> = sheet.particles().positions().take(9).collect();
    for step in 1..=20u8 {
        let displacement = Vec3::X * SPEED * DT * f32::from(step);
        let pins = (0..)
            .zip(&rest)
            .map(|(i, p)| ClothPin::at(i, *p + displacement));
        let pins = pins.collect();
        sheet.change(|held: &mut ClothPins| held.pins = pins);
        sheet.step();
    }
    let substeps = &sheet.sim.resource::<Substeps>().0;
    assert!(substeps.len() >= 120);
    for (k, velocities) in substeps.iter().enumerate() {
        for v in &velocities[..9] {
            assert!((*v - Vec3::X * SPEED).length() < 1e-4, "{k}: {v}");
        }
    }

    // Colliders that push the whole sheet.
    let up = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    for (collider, rotation) in [
        (ClothCollider::cuboid(2.0, 2.0, 0.2), Quat::IDENTITY),
        (ClothCollider::cylinder(1.0, 0.2), up),
        (ClothCollider::half_space(), up),
    ] {
        let mut sheet = noted(ClothPins::default());
        let name = format!("{:?}", collider.shape);
        let mut at = Transform::from_xyz(0.0, 0.0, -0.5).with_rotation(rotation);
        let plate = sheet.sim.spawn((collider, at));
        for _ in 0..30 {
            sheet.step();
            at.translation.z += SPEED * DT;
            sheet.sim.move_to(plate, at);
        }
        let substeps = &sheet.sim.resource::<Substeps>().0;
        let (early, late) = substeps.split_at(substeps.len() / 2);
        for v in early.iter().flatten() {
            assert!(v.length() < 1.001 * SPEED, "{name}: {v}");
        }
        for (k, velocities) in late.iter().enumerate() {
            for v in velocities {
                assert!((*v - Vec3::Z * SPEED).length() < 4e-4, "{name}, {k}: {v}");
            }
        }
    }
}

/// A plate that carries a sheet stops, or moves in every second step alone: its last motion must not go on.
#[test]
fn the_last_motion_replayed_when_no_new_input_comes() {
    for steps_per_move in [1, 2] {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(9),
            ..Scene::default()
        });
        let plate = ClothCollider::cuboid(4.0, 4.0, 0.2).with_friction(2.0);
        let mut at = Transform::from_xyz(0.0, 0.0, -0.11);
        let plate = sheet.sim.spawn((plate, at));
        sheet.steps(60);
        let middle = |sheet: &Sheet| sheet.particles().position(40);
        let start = middle(&sheet);
        // 0.12 m/s, which friction gives the sheet within a step.
        for _ in 0..20 {
            at.translation.x += 0.002;
            sheet.sim.move_to(plate, at);
            sheet.steps(steps_per_move);
        }
        let carried = middle(&sheet).x - start.x;
        assert!((carried - 0.04).abs() < 9e-4, "{carried}");
        sheet.steps(60);
        let moved = middle(&sheet).x - start.x - carried;
        assert!(moved.abs() < 9e-4, "{moved}");
        assert!(sheet.speed() < 1e-4, "{}", sheet.speed());
    }
}

#[test]
fn the_cloth_vanishing_after_an_extreme_move() {
    let mut sheet = Sheet::new(&Scene {
        gravity: Vec3::NEG_Y * 9.81,
        ..Scene::hang(UVec2::splat(24))
    });
    let ball = ClothCollider::sphere(0.3);
    let beside = Transform::from_xyz(0.0, 0.0, -0.35);
    let ball = sheet.sim.spawn((ball, beside));
    let plate = sheet.sim.spawn(());
    sheet.steps(30);
    for far in [10.0f32, 1e2, 1e4, 1e6] {
        let there = Transform::from_xyz(far, -far, 0.5 * far).with_rotation(Quat::from_euler(
            bevy_math::EulerRot::XYZ,
            2.0,
            1.0,
            0.5,
        ));
        for (step, at) in [there, Transform::IDENTITY, there, Transform::IDENTITY]
            .into_iter()
            .enumerate()
        {
            sheet.sim.move_to(sheet.entity, at);
            sheet.sim.move_to(
                ball,
                if step % 2 == 0 {
                    Transform::from_translation(Vec3::splat(-far))
                } else {
                    beside
                },
            );
            // Something that is told to go through the sheet within a step, which nothing stops.
            let aside = |z: f32| Isometry3d::from_translation(Vec3::new(0.3, 0.2, z));
            let displacement = far.min(1e4);
            let mut colliders = sheet.sim.resource_mut::<ClothExternalColliders>();
            colliders.push(external(
                plate,
                ClothColliderShape::Cuboid {
                    size: Vec3::new(0.8, 0.6, 0.02),
                },
                [aside(-displacement), aside(displacement)],
                None,
            ));
            sheet.step();
            assert_eq!(sheet.complaint(), None, "{far} m, step {step}");
        }
    }
    sheet.steps(600);
    assert_eq!(sheet.complaint(), None);
    let stretch = sheet.stretch();
    assert!(stretch.mean < 2e-5 && stretch.p99 < 2e-4, "{stretch:?}");
    let furthest = sheet.particles().positions().map(Vec3::length);
    let furthest = furthest.fold(0.0, f32::max);
    assert!(furthest < 2.0, "{furthest}");
}

/// In `Update`, frames of any length: velocity is carried on as a velocity, not as the way of the frame before.
#[test]
fn motion_depending_on_dt_squared() {
    const FRAMES: [f32; 5] = [30.0, 144.0, 60.0, 20.0, 100.0];
    for pushed in [false, true] {
        let mut sim = Sim::stepping_in(Update).without_gravity();
        sim.app.insert_resource(ClothWind::vacuum());
        let cloth = Cloth::grid(Vec2::splat(0.5), UVec2::splat(7)).centered();
        let material = ClothMaterial {
            damping: 0.0,
            ..rigid()
        };
        let entity = sim.spawn((cloth, material, ClothSleep::never()));
        sim.set_frame(Duration::ZERO);
        sim.frames(0);
        let plate = pushed.then(|| {
            let place = Transform::from_xyz(0.0, 0.0, -0.11);
            let plate = ClothCollider::cuboid(2.0, 2.0, 0.2);
            sim.spawn((plate, place))
        });
        let heights =
            |sim: &Sim| -> Vec<f32> { sim.particles(entity).positions().map(|p| p.z).collect() };
        let mut before = heights(&sim);
        for frame in 0..100 {
            let seconds = 1.0 / FRAMES[frame % 5];
            sim.set_frame(Duration::from_secs_f32(seconds));
            if let Some(plate) = plate {
                // The plate goes on for half of the time.
                if frame < 50 {
                    sim.shift(plate, Vec3::Z * 3.0 * seconds);
                }
            } else if frame == 0 {
                sim.edit(entity, |forces: &mut ClothForces| {
                    for i in 0..49 {
                        forces.add_acceleration(i, Vec3::Z * 3.0 / seconds);
                    }
                });
            }
            sim.frames(1);
            assert!(sim.resource::<Time<Virtual>>().delta_secs() > 0.0);
            let now = heights(&sim);
            if frame > 5 {
                for (to, from) in now.iter().zip(&before) {
                    let speed = (to - from) / seconds;
                    assert!(
                        (speed - 3.0).abs() < 2e-4,
                        "pushed: {pushed}, frame {frame}: {speed} m/s"
                    );
                }
            }
            before = now;
        }
    }
}
