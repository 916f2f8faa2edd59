//! A ball on a sheet that is pinned at its edges.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

use crate::{
    engine,
    world::{Body, Form, G, HZ, World, all_edges, lying},
};

const RADIUS: f32 = 0.15;

/// A sheet of 2 m × 2 m and a ball that falls on it from 0.5 m. It is carried with any number of substeps; the heavier it is, the
/// more of them the sheet needs to lie still. The ball's damping keeps it from rolling about.
fn drop(mass: f32, substeps: u32, damping: f32, sleeps: bool) -> (World, Entity, Entity) {
    let mut world = World::earth().with_substeps(substeps);
    let sheet = world.sheet(2.0, 32, ClothMaterial::cotton(), all_edges(), lying(0.0));
    let ball = world.body(&Body {
        sleeps,
        damping,
        ..Body::new(Form::Ball(RADIUS), mass, Vec3::Y * (RADIUS + 0.5))
    });
    (world, sheet, ball)
}

/// Figures of a second of the ball's rest.
struct Rest {
    /// Mean of the force that the sheet carries the ball with \[N\].
    force: Vec3,
    /// Force on the pins by the sheet's momentum \[N\].
    pins: f32,
    /// Fastest way from step to step in this second [m/s]. The velocity itself holds what gravity takes away again in the
    /// next step.
    speed: f32,
    /// By how much the sheet's particles move from step to step, root of the mean square \[m\].
    trembling: f32,
}

fn rest(world: &mut World, sheet: Entity, ball: Entity) -> Rest {
    let particles = world.particles(sheet);
    let pinned: f32 = particles.pinned().map(|i| particles.mass(i)).sum();
    let mass = world.mass(sheet);
    let up = |world: &World| {
        let frame = world.app.world().get::<ClothFrame>(sheet).unwrap();
        frame.vector_to_world(world.particles(sheet).momentum()).y
    };
    let before = up(world);
    let (mut impulse, mut speed, mut squares) = (Vec3::ZERO, 0.0_f32, 0.0);
    let mut points = world.points(sheet);
    for _ in 0..HZ {
        let from = world.motion(ball).center;
        world.steps(1);
        impulse += world.reaction(ball).map_or(Vec3::ZERO, |r| r.impulse);
        speed = speed.max(world.motion(ball).center.distance(from) * HZ as f32);
        let now = world.points(sheet);
        let squares_of_distances = now.iter().zip(&points).map(|(a, b)| a.distance_squared(*b));
        squares += squares_of_distances.sum::<f32>() / (now.len() as f32 * HZ as f32);
        points = now;
    }
    // The pinned particles hang at nothing but their pins.
    let free = mass - pinned;
    Rest {
        force: impulse,
        pins: up(world) - before + free * G + pinned * G + impulse.y,
        speed,
        trembling: squares.sqrt(),
    }
}

#[test]
fn a_ball_comes_to_rest_on_a_sheet_and_the_pins_carry_its_weight() {
    for (mass, substeps) in [(0.5, 16), (2.0, 32), (10.0, 64)] {
        let (mut world, sheet, ball) = drop(mass, substeps, 1.5, false);
        world.seconds(8.0);
        // Damping would carry a part of the weight: engines apply it to what falls within a step, before cloth stops it.
        engine::set_damping(world.app.world_mut(), ball, 0.0);
        world.seconds(1.0);
        let rest = rest(&mut world, sheet, ball);
        let motion = world.motion(ball);
        let weight = mass * G;
        let load = weight + world.mass(sheet) * G;
        println!(
            "{mass} kg, {substeps} substeps: at {:.3}, {:.4} m/s, force {:.3} N of {weight:.3}, pins {:.3} N of {load:.3}, \
             trembling {:.2} mm",
            motion.center,
            rest.speed,
            rest.force,
            rest.pins,
            1e3 * rest.trembling
        );
        assert_eq!(world.complaint(sheet), None);
        // One of ten times the sheet's weight sways a little.
        let still = if mass < 5.0 { 0.02 } else { 0.2 };
        assert!(rest.speed < still, "{mass} kg: {} m/s", rest.speed);
        assert!((-0.6..RADIUS).contains(&motion.center.y), "{motion:?}");
        assert!(world.depth(sheet, ball) < 1e-3);
        assert!((rest.force.y / weight - 1.0).abs() < 0.02, "{}", rest.force);
        assert!((rest.pins / load - 1.0).abs() < 0.02, "{}", rest.pins);
        let aside = Vec3::new(rest.force.x, 0.0, rest.force.z).length();
        assert!(aside < 0.02 * weight, "{}", rest.force);
    }
}

#[test]
fn light_and_heavy_balls_gain_no_speed() {
    for (mass, substeps) in [(0.02, 8), (50.0, 8)] {
        let (mut world, sheet, ball) = drop(mass, substeps, 0.0, false);
        let fall = (2.0 * G * 0.5).sqrt();
        let (mut most, mut lowest) = (0.0_f32, 0.0_f32);
        for _ in 0..5 * HZ {
            world.steps(1);
            let motion = world.motion(ball);
            most = most.max(motion.velocity.length());
            lowest = lowest.min(motion.center.y);
        }
        println!("{mass} kg: at most {most:.3} m/s of {fall:.3}, lowest {lowest:.3} m");
        assert_eq!(world.complaint(sheet), None);
        // A sheet that gives way by d adds 2 g d to the square of the speed.
        let bound = (fall * fall + 2.0 * G * (RADIUS - lowest)).sqrt();
        assert!(most < 1.02 * bound, "{mass} kg: {most} of {bound} m/s");
        assert!(world.depth(sheet, ball) < 2e-3);
        assert!(lowest > -1.0, "{mass} kg at {lowest} m");
    }
}

#[test]
fn a_ball_that_may_sleep_stays_on_a_sheet_and_falls_when_the_sheet_goes() {
    let (mut world, sheet, ball) = drop(2.0, 32, 1.5, true);
    *world.app.world_mut().get_mut::<ClothSleep>(sheet).unwrap() = ClothSleep::default();
    let mut lowest = 0.0_f32;
    for _ in 0..20 * HZ {
        world.steps(1);
        lowest = lowest.min(world.motion(ball).center.y);
    }
    let before = world.motion(ball);
    println!(
        "{before:?}, lowest {lowest}, depth {}",
        world.depth(sheet, ball)
    );
    assert!(
        before.center.y > -0.6 && world.depth(sheet, ball) < 1e-3,
        "{before:?}"
    );
    world.app.world_mut().despawn(sheet);
    world.seconds(0.5);
    let fallen = world.motion(ball);
    // 1.2 m in 0.5 s, less a few steps if it has to wake.
    assert!(before.center.y - fallen.center.y > 0.9, "{fallen:?}");
}

#[test]
fn a_ball_off_the_middle_comes_to_rest() {
    let places = [
        (0.3, Vec3::new(0.2, 0.0, 0.3)),
        (1.0, Vec3::new(0.4, 0.0, 0.1)),
        (2.0, Vec3::new(-0.3, 0.0, 0.3)),
    ];
    for (mass, at) in places {
        let mut world = World::earth();
        let sheet = world.sheet(2.0, 32, ClothMaterial::cotton(), all_edges(), lying(0.0));
        let ball = world.body(&Body {
            sleeps: false,
            damping: 1.5,
            ..Body::new(Form::Ball(RADIUS), mass, at + Vec3::Y * (RADIUS + 0.1))
        });
        world.seconds(8.0);
        let from = world.motion(ball).center;
        let rest = rest(&mut world, sheet, ball);
        let motion = world.motion(ball);
        let distance = from.distance(motion.center);
        println!(
            "{mass} kg at {:.3}: moved {distance:.5} m, at most {:.4} m/s, said {:.4} m/s, force {:.3} N, trembling {:.3} mm",
            motion.center,
            rest.speed,
            motion.velocity,
            rest.force,
            1e3 * rest.trembling
        );
        assert!(distance < 2e-3, "{mass} kg rolls: {distance} m in a second");
        assert!(rest.speed < 0.01, "{mass} kg: {} m/s", rest.speed);
        // Damping takes some of what gravity gave in the last step.
        assert!(motion.velocity.length() < 0.05, "{motion:?}");
        assert!(
            (rest.force.y / (mass * G) - 1.0).abs() < 0.04,
            "{}",
            rest.force
        );
    }
}
