//! Bugs of what comes from outside: pins, transforms, colliders, time.

use std::time::Duration;

use bevy_app::{App, TaskPoolPlugin, Update};
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, UVec2, Vec2, Vec3};
use bevy_time::{Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::scene::{Scene, Sheet, rigid};

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
    sheet.app.init_resource::<Substeps>();
    let stage = note.after(ClothSubstepSystems::Collide);
    sheet.app.add_systems(ClothSubstep, stage);
    sheet
}

const SPEED: f32 = 10.0;
const DT: f32 = 1.0 / 60.0;

/// In each substep of every step the same speed, not all of it in the first one.
#[test]
fn a_velocity_spike_when_a_kinematic_vertex_is_applied_only_in_the_first_substep() {
    // Pins that the game moves.
    let mut sheet = noted(ClothPins::edges([ClothEdge::Top]));
    let rest: Vec<Vec3> = sheet.particles().positions().take(9).collect();
    for step in 1..=20u8 {
        let way = Vec3::X * SPEED * DT * f32::from(step);
        let pins = (0..).zip(&rest).map(|(i, p)| ClothPin::at(i, *p + way));
        let pins = pins.collect();
        sheet.change(|held: &mut ClothPins| held.pins = pins);
        sheet.step();
    }
    let substeps = &sheet.app.world().resource::<Substeps>().0;
    assert!(substeps.len() >= 120);
    for (k, velocities) in substeps.iter().enumerate() {
        for v in &velocities[..9] {
            assert!((*v - Vec3::X * SPEED).length() < 0.01, "{k}: {v}");
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
        let plate = sheet.app.world_mut().spawn((collider, at)).id();
        for _ in 0..30 {
            sheet.step();
            at.translation.z += SPEED * DT;
            *sheet.app.world_mut().get_mut(plate).expect("a plate") = at;
        }
        let substeps = &sheet.app.world().resource::<Substeps>().0;
        let (early, late) = substeps.split_at(substeps.len() / 2);
        for v in early.iter().flatten() {
            assert!(v.length() < 1.01 * SPEED, "{name}: {v}");
        }
        for (k, velocities) in late.iter().enumerate() {
            for v in velocities {
                assert!((*v - Vec3::Z * SPEED).length() < 0.1, "{name}, {k}: {v}");
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
        let plate = sheet.app.world_mut().spawn((plate, at)).id();
        sheet.steps(60);
        let middle = |sheet: &Sheet| sheet.particles().position(40);
        let start = middle(&sheet);
        // 0.12 m/s, which friction gives the sheet within a step.
        for _ in 0..20 {
            at.translation.x += 0.002;
            *sheet.app.world_mut().get_mut(plate).expect("a plate") = at;
            sheet.steps(steps_per_move);
        }
        let carried = middle(&sheet).x - start.x;
        assert!((carried - 0.04).abs() < 0.003, "{carried}");
        sheet.steps(60);
        let moved = middle(&sheet).x - start.x - carried;
        assert!(moved.abs() < 0.003, "{moved}");
        assert!(sheet.speed() < 0.01, "{}", sheet.speed());
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
    let ball = sheet.app.world_mut().spawn((ball, beside)).id();
    let plate = sheet.app.world_mut().spawn_empty().id();
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
            *sheet.app.world_mut().get_mut(sheet.entity).expect("there") = at;
            *sheet.app.world_mut().get_mut(ball).expect("there") = if step % 2 == 0 {
                Transform::from_translation(Vec3::splat(-far))
            } else {
                beside
            };
            // Something that is told to go through the sheet within a step, which nothing stops.
            let aside = |z: f32| Isometry3d::from_translation(Vec3::new(0.3, 0.2, z));
            let way = far.min(1e4);
            let mut external = sheet
                .app
                .world_mut()
                .resource_mut::<ClothExternalColliders>();
            external.push(ClothExternalCollider {
                entity: plate,
                part: 0,
                shape: ClothColliderShape::Cuboid {
                    size: Vec3::new(0.8, 0.6, 0.02),
                },
                friction: 0.5,
                margin: 0.0,
                layers: ClothLayers::ALL,
                start: aside(-way),
                end: aside(way),
                body: None,
            });
            sheet.step();
            assert_eq!(sheet.complaint(), None, "{far} m, step {step}");
        }
    }
    sheet.steps(600);
    assert_eq!(sheet.complaint(), None);
    let stretch = sheet.stretch();
    assert!(stretch.mean < 2e-3 && stretch.p99 < 2e-2, "{stretch:?}");
    let furthest = sheet.particles().positions().map(Vec3::length);
    let furthest = furthest.fold(0.0, f32::max);
    assert!(furthest < 3.5, "{furthest}");
}

/// In `Update`, frames of any length: velocity is carried on as a velocity, not as the way of the frame before.
#[test]
fn motion_depending_on_dt_squared() {
    const FRAMES: [f32; 5] = [30.0, 144.0, 60.0, 20.0, 100.0];
    for pushed in [false, true] {
        let mut app = App::new();
        app.add_plugins((
            TaskPoolPlugin::default(),
            TimePlugin,
            ClothPlugin::new(Update),
        ))
        .insert_resource(ClothWind::vacuum())
        .insert_resource(ClothSettings {
            gravity: Vec3::ZERO,
            ..ClothSettings::default()
        })
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        let cloth = Cloth::grid(Vec2::splat(0.5), UVec2::splat(7)).centered();
        let material = ClothMaterial {
            damping: 0.0,
            ..rigid()
        };
        let entity = app
            .world_mut()
            .spawn((cloth, material, ClothSleep::never()))
            .id();
        app.finish();
        app.cleanup();
        app.update();
        let plate = pushed.then(|| {
            let place = Transform::from_xyz(0.0, 0.0, -0.11);
            let plate = ClothCollider::cuboid(2.0, 2.0, 0.2);
            app.world_mut().spawn((plate, place)).id()
        });
        let heights = |app: &App| -> Vec<f32> {
            let particles = app.world().get::<ClothParticles>(entity).expect("there");
            particles.positions().map(|p| p.z).collect()
        };
        let mut before = heights(&app);
        for frame in 0..100 {
            let seconds = 1.0 / FRAMES[frame % 5];
            app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
                seconds,
            )));
            if let Some(plate) = plate {
                let mut at = app.world_mut().get_mut::<Transform>(plate);
                // The plate goes on for half of the time.
                if let Some(at) = at.as_mut().filter(|_| frame < 50) {
                    at.translation.z += 3.0 * seconds;
                }
            } else if frame == 0 {
                let mut forces = app.world_mut().get_mut::<ClothForces>(entity).expect("it");
                for i in 0..49 {
                    forces.add_acceleration(i, Vec3::Z * 3.0 / seconds);
                }
            }
            app.update();
            assert!(app.world().resource::<Time<Virtual>>().delta_secs() > 0.0);
            let now = heights(&app);
            if frame > 5 {
                for (to, from) in now.iter().zip(&before) {
                    let speed = (to - from) / seconds;
                    assert!(
                        (speed - 3.0).abs() < 0.03,
                        "pushed: {pushed}, frame {frame}: {speed} m/s"
                    );
                }
            }
            before = now;
        }
    }
}
