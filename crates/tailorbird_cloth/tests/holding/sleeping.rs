//! Held cloth sleeps while what holds it stands still, and wakes when that moves.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

use crate::world::{square, vacuum};

/// A sheet that hangs by a hand and sleeps, and the hand.
fn sleeping(attachment: ClothAttachment, constraints: Option<f32>) -> (Sim, Entity, Entity) {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn((square(8), ClothMotionTargets::default()));
    if let Some(most) = constraints {
        let constraints = ClothMotionConstraints::at_most(most);
        world.insert(cloth, constraints);
    }
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 3.0);
    world.edit::<ClothSleep>(cloth, |sleep| *sleep = ClothSleep::default());
    world.attach(cloth, hand, attachment);
    for _ in 0..60 {
        world.steps(30);
        if is_asleep(&world, cloth) {
            return (world, cloth, hand);
        }
    }
    panic!("still awake after 30 s");
}

fn is_asleep(world: &Sim, cloth: Entity) -> bool {
    world.get::<ClothSleepState>(cloth).is_asleep()
}

fn holds() -> [ClothAttachment; 3] {
    let edge = ClothAttachment::edge(ClothEdge::Top);
    [
        edge.clone(),
        edge.clone().with_compliance(0.01),
        edge.with_break_force(50.0),
    ]
}

#[test]
fn it_wakes_when_its_target_moves_fast_or_creeps() {
    for held in holds() {
        for speed in [1e-2, 1e-5] {
            let (mut world, cloth, hand) = sleeping(held.clone(), None);
            let hash = world.hash(cloth);
            world.steps(10);
            assert!(is_asleep(&world, cloth) && world.hash(cloth) == hash);
            let mut steps = 0;
            while is_asleep(&world, cloth) {
                world.edit::<Transform>(hand, |at| at.translation.x += speed);
                world.steps(1);
                steps += 1;
                assert!(steps < 20, "sleeps on after {steps} steps of {speed} m");
            }
            assert!(steps as f32 * speed < 1.1e-2 && world.fastest(cloth) < 2.0);
        }
    }
}

#[test]
fn it_follows_a_target_that_creeps() {
    for held in holds() {
        for enabled in [false, true] {
            let (mut world, cloth, hand) = sleeping(held.clone(), None);
            world.edit::<ClothSleep>(cloth, |sleep| sleep.enabled = enabled);
            let places =
                |world: &Sim| -> Vec<Vec3> { (0..64).map(|i| world.at(cloth, i)).collect() };
            let before = places(&world);
            // 1 mm/s up, for 5 s.
            for _ in 0..300 {
                world.edit::<Transform>(hand, |at| at.translation.y += 1e-3 / 60.0);
                world.steps(1);
            }
            for (from, to) in before.iter().zip(places(&world)) {
                let displacement = to - *from;
                assert!(
                    displacement.distance(Vec3::Y * 5e-3) < 5e-4,
                    "{displacement} from {from}"
                );
            }
        }
    }
}

#[test]
fn it_wakes_when_the_attachment_goes_or_another_comes() {
    for held in holds() {
        let (mut world, cloth, hand) = sleeping(held, None);
        world.attach(cloth, hand, ClothAttachment::particles([60]));
        world.steps(1);
        assert!(!is_asleep(&world, cloth));
    }
    for held in holds() {
        let (mut world, cloth, hand) = sleeping(held, None);
        world.despawn(hand);
        world.steps(30);
        assert!(!is_asleep(&world, cloth) && world.at(cloth, 0).y < 0.0);
    }
}

#[test]
fn targets_that_are_set_to_where_they_are_wake_nobody_and_others_do() {
    let held = ClothAttachment::edge(ClothEdge::Top);
    let (mut world, cloth, _) = sleeping(held, Some(0.1));
    let rest = world.get::<Cloth>(cloth).rest_positions();
    let aim = |world: &mut Sim, by: f32| {
        world.edit::<ClothMotionTargets>(cloth, |targets| {
            targets.set_positions(rest.iter().map(|p| *p + Vec3::Z * by));
        });
        world.steps(1);
    };
    for _ in 0..10 {
        aim(&mut world, 0.0);
        assert!(is_asleep(&world, cloth));
    }
    let mut steps = 0;
    while is_asleep(&world, cloth) {
        steps += 1;
        aim(&mut world, 1e-5 * steps as f32);
        assert!(steps < 20);
    }
    assert!(steps > 5);
}
