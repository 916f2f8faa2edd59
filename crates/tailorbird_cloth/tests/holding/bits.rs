//! The same bits with any number of threads, any instruction set, and with a game's systems between the stages.

use bevy_ecs::{prelude::*, schedule::Schedules};
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Path, Sim, child};

use crate::world::{rigid, vacuum};

fn dance(t: f32) -> Transform {
    Transform::from_xyz((5.0 * t).sin(), 0.0, (3.0 * t).sin())
        .with_rotation(Quat::from_rotation_y(4.0 * t))
}

/// Everything at once: springs, rigid holds, targets that move with the frame, a backstop.
fn everything(world: &mut Sim, size: UVec2) -> Entity {
    let hand = world.spawn((dance(0.0), Path::new(dance)));
    let limits = (0..size.element_product()).map(|i| if i % 97 == 3 { 0.0 } else { 0.3 });
    let cloth = world.spawn((
        Cloth::grid(Vec2::ONE, size),
        rigid(),
        dance(0.0),
        Path::new(|t| dance(0.5 * t)),
        ClothMotionConstraints::at_most(limits.collect::<Vec<_>>()).with_backstop(0.05, 0.7),
        ClothPinForces::default(),
    ));
    world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft));
    let soft = ClothAttachment::edge(ClothEdge::Right).with_compliance(1e-3);
    world.attach(cloth, hand, soft);
    let breaks = ClothAttachment::corner(ClothCorner::BottomLeft).with_break_force(3.0);
    world.attach(cloth, hand, breaks);
    cloth
}

fn hash(world: &mut Sim, size: UVec2, steps: u32) -> u64 {
    let cloth = everything(world, size);
    world.steps(steps);
    assert!(world.complaints(cloth).is_empty());
    let force = world.get::<ClothPinForces>(cloth).force();
    world.hash(cloth) ^ u64::from(force.length().to_bits())
}

#[derive(Resource, Default)]
struct Calls(u32);

#[test]
fn systems_of_a_game_between_the_stages_change_nothing() {
    let size = UVec2::new(17, 21);
    let bits = |with_system: bool| {
        let mut world = vacuum();
        world.app.init_resource::<Calls>();
        if with_system {
            world
                .app
                .add_systems(ClothSubstep, |mut calls: ResMut<Calls>| calls.0 += 1);
        }
        let hash = hash(&mut world, size, 60);
        assert_eq!(world.resource::<Calls>().0 > 0, with_system);
        hash
    };
    assert_eq!(bits(true), bits(false));
}

/// Systems in other orders, within what they ask for.
#[test]
fn the_order_of_systems_that_ask_for_none_does_not_matter() {
    let size = UVec2::new(17, 21);
    let bits = hash(&mut vacuum(), size, 60);
    for seed in 0..10 {
        let mut world = vacuum();
        let mut schedules = world.resource_mut::<Schedules>();
        for (_, schedule) in schedules.iter_mut() {
            let mut settings = schedule.get_build_settings();
            settings.shuffle_seed = Some(seed);
            schedule.set_build_settings(settings);
        }
        assert_eq!(hash(&mut world, size, 60), bits, "seed {seed}");
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let bits = |instruction_set| {
        let mut world = vacuum();
        world.settings().instruction_set = instruction_set;
        hash(&mut world, UVec2::new(19, 13), 60)
    };
    let scalar = bits(ClothInstructionSet::Scalar);
    for set in [
        ClothInstructionSet::Sse2,
        ClothInstructionSet::Avx2,
        ClothInstructionSet::Avx512,
        ClothInstructionSet::Auto,
    ] {
        assert_eq!(bits(set), scalar, "{set:?}");
    }
}

/// Not a test: in a process of its own, as a process has one set of threads, this simulates and prints the bits.
#[test]
fn as_a_child() {
    let Some(threads) = child::threads() else {
        return;
    };
    let mut world = Sim::with_threads(Some(threads)).started();
    world.app.insert_resource(ClothWind::vacuum());
    // Large enough for several threads at one.
    let large = hash(&mut world, UVec2::new(131, 150), 30);
    child::tell(large);
    let cloths: Vec<Entity> = (0..40)
        .map(|_| everything(&mut world, UVec2::new(21, 23)))
        .collect();
    world.steps(30);
    for cloth in cloths {
        child::tell(world.hash(cloth));
    }
}

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let bits = |threads| child::bits("bits::as_a_child", threads);
    let one = bits(1);
    assert_eq!(one.len(), 41);
    assert!(one[1..].iter().all(|bits| *bits == one[1]));
    for threads in [2, 4] {
        assert_eq!(bits(threads), one, "{threads} threads");
    }
}

#[test]
fn order_of_spawning_other_things_changes_nothing() {
    let bits = |others: u32| {
        let mut world = vacuum();
        for k in 0..others {
            world.spawn(Transform::from_translation(Vec3::splat(k as f32)));
        }
        hash(&mut world, UVec2::new(9, 9), 30)
    };
    assert_eq!(bits(0), bits(7));
}
