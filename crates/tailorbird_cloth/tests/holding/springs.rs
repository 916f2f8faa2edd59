//! Attachments with compliance, and what everything that holds a cloth carries.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Sim};

use crate::world::{rigid, square, vacuum};

/// A sheet that hangs still by what holds it.
fn hanging(attachment: ClothAttachment, side: u32) -> (Sim, Entity, Entity) {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn((square(side), ClothPinForces::default()));
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 3.0);
    let attachment = world.attach(cloth, hand, attachment);
    world.steps(600);
    (world, cloth, attachment)
}

/// Distance of the sheet's upper corner below the point that holds it, and its weight.
fn sag(world: &Sim, cloth: Entity) -> (f32, f32) {
    (0.5 - world.at(cloth, 0).y, world.mass(cloth) * G)
}

#[test]
fn a_spring_gives_way_by_compliance_times_weight_whatever_the_resolution() {
    for (compliance, side) in [(0.05, 9), (0.05, 24), (0.005, 24)] {
        let held = ClothAttachment::edge(ClothEdge::Top).with_compliance(compliance);
        let (world, cloth, attachment) = hanging(held, side);
        let (_, weight) = sag(&world, cloth);
        // The middle of the edge: its mean.
        let edge: f32 = (0..side as usize).map(|i| 0.5 - world.at(cloth, i).y).sum();
        let mean = edge / side as f32;
        assert!(
            (mean - compliance * weight).abs() < 0.006 * compliance * weight,
            "{side}: {mean}"
        );
        let carried = world.get::<ClothAttachmentForce>(attachment).force;
        assert!(
            (carried + Vec3::Y * weight).length() < 0.007 * weight,
            "{carried} {weight}"
        );
    }
}

#[test]
fn springs_add_hardly_any_stretch() {
    let held = |compliance| {
        let held = ClothAttachment::edge(ClothEdge::Top).with_compliance(compliance);
        let (world, cloth, _) = hanging(held, 24);
        world.stretch(cloth).max
    };
    let rigid = held(0.0);
    for compliance in [1e-6, 1e-3, 0.1] {
        let soft = held(compliance);
        assert!(soft < rigid + 5e-4, "{compliance}: {soft} {rigid}");
    }
}

#[test]
fn a_spring_swings_at_its_natural_frequency() {
    // A sheet that is held as a whole is a mass at a spring: T = 2π √(m α).
    let mut world = vacuum().without_gravity();
    world.settings().substeps = Some(32);
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(6));
    let compliance = 0.2;
    let all = ClothAttachment::within(Vec3::ZERO, 2.0).with_compliance(compliance);
    world.attach(cloth, hand, all);
    world.steps(1);
    world.move_to(hand, Transform::from_xyz(0.1, 0.0, 0.0));
    let period = std::f32::consts::TAU * (world.mass(cloth) * compliance).sqrt();
    let half = (0.5 * period * 60.0).round() as u32;
    assert!((10..200).contains(&half), "{half}");
    let mut furthest = (0, 0.0);
    for step in 1..=2 * half {
        world.steps(1);
        let x = world.at(cloth, 0).x + 0.5;
        if x > furthest.1 {
            furthest = (step, x);
        }
    }
    // Implicit integration damps it.
    assert!((0.13..0.16).contains(&furthest.1), "{furthest:?}");
    assert!(furthest.0.abs_diff(half) <= 1, "{furthest:?} {half}");
}

#[test]
fn a_soft_hold_follows_softly() {
    let mut world = vacuum().without_gravity();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(6));
    let all = ClothAttachment::within(Vec3::ZERO, 2.0).with_compliance(0.05);
    world.attach(cloth, hand, all);
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 5.0);
    world.steps(1);
    let turned = Transform::from_xyz(0.2, 0.1, 0.0).with_rotation(Quat::from_rotation_z(0.5));
    world.move_to(hand, turned);
    world.steps(1);
    let expected = turned.transform_point(Vec3::new(-0.5, 0.5, 0.0));
    assert!(world.at(cloth, 0).distance(expected) > 0.05);
    world.steps(400);
    assert!(world.at(cloth, 0).distance(expected) < 2.2e-4);
}

#[test]
fn pins_carry_the_weight_of_the_sheet() {
    let holds = [
        ClothPins::edges([ClothEdge::Top]),
        ClothPins::corners(ClothCorner::TOP),
        ClothPins::corners([ClothCorner::TopLeft]),
    ];
    for (pins, solver) in holds.into_iter().flat_map(|pins| {
        [ClothSolver::Chains, ClothSolver::GaussSeidel].map(|solver| (pins.clone(), solver))
    }) {
        let mut world = vacuum();
        let (mut material, sleep) = rigid();
        material.damping = 3.0;
        let cloth = world.spawn((
            Cloth::grid(Vec2::new(1.0, 0.8), UVec2::new(25, 20)),
            (material, sleep),
            pins,
            solver,
            ClothPinForces::default(),
            // Its frame's axes are not the world's.
            Transform::from_rotation(Quat::from_rotation_y(0.7)),
        ));
        world.steps(900);
        let mut mean = Vec3::ZERO;
        for _ in 0..60 {
            world.steps(1);
            mean += world.get::<ClothPinForces>(cloth).force() / 60.0;
        }
        let weight = Vec3::NEG_Y * (world.mass(cloth) * G);
        let error = mean.distance(weight) / weight.length();
        assert!(error < 0.001, "{solver:?}: {mean} {weight}");
    }
}

#[test]
fn springs_and_pins_share_the_weight() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn((
        square(20),
        ClothPins::corners([ClothCorner::TopLeft]),
        ClothPinForces::default(),
    ));
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 3.0);
    let held = ClothAttachment::corner(ClothCorner::TopRight).with_compliance(1e-3);
    let attachment = world.attach(cloth, hand, held);
    world.steps(900);
    let pin = world.get::<ClothPinForces>(cloth).force();
    let spring = world.get::<ClothAttachmentForce>(attachment).force;
    let weight = world.mass(cloth) * G;
    assert!(
        (pin + spring + Vec3::Y * weight).length() < 0.001 * weight,
        "{pin} {spring}"
    );
    assert!((pin.y - spring.y).abs() < 0.009 * weight, "{pin} {spring}");
    assert!(pin.x > 0.0 && spring.x < 0.0, "{pin} {spring}");
}
