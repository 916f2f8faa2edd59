//! Effect of an entity's motion on its cloth.

#![cfg(test)]

use std::f32::consts::PI;

use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{DT, G, Scene, Sheet, furthest};

/// A curtain in ordinary gravity.
fn curtain() -> Scene {
    Scene {
        size: Vec2::ONE,
        resolution: UVec2::splat(16),
        pins: ClothPins::edges([ClothEdge::Top]),
        gravity: Vec3::NEG_Y * G,
        ..Scene::default()
    }
}

/// Free particles without weight, that nothing holds together.
fn weightless() -> Scene {
    Scene {
        pins: ClothPins::default(),
        gravity: Vec3::ZERO,
        ..curtain()
    }
}

fn with(scene: &Scene, inertia: ClothInertia) -> Sheet {
    let mut sheet = Sheet::new(scene);
    sheet.change(|i: &mut ClothInertia| *i = inertia);
    sheet
}

fn drive(sheet: &mut Sheet, steps: u32, path: impl Fn(f32) -> Transform) {
    for k in 1..=steps {
        sheet.change(|at: &mut Transform| *at = path(k as f32 * DT));
        sheet.step();
    }
}

/// Starts gently, then runs in curves.
fn run(t: f32) -> Transform {
    Transform::from_xyz(4.0 * t * t, (5.0 * t).sin(), -3.0 * t)
}

fn turn(t: f32) -> Transform {
    Transform::from_rotation(Quat::from_rotation_y(6.0 * t))
}

#[test]
fn what_is_not_felt_carries_along() {
    let mut still = Sheet::new(&curtain());
    still.steps(90);
    for path in [run, turn] {
        let mut moved = with(&curtain(), ClothInertia::none());
        drive(&mut moved, 90, path);
        let distance = furthest(&still.positions(), &moved.positions());
        println!("{distance:e} m");
        assert!(distance < 1e-6, "{distance} m");
    }
    let mut felt = Sheet::new(&curtain());
    drive(&mut felt, 90, run);
    assert!(furthest(&still.positions(), &felt.positions()) > 0.1);
}

#[test]
fn a_part_of_the_way_is_felt() {
    for part in [0.0, 0.25, 0.5, 1.0] {
        let mut sheet = with(
            &weightless(),
            ClothInertia {
                linear: part,
                ..ClothInertia::default()
            },
        );
        let before = sheet.world_positions();
        drive(&mut sheet, 60, |t| Transform::from_xyz(3.0 * t, 0.0, 0.0));
        let displacement = sheet.world_positions()[100] - before[100];
        let expected = Vec3::X * 3.0 * (1.0 - part);
        assert!(
            displacement.distance(expected) < 1e-3,
            "{part}: {displacement}"
        );
        // It got there without velocity of its own.
        let speed = sheet.fastest();
        // Rounding of places of up to a metre, in an eighth of a step.
        assert!(speed < 3e-3, "{part}: {speed} m/s");
    }
}

#[test]
fn a_turn_that_carries_along_throws_outwards() {
    let omega = 6.0;
    for centrifugal in [0.0, 0.5, 1.0] {
        let mut sheet = with(
            &weightless(),
            ClothInertia {
                angular: 0.0,
                centrifugal,
                ..ClothInertia::default()
            },
        );
        // Each particle by itself.
        sheet.settings(|settings| settings.iterations = 0);
        sheet.sim.app.insert_resource(ClothWind::vacuum());
        let before = sheet.positions()[7 * 16];
        let steps = 6;
        drive(&mut sheet, steps, turn);
        let time = steps as f32 * DT;
        let displacement = sheet.positions()[7 * 16] - before;
        let expected = 0.5 * centrifugal * omega * omega * time * time * before.x.abs();
        let outward = displacement.dot(before.with_y(0.0).normalize());
        println!("{centrifugal}: {outward} of {expected} m");
        assert!((outward - expected).abs() < 0.05 * expected + 1e-5);
    }
}

#[test]
fn no_faster_than_the_limit() {
    // In its frame a cloth that is taken along at 20 m/s behaves as one at the limit.
    let at = |speed: f32, limit: f32| {
        let inertia = ClothInertia {
            max_speed: limit,
            ..ClothInertia::default()
        };
        let mut sheet = with(&curtain(), inertia);
        drive(&mut sheet, 60, |t| Transform::from_xyz(speed * t, 0.0, 0.0));
        sheet.positions()
    };
    let distance = furthest(&at(20.0, 4.0), &at(4.0, f32::INFINITY));
    assert!(distance < 1e-6, "{distance} m");

    let spun = |speed: f32, limit: f32| {
        let inertia = ClothInertia {
            max_angular_speed: limit,
            centrifugal: 0.0,
            ..ClothInertia::default()
        };
        let mut sheet = with(&curtain(), inertia);
        drive(&mut sheet, 60, |t| {
            Transform::from_rotation(Quat::from_rotation_y(speed * t))
        });
        sheet.positions()
    };
    let distance = furthest(&spun(12.0, 2.0), &spun(2.0, f32::INFINITY));
    assert!(distance < 2e-4, "{distance} m");
}

/// Teleports that were told.
#[derive(Resource, Default)]
struct Told(Vec<ClothTeleportMode>);

fn listen(sheet: &mut Sheet) {
    sheet.sim.app.init_resource::<Told>();
    sheet
        .sim
        .app
        .add_observer(|event: On<ClothTeleported>, mut told: ResMut<Told>| {
            told.0.push(event.mode);
        });
}

fn told(sheet: &Sheet) -> &[ClothTeleportMode] {
    &sheet.sim.resource::<Told>().0
}

fn far(t: &mut Transform) {
    t.translation += Vec3::new(1000.0, 5.0, 0.0);
}

#[test]
fn a_teleported_cloth_keeps_its_shape_and_motion() {
    let (mut moved, mut still) = (Sheet::new(&curtain()), Sheet::new(&curtain()));
    listen(&mut moved);
    for k in 0..60 {
        if k == 10 {
            moved.change(far);
        }
        moved.step();
        still.step();
    }
    assert_eq!(furthest(&moved.positions(), &still.positions()), 0.0);
    assert_eq!(told(&moved), [ClothTeleportMode::KeepShape]);
}

#[test]
fn a_teleported_cloth_is_reset_where_that_is_asked_for() {
    let mut sheet = with(
        &Scene {
            gravity: Vec3::NEG_Z * G,
            ..curtain()
        },
        ClothInertia {
            teleport: ClothTeleportMode::Reset,
            ..ClothInertia::default()
        },
    );
    listen(&mut sheet);
    let rest = sheet.positions();
    sheet.steps(20);
    sheet.change(far);
    sheet.step();
    let distance = furthest(&rest, &sheet.positions());
    // It has fallen for one step since.
    assert!(distance < G * DT * DT, "{distance} m");
    assert_eq!(told(&sheet), [ClothTeleportMode::Reset]);
}

#[test]
fn a_short_way_is_a_teleport_where_the_game_says_so() {
    let short = |t: &mut Transform| t.translation.x += 0.25;
    let mut still = Sheet::new(&curtain());
    still.steps(30);
    let mut dragged = Sheet::new(&curtain());
    let mut put = Sheet::new(&curtain());
    listen(&mut put);
    for sheet in [&mut dragged, &mut put] {
        sheet.steps(10);
        sheet.change(short);
    }
    put.change(|frame: &mut ClothFrame| frame.teleport(ClothTeleportMode::KeepShape));
    dragged.steps(20);
    put.steps(20);
    assert_eq!(furthest(&still.positions(), &put.positions()), 0.0);
    assert_eq!(told(&put), [ClothTeleportMode::KeepShape]);
    assert!(furthest(&still.positions(), &dragged.positions()) > 1e-3);
}

#[test]
fn a_turn_beyond_the_threshold_is_a_teleport() {
    let inertia = ClothInertia {
        teleport_angle: 1.0,
        ..ClothInertia::default()
    };
    let mut sheet = with(&weightless(), inertia);
    listen(&mut sheet);
    let before = sheet.positions();
    sheet.change(|t: &mut Transform| t.rotation = Quat::from_rotation_x(PI / 2.0));
    sheet.step();
    assert!(furthest(&before, &sheet.positions()) < 1e-5);
    assert_eq!(told(&sheet).len(), 1);
}

/// A sheet that lies on a sphere.
fn draped() -> Scene {
    Scene {
        resolution: UVec2::splat(24),
        gravity: Vec3::NEG_Z * G,
        pins: ClothPins::corners(ClothCorner::TOP),
        sphere: Some((Vec3::new(0.0, 0.0, -0.55), 0.5)),
        ..Scene::default()
    }
}

fn move_sphere(sheet: &mut Sheet, by: Transform) {
    let to = by * Transform::from_xyz(0.0, 0.0, -0.55);
    sheet.sim.move_to(sheet.sphere.unwrap(), to);
}

#[test]
fn a_body_that_is_carried_along_does_not_sweep_the_cloth_up() {
    let mut still = Sheet::new(&draped());
    still.steps(120);
    let path =
        |t: f32| Transform::from_xyz(2.0 * t, 0.0, t).with_rotation(Quat::from_rotation_z(3.0 * t));
    let mut moved = with(&draped(), ClothInertia::none());
    moved.steps(60);
    for k in 1..=60 {
        let at = path(k as f32 * DT);
        moved.change(|t: &mut Transform| *t = at);
        move_sphere(&mut moved, at);
        moved.step();
    }
    let distance = furthest(&still.positions(), &moved.positions());
    println!("{distance} m");
    // Rounding grows where a sheet lies on a sphere; a swept one is off by decimetres.
    assert!(distance < 3e-4, "{distance} m");
}

#[test]
fn a_body_that_is_teleported_with_the_cloth_does_not_sweep_it_up() {
    let inertia = ClothInertia {
        teleport_speed: 20.0,
        ..ClothInertia::default()
    };
    let mut moved = with(&draped(), inertia);
    moved.steps(60);
    let before = moved.positions();
    // 60 m/s: slow for a collider alone.
    let at = Transform::from_xyz(1.0, 0.0, 0.0);
    moved.change(|t: &mut Transform| *t = at);
    move_sphere(&mut moved, at);
    moved.step();
    let distance = furthest(&before, &moved.positions());
    let speed = moved.fastest();
    assert!(distance < 0.012 && speed < 0.8, "{distance} m, {speed} m/s");
    moved.steps(30);
    assert!(moved.stretch().p99 < 0.004);
}

#[test]
fn time_passes_as_fast_as_it_is_told_to() {
    for scale in [0.25, 1.0, 2.0, 3.5] {
        let mut sheet = Sheet::new(&Scene {
            gravity: Vec3::NEG_Y * G,
            ..weightless()
        });
        sheet.change(|material: &mut ClothMaterial| material.damping = 0.0);
        sheet.sim.app.insert_resource(ClothWind::vacuum());
        sheet.settings(|settings| settings.time_scale = scale);
        let before = sheet.positions()[0];
        sheet.steps(30);
        let fallen = before.y - sheet.positions()[0].y;
        let time = 0.5 * scale;
        let expected = 0.5 * G * time * time;
        assert!(
            (fallen - expected).abs() < 0.008 * expected,
            "{scale}: {fallen} of {expected} m"
        );
    }
    let mut sheet = Sheet::new(&curtain());
    sheet.settings(|settings| settings.time_scale = 0.0);
    let hash = sheet.hash();
    sheet.steps(10);
    assert_eq!(sheet.hash(), hash);
}

#[test]
fn a_hundred_kilometres_away_everything_is_the_same() {
    // Places that f32 can tell apart there: in steps of 1/64 m.
    let run = |offset: Vec3| {
        let mut sheet = Sheet::new(&curtain());
        let ground = Transform::from_translation(offset - Vec3::Y * 0.25);
        sheet
            .sim
            .app
            .world_mut()
            .spawn((ClothCollider::half_space(), ground));
        sheet
            .sim
            .app
            .insert_resource(ClothWind::steady(Vec3::new(1.0, 0.0, 3.0)));
        sheet.change(|frame: &mut ClothFrame| frame.teleport(ClothTeleportMode::KeepShape));
        for k in 0..120 {
            let at = Transform::from_translation(offset + Vec3::X * (k / 4) as f32 / 64.0);
            sheet.change(|t: &mut Transform| *t = at);
            sheet.step();
        }
        sheet.positions()
    };
    let distance = furthest(
        &run(Vec3::ZERO),
        &run(Vec3::new(100_000.0, 0.0, -100_000.0)),
    );
    assert_eq!(distance, 0.0);
}

#[test]
fn a_scaled_parent_makes_a_larger_cloth() {
    let mut sheet = Sheet::new(&curtain());
    let parent = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(Quat::from_rotation_y(1.0))
        .with_scale(Vec3::splat(2.5));
    let cloth = sheet.entity;
    let world = sheet.sim.app.world_mut();
    world.spawn(parent).add_child(cloth);
    sheet.steps(2);
    let positions = sheet.positions();
    let width = positions[0].distance(positions[15]);
    assert!((width - 2.5).abs() < 1e-4, "{width} m");
    let corner = sheet.get::<ClothFrame>().to_world(positions[0]);
    let expected = parent.transform_point(Vec3::new(-0.5, 0.5, 0.0));
    assert!(corner.distance(expected) < 1e-4, "{corner} {expected}");
    // The mass goes with the area.
    let mass = sheet.mass() as f32;
    let density = sheet.get::<ClothMaterial>().areal_density;
    assert!((mass / density - 6.25).abs() < 0.01, "{mass} kg");
}

#[test]
fn wrong_values_are_reported_and_the_last_valid_ones_stay() {
    let wrong: [(&str, fn(&mut ClothInertia)); 6] = [
        ("ClothInertia.linear", |i| i.linear = 1.5),
        ("ClothInertia.angular", |i| i.angular = f32::NAN),
        ("ClothInertia.centrifugal", |i| i.centrifugal = -1.0),
        ("ClothInertia.max_speed", |i| i.max_speed = f32::NAN),
        ("ClothInertia.teleport_speed", |i| i.teleport_speed = -1.0),
        ("ClothInertia.teleport_angle", |i| {
            i.teleport_angle = f32::NAN;
        }),
    ];
    for (field, change) in wrong {
        let mut sheet = with(&curtain(), ClothInertia::none());
        sheet.step();
        sheet.change(change);
        drive(&mut sheet, 30, run);
        let complaint = sheet.complaint().unwrap_or_default();
        assert!(complaint.contains(field), "{field}: {complaint}");
        let mut still = Sheet::new(&curtain());
        still.steps(31);
        assert!(furthest(&sheet.positions(), &still.positions()) < 1e-4);
        sheet.change(|inertia: &mut ClothInertia| *inertia = ClothInertia::none());
        sheet.step();
        assert_eq!(sheet.complaint(), None);
    }
    let mut sheet = Sheet::new(&curtain());
    sheet.settings(|settings| settings.time_scale = f32::NAN);
    sheet.steps(30);
    let mut still = Sheet::new(&curtain());
    still.steps(30);
    assert_eq!(furthest(&sheet.positions(), &still.positions()), 0.0);
}

#[test]
fn both_runners_feel_the_same() {
    let path = |t: f32| run(t).with_rotation(turn(t).rotation);
    let hash = |game: bool| {
        let inertia = ClothInertia {
            linear: 0.3,
            angular: 0.6,
            max_speed: 3.0,
            ..ClothInertia::default()
        };
        let mut sheet = with(&draped(), inertia);
        if game {
            sheet.sim.app.add_systems(ClothSubstep, || ());
        }
        drive(&mut sheet, 40, path);
        sheet.hash()
    };
    assert_eq!(hash(false), hash(true));
}
