//! A pin holds a particle at its target or where it is; taken away, it lets the particle fly.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

#[test]
fn pins_hold_at_their_targets_and_the_later_one_counts() {
    let mut sim = Sim::new();
    let first = Vec3::new(-0.5, 0.6, 0.1);
    let later = Vec3::new(-0.4, 0.55, -0.1);
    let pins = ClothPins::corners([ClothCorner::TopRight])
        .with(ClothPin::at(0, first))
        .with(ClothPin::at(0, later));
    let cloth = sim.spawn((square(6), pins));
    for _ in 0..60 {
        sim.steps(1);
        assert_eq!(sim.at(cloth, 0), later);
        assert_eq!(sim.at(cloth, 5), Vec3::new(0.5, 0.5, 0.0));
    }
    assert!(sim.particles(cloth).is_pinned(0) && !sim.particles(cloth).is_pinned(1));
    assert_eq!(sim.particles(cloth).pinned().collect::<Vec<_>>(), [0, 5]);
}

#[test]
fn a_pin_in_flight_holds_the_particle_where_it_was() {
    let mut sim = Sim::new();
    let cloth = sim.spawn(square(6));
    sim.steps(20);
    let there = sim.at(cloth, 14);
    assert!(there.y < -0.1);
    sim.edit::<ClothPins>(cloth, |pins| *pins = ClothPins::particles([14]));
    for _ in 0..30 {
        sim.steps(1);
        assert_eq!(sim.at(cloth, 14), there);
    }
    // Another pin does not move it, nor does a change of the material.
    sim.edit::<ClothPins>(cloth, |pins| *pins = ClothPins::particles([0, 14]));
    sim.edit::<ClothMaterial>(cloth, |material| *material = ClothMaterial::denim());
    sim.steps(1);
    assert_eq!(sim.at(cloth, 14), there);
}

#[test]
fn what_is_released_falls_freely() {
    let mut sim = Sim::vacuum();
    let cloth = sim.spawn((square(5), undamped(), ClothPins::edges([ClothEdge::Top])));
    sim.steps(5);
    sim.edit::<ClothPins>(cloth, |pins| pins.pins.clear());
    let before = sim.weighted_mean(cloth, &sim.velocities(cloth)).y;
    sim.steps(30);
    let after = sim.weighted_mean(cloth, &sim.velocities(cloth)).y;
    // Constraints do not change the momentum; gravity gives g t.
    assert!((before - after - G * 0.5).abs() < 0.02, "{before} {after}");
}

#[test]
fn what_is_released_keeps_the_velocity_of_its_pin() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn((square(4), undamped(), ClothPins::particles(0..16)));
    sim.steps(1);
    let speed = Vec3::new(3.0, 0.0, 1.0);
    let start = sim.at(cloth, 5);
    for k in 1..=10 {
        sim.edit::<Transform>(cloth, |t| t.translation = speed * (k as f32 * DT));
        sim.steps(1);
    }
    sim.edit::<ClothPins>(cloth, |pins| pins.pins.clear());
    sim.steps(30);
    let expected = start + speed * (40.0 * DT);
    assert!(
        sim.at(cloth, 5).distance(expected) < 1e-3,
        "{}",
        sim.at(cloth, 5)
    );
}

#[test]
fn what_a_target_moved_keeps_that_velocity_when_released() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn((square(4), undamped()));
    sim.steps(1);
    let rest = sim.positions(cloth);
    let shifted = |x: f32| ClothPins {
        pins: (0..16)
            .map(|i| ClothPin::at(i as u32, rest[i] + Vec3::X * x))
            .collect(),
    };
    for k in 1..=10 {
        sim.edit::<ClothPins>(cloth, |pins| *pins = shifted(k as f32 * 0.02));
        sim.steps(1);
    }
    sim.edit::<ClothPins>(cloth, |pins| pins.pins.clear());
    sim.steps(10);
    let moved = sim.at(cloth, 5).x - rest[5].x;
    assert!((moved - 0.4).abs() < 1e-3, "{moved}");
}

#[test]
fn a_pin_out_of_range_is_an_error_and_the_others_hold() {
    let mut sim = Sim::new();
    let pins = ClothPins::corners([ClothCorner::TopLeft])
        .with(ClothPin::new(ClothSelection::Particle(999)))
        .with(ClothPin::new(ClothSelection::Cell(UVec2::new(6, 0))))
        .with(ClothPin::new(ClothSelection::Cell(UVec2::new(5, 0))));
    let cloth = sim.spawn((square(6), pins));
    sim.steps(10);
    assert_eq!(sim.particles(cloth).pinned().collect::<Vec<_>>(), [0, 5]);
    let values: Vec<u32> = sim
        .errors(cloth)
        .into_iter()
        .filter_map(|kind| match kind {
            ClothErrorKind::ParticleOutOfRange {
                value,
                particles: 36,
                ..
            } => Some(value),
            _ => None,
        })
        .collect();
    assert_eq!(values.len(), 2);
    assert_eq!(values[0], 999);
    assert!(sim.at(cloth, 0) == Vec3::new(-0.5, 0.5, 0.0));
}

#[test]
fn selections_name_the_particles_they_say() {
    let mut sim = Sim::new();
    let cloth = Cloth::grid(Vec2::new(2.0, 1.0), UVec2::new(5, 3));
    let pinned = |sim: &mut Sim, pins: ClothPins| -> Vec<usize> {
        let cloth = sim.spawn((cloth.clone(), pins));
        sim.steps(1);
        sim.particles(cloth).pinned().collect()
    };
    assert_eq!(
        pinned(&mut sim, ClothPins::corners(ClothCorner::ALL)),
        [0, 4, 10, 14]
    );
    assert_eq!(
        pinned(&mut sim, ClothPins::edges([ClothEdge::Right])),
        [4, 9, 14]
    );
    assert_eq!(
        pinned(&mut sim, ClothPins::within(Vec3::new(1.0, 0.0, 0.0), 0.5)),
        [1, 2, 3, 7]
    );
    assert_eq!(
        pinned(&mut sim, ClothPins::matching(&cloth, |p| p.y < -0.9)),
        [10, 11, 12, 13, 14]
    );
}

#[test]
fn pins_of_the_player_are_released_alone() {
    let mut pins = ClothPins::corners(ClothCorner::TOP).with(ClothPin {
        author: ClothPinAuthor::User,
        ..ClothPin::new(ClothSelection::Particle(7))
    });
    assert!(pins.has_user_pins());
    assert_eq!(pins.release_user_pins(), 1);
    assert_eq!(pins, ClothPins::corners(ClothCorner::TOP));
}
