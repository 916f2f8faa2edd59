//! Attachments that break.

use bevy_math::Vec3;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Path};

use crate::world::{square, vacuum};

/// Hangs a sheet by its upper edge, slowly gets heavier, and tells at which weight it fell.
fn weight_at_break(side: u32, substeps: u32, break_force: f32, edge: bool) -> f32 {
    let mut world = vacuum();
    world.record::<ClothAttachmentBroken>();
    world.settings().substeps = Some(substeps);
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(side));
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 5.0);
    let held = if edge {
        ClothAttachment::edge(ClothEdge::Top)
    } else {
        ClothAttachment::corner(ClothCorner::TopLeft)
    };
    world.settings().gravity = Vec3::NEG_Y;
    let attachment = world.attach(cloth, hand, held.with_break_force(break_force));
    world.steps(600);
    let mass = world.mass(cloth);
    for k in 0..2000 {
        let gravity = 1.0 + 0.01 * k as f32;
        world.settings().gravity = Vec3::NEG_Y * gravity;
        world.steps(1);
        if let Some(broken) = world.recorded::<ClothAttachmentBroken>().first() {
            assert_eq!(broken.entity, cloth);
            assert_eq!((broken.attachment, broken.target), (attachment, hand));
            assert_eq!(broken.reason, ClothBreakReason::Force);
            assert!(broken.force.length() > break_force);
            assert!(!world.exists(attachment));
            return mass * gravity;
        }
    }
    panic!("holds {} N", mass * 21.0);
}

#[test]
fn it_breaks_at_its_break_force_whatever_substeps_and_resolution() {
    for (side, substeps) in [(9, 6), (9, 16), (24, 8), (24, 16)] {
        let weight = weight_at_break(side, substeps, 1.0, true);
        assert!(
            (weight - 1.0).abs() < 0.003,
            "{side}, {substeps} substeps: {weight} N"
        );
    }
    // One particle carries all of it.
    let weight = weight_at_break(16, 8, 1.0, false);
    assert!((weight - 1.0).abs() < 0.003, "corner: {weight} N");
}

#[test]
fn below_its_break_force_it_is_as_good_as_rigid() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(17));
    let held = ClothAttachment::edge(ClothEdge::Top).with_break_force(20.0);
    world.attach(cloth, hand, held);
    for _ in 0..300 {
        world.steps(1);
        for i in 0..17 {
            let place = Vec3::new(i as f32 / 16.0 - 0.5, 0.5, 0.0);
            let gap = world.at(cloth, i).distance(place);
            assert!(gap < 0.2 * ClothAttachment::GIVE, "{gap} m");
        }
    }
}

#[test]
fn a_jerk_breaks_what_a_steady_pull_does_not() {
    let broke = |acceleration: f32| {
        // After a while, so that it starts from rest.
        let pull = move |t: f32| {
            let t = (t - 0.2).max(0.0);
            Transform::from_xyz(0.0, 0.0, 0.5 * acceleration * t * t)
        };
        let mut world = vacuum().without_gravity();
        let hand = world.spawn((pull(0.0), Path::new(pull)));
        let cloth = world.spawn(square(9));
        world.steps(1);
        let held = ClothAttachment::within(Vec3::ZERO, 2.0);
        // Carries the sheet's mass at 10 m/s².
        let force = 10.0 * world.mass(cloth);
        let attachment = world.attach(cloth, hand, held.with_break_force(force));
        world.steps(40);
        !world.exists(attachment)
    };
    assert!(!broke(8.0));
    assert!(broke(13.0));
}

#[test]
fn what_is_left_hangs_on() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(12));
    let weak = ClothAttachment::corner(ClothCorner::TopRight).with_break_force(0.05);
    let weak = world.attach(cloth, hand, weak);
    world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft));
    world.steps(200);
    assert!(!world.exists(weak));
    assert!(world.at(cloth, 0).distance(Vec3::new(-0.5, 0.5, 0.0)) < 1e-6);
    assert!(world.mass(cloth) * G > 0.1);
    assert!(world.stretch(cloth).max < 1e-4);
    assert!(world.fastest(cloth) < 4.0);
}
