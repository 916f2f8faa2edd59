//! A hand moves a particle to where it is; the cloth around follows without spikes, and falls when released.

use bevy::prelude::*;
use tailorbird::{cloth::topology::order::Stored, prelude::*};

use crate::world::*;

const N: usize = 16;
const HELD: usize = 8 * N + 8;

/// The largest ratio of an edge around the hand to its length at rest.
fn spike(sim: &Sim, cloth: Entity) -> f32 {
    let (particles, topology) = (sim.particles(cloth), sim.get::<ClothTopology>(cloth));
    let neighbors = topology.neighbors(Stored(HELD as u32));
    assert_eq!(neighbors.len(), 8);
    neighbors
        .iter()
        .map(|n| {
            let n = n.index();
            let rest = topology.rest_positions[n].distance(topology.rest_positions[HELD]);
            particles.position(n).distance(particles.position(HELD)) / rest
        })
        .fold(0.0, f32::max)
}

fn curtain() -> (Sim, Entity) {
    let mut sim = Sim::new();
    let cloth = sim.spawn((square(N as u32), ClothPins::corners(ClothCorner::TOP)));
    sim.seconds(1.0);
    (sim, cloth)
}

#[test]
fn the_hand_moves_the_cloth_and_release_lets_it_fall() {
    let (mut sim, cloth) = curtain();
    let start = sim.at(cloth, HELD);
    sim.edit::<ClothGrab>(cloth, |grab| grab.take(HELD as u32, 0.15, start));
    let mut worst = 0.0f32;
    let mut target = start;
    for k in 1..=30 {
        target = start + Vec3::new(0.0, 0.1, 0.25) * (k as f32 / 30.0);
        sim.edit::<ClothGrab>(cloth, |grab| grab.move_to(target));
        sim.steps(1);
        worst = worst.max(spike(&sim, cloth));
    }
    sim.steps(10);
    worst = worst.max(spike(&sim, cloth));
    println!("spike {worst}");
    assert!(worst <= 1.15, "{worst}");
    assert!(sim.at(cloth, HELD).distance(target) < 1e-5);
    assert_eq!(sim.particles(cloth).grabbed(), Some(HELD));
    for neighbor in [HELD - 1, HELD + 1, HELD - N, HELD + N] {
        assert!(
            sim.at(cloth, neighbor).z > 0.15,
            "{}",
            sim.at(cloth, neighbor)
        );
    }
    sim.edit::<ClothGrab>(cloth, ClothGrab::release);
    sim.steps(20);
    assert_eq!(sim.particles(cloth).grabbed(), None);
    assert!(sim.at(cloth, HELD).distance(target) > 0.05);
    sim.seconds(8.0);
    assert!(sim.at(cloth, HELD).distance(start) < 0.05);
}

#[test]
fn a_sudden_jump_of_the_hand_draws_no_spike() {
    let (mut sim, cloth) = curtain();
    let start = sim.at(cloth, HELD);
    sim.edit::<ClothGrab>(cloth, |grab| {
        grab.take(HELD as u32, 0.2, start + Vec3::new(0.1, 0.1, 0.3));
    });
    let mut worst = 0.0f32;
    for _ in 0..60 {
        sim.steps(1);
        worst = worst.max(spike(&sim, cloth));
    }
    println!("spike {worst}");
    assert!(worst <= 1.15, "{worst}");
    assert!(sim.all_finite(cloth));
}

#[test]
fn a_pull_far_beyond_reach_does_not_tear_the_cloth() {
    let (mut sim, cloth) = curtain();
    sim.edit::<ClothGrab>(cloth, |grab| {
        grab.take(HELD as u32, 0.1, Vec3::new(0.0, -20.0, 20.0));
    });
    let mut worst = 0.0f32;
    for _ in 0..120 {
        sim.steps(1);
        worst = worst.max(spike(&sim, cloth));
    }
    println!("spike {worst}, longest edge {}", longest_edge(&sim, cloth));
    assert!(worst <= 1.15, "{worst}");
    assert!(
        longest_edge(&sim, cloth) < 1.5,
        "{}",
        longest_edge(&sim, cloth)
    );
    // It does not fly about either.
    let fastest = sim
        .velocities(cloth)
        .iter()
        .map(|v| v.length())
        .fold(0.0, f32::max);
    assert!(fastest < 2.0, "{fastest}");
}

#[test]
fn the_hand_stays_where_it_is_while_the_entity_moves() {
    let mut sim = Sim::new().without_gravity();
    let cloth = sim.spawn(square(N as u32));
    sim.steps(1);
    let target = sim.at(cloth, HELD);
    sim.edit::<ClothGrab>(cloth, |grab| grab.take(HELD as u32, 0.1, target));
    for k in 1..=20 {
        sim.edit::<Transform>(cloth, |t| t.translation.x = 0.1 * k as f32);
        sim.steps(1);
        let error = sim.at(cloth, HELD).distance(target);
        assert!(error < 1e-5, "{k}: {error}");
    }
}

#[test]
fn a_pinned_particle_in_the_hand_stays_pinned() {
    let (mut sim, cloth) = curtain();
    let there = sim.at(cloth, 0);
    sim.edit::<ClothGrab>(cloth, |grab| grab.take(0, 0.1, there + Vec3::Z));
    sim.steps(10);
    assert_eq!(sim.at(cloth, 0), there);
}

#[test]
fn wrong_grabs_are_errors_and_leave_the_cloth_alone() {
    let (mut sim, cloth) = curtain();
    sim.record::<ClothError>();
    for (particle, target, field) in [
        (9999, Vec3::ZERO, "ClothGrab"),
        (3, Vec3::NAN, "ClothGrab.target"),
    ] {
        sim.edit::<ClothGrab>(cloth, |grab| grab.take(particle, 0.1, target));
        sim.steps(3);
        let errors = sim.errors(cloth);
        assert_eq!(errors.len(), 1);
        assert!(errors[0].to_string().starts_with(field), "{}", errors[0]);
        assert!(sim.all_finite(cloth));
        sim.edit::<ClothGrab>(cloth, ClothGrab::release);
        sim.steps(1);
        assert!(sim.errors(cloth).is_empty());
    }
    assert_eq!(sim.recorded::<ClothError>().len(), 2);
}

#[test]
fn a_hand_that_becomes_wrong_lets_the_particle_where_it_was() {
    let (mut sim, cloth) = curtain();
    let start = sim.at(cloth, HELD);
    sim.edit::<ClothGrab>(cloth, |grab| grab.take(HELD as u32, 0.1, start));
    sim.steps(5);
    sim.edit::<ClothGrab>(cloth, |grab| grab.move_to(Vec3::NAN));
    sim.steps(30);
    assert!(sim.all_finite(cloth));
    assert_eq!(sim.errors(cloth).len(), 1);
}
