//! Pins move with the entity; free particles keep their place in the world. How far the entity is from the world's origin
//! does not matter.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// A tumbling path.
fn path(step: usize) -> Transform {
    let t = step as f32 * DT;
    Transform::from_xyz(2.0 * t, (3.0 * t).sin() * 0.3, -t)
        .with_rotation(Quat::from_scaled_axis(Vec3::new(0.5, 1.5, -0.7) * t))
}

#[test]
fn pins_move_with_the_entity() {
    let mut sim = Sim::new();
    let cloth = sim.spawn((square(8), ClothPins::corners(ClothCorner::TOP), path(0)));
    for k in 0..60 {
        sim.edit::<Transform>(cloth, |t| *t = path(k));
        sim.steps(1);
        let rest = sim.get::<Cloth>(cloth).rest_positions();
        for pin in [0, 7] {
            // In the frame exactly, in the world up to rounding of coordinates of a few metres.
            assert_eq!(sim.particles(cloth).position(pin), rest[pin]);
            let expected = path(k).transform_point(rest[pin]);
            let error = sim.at(cloth, pin).distance(expected);
            assert!(error < 4.0 * rounding(4.0), "step {k}: {error:e}");
        }
    }
}

#[test]
fn a_free_cloth_stays_where_it_is_in_the_world() {
    let mut sim = Sim::vacuum().without_gravity().with_passes(8, 2);
    let cloth = sim.spawn((square(6), undamped(), path(0)));
    sim.steps(1);
    let start = sim.positions(cloth);
    for k in 1..=60 {
        sim.edit::<Transform>(cloth, |t| *t = path(k));
        sim.steps(1);
    }
    // Each of 480 substeps rounds coordinates of up to 2.5 m in the frame, on three axes, and Verlet keeps it as velocity:
    // a random walk of a random walk.
    let allowed = 3.0 * rounding(2.5) * (480f32).powf(1.5);
    let error = sim
        .positions(cloth)
        .iter()
        .zip(start)
        .map(|(p, q)| p.distance(q))
        .fold(0.0, f32::max);
    println!("moved by {error:e} m of {allowed:e} m");
    assert!(error < allowed, "{error:e} {allowed:e}");
}

#[test]
fn ten_kilometres_from_the_origin_nothing_changes() {
    let run = |offset: Vec3| {
        let mut sim = Sim::new();
        sim.app
            .insert_resource(ClothWind::steady(Vec3::new(1.0, 0.0, 3.0)));
        let place = Transform::from_translation(offset);
        sim.spawn((
            ClothCollider::half_space(),
            Transform::from_translation(offset - Vec3::Y * 0.4),
        ));
        let cloth = sim.spawn((square(10), ClothPins::corners(ClothCorner::TOP), place));
        sim.seconds(2.0);
        let particles = sim.particles(cloth);
        particles.positions().collect::<Vec<_>>()
    };
    let (here, there) = (run(Vec3::ZERO), run(Vec3::new(10_000.0, 0.0, -10_000.0)));
    let error = here
        .iter()
        .zip(there)
        .map(|(p, q)| p.distance(q))
        .fold(0.0, f32::max);
    println!("differs by {error:e} m");
    // The frame takes the distance out. World coordinates there are in steps of 1 mm.
    assert!(error < 1e-3, "{error:e}");
}

#[test]
fn a_moving_start_gives_no_spike() {
    for speed in [5.0, 20.0] {
        let mut sim = Sim::vacuum().without_gravity();
        let cloth = sim.spawn((square(8), ClothPins::edges([ClothEdge::Top])));
        sim.steps(1);
        let mut fastest = 0.0f32;
        for k in 1..=20 {
            sim.edit::<Transform>(cloth, |t| t.translation.x = speed * k as f32 * DT);
            sim.steps(1);
            let velocities = sim.velocities(cloth);
            fastest = velocities
                .iter()
                .map(|v| v.length())
                .fold(fastest, f32::max);
        }
        println!("{speed} m/s: {fastest} m/s");
        // A rope that is pulled at one end cracks: its end swings to at most some times the speed of the hand.
        assert!(fastest < 3.0 * speed, "{speed}: {fastest}");
        assert!(longest_edge(&sim, cloth) < 1.3);
    }
}

#[test]
fn a_turning_entity_keeps_its_shape() {
    // The scale that is read back from a rotated transform is off by rounding: not a reason to build the cloth anew.
    let mut sim = Sim::new();
    let scale = Vec3::new(1.1, 0.9, 1.3);
    let cloth = sim.spawn((
        square(8),
        ClothPins::corners(ClothCorner::TOP),
        path(0).with_scale(scale),
    ));
    sim.steps(30);
    let revision = sim.get::<ClothTopology>(cloth).revision;
    for k in 0..60 {
        sim.edit::<Transform>(cloth, |t| *t = path(k).with_scale(scale));
        sim.steps(1);
    }
    assert_eq!(sim.get::<ClothTopology>(cloth).revision, revision);
}

#[test]
fn a_wind_blows_along_world_axes_while_the_entity_turns() {
    let mut sim = Sim::new().without_gravity();
    sim.app.insert_resource(ClothWind {
        model: ClothWindModel::Classic,
        ..ClothWind::steady(Vec3::Y * 5.0)
    });
    let cloth = sim.spawn((
        Cloth::grid(Vec2::ONE, UVec2::splat(4)).centered(),
        undamped(),
        Transform::from_rotation(lying()),
    ));
    sim.steps(1);
    for k in 1..=10 {
        // 12 rad/s about the wind's axis and another.
        sim.edit::<Transform>(cloth, |t| {
            t.rotation = Quat::from_scaled_axis(Vec3::new(0.0, 0.0, 0.2) * k as f32) * lying();
        });
        sim.steps(1);
    }
    let v = sim.weighted_mean(cloth, &sim.velocities(cloth));
    assert!(v.y > 0.0 && v.x.abs() < 1e-3 * v.y, "{v}");
}
