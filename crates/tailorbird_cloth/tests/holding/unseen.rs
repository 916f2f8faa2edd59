//! Cloth that nobody sees sleeps whatever happens, goes where its holder goes, and goes on without a jerk.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Path, Sim, furthest};

use crate::world::{square, vacuum};

/// Runs at this speed [m/s].
const RUN: f32 = 5.0;

/// A runner who turns slowly.
fn runner() -> Path {
    Path::new(|t| {
        Transform::from_xyz(RUN * t, 0.0, 0.0).with_rotation(Quat::from_rotation_y(0.3 * t))
    })
}

/// A cape of a runner: pinned to its own entity, attached to another one, or both: to another one below which it is.
#[derive(Clone, Copy, Debug)]
enum Held {
    Pinned,
    Attached,
    AttachedBelow,
}

const ALL: [Held; 3] = [Held::Pinned, Held::Attached, Held::AttachedBelow];

fn cape(held: Held, unseen: bool) -> (Sim, Entity) {
    let mut world = vacuum();
    let body = world.spawn((Transform::default(), runner()));
    let cloth = world.spawn(square(12));
    match held {
        Held::Pinned => {
            let mut cloth = world.app.world_mut().entity_mut(cloth);
            cloth.insert((ClothPins::edges([ClothEdge::Top]), ChildOf(body)));
        }
        Held::Attached | Held::AttachedBelow => {
            world.attach(cloth, body, ClothAttachment::edge(ClothEdge::Top));
        }
    }
    if matches!(held, Held::AttachedBelow) {
        let mut cloth = world.app.world_mut().entity_mut(cloth);
        cloth.insert(ChildOf(body));
    }
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 3.0);
    world.edit::<ClothSleep>(cloth, |sleep| sleep.unseen = unseen);
    (world, cloth)
}

fn see(world: &mut Sim, cloth: Entity, seen: bool) {
    world.edit::<ClothSeen>(cloth, |is| is.0 = seen);
}

/// The shape as the cloth's holder sees it.
fn shape(world: &Sim, cloth: Entity) -> Vec<Vec3> {
    let all = world.positions(cloth);
    let (x, y) = ((all[11] - all[0]).normalize(), Vec3::Y);
    let z = x.cross(y);
    let from = |p: &Vec3| *p - all[0];
    all.iter()
        .map(|p| Vec3::new(from(p).dot(x), from(p).dot(y), from(p).dot(z)))
        .collect()
}

#[test]
fn it_keeps_its_shape_and_goes_where_its_holder_goes() {
    for held in ALL {
        let (mut world, cloth) = cape(held, true);
        world.steps(120);
        let before = shape(&world, cloth);
        see(&mut world, cloth, false);
        world.steps(240);
        assert!(world.get::<ClothSleepState>(cloth).is_unseen(), "{held:?}");
        assert!(furthest(&before, &shape(&world, cloth)) < 4e-5, "{held:?}");
        let frame: &ClothFrame = world.get(cloth);
        let bounds: &ClothBounds = world.get(cloth);
        for p in world.positions(cloth) {
            // To within the way of a step: the entity may have gone on after the step.
            let p = frame.to_frame(p);
            assert!(
                p.distance(p.clamp(bounds.min, bounds.max)) < 0.1,
                "{held:?}"
            );
            // 360 steps are 6 s.
            assert!((world.at(cloth, 0).x - RUN * 6.0).abs() < 0.2, "{held:?}");
        }
    }
}

/// Seen again it moves as one that was seen all the time: no jerk, no stretch.
#[test]
fn it_goes_on_as_one_that_was_seen_all_the_time() {
    for held in ALL {
        let stretches = [false, true].map(|unseen| {
            let (mut world, cloth) = cape(held, unseen);
            world.steps(240);
            see(&mut world, cloth, false);
            world.steps(200);
            see(&mut world, cloth, true);
            let before = shape(&world, cloth);
            let mut stretch = 0.0f32;
            for _ in 0..30 {
                world.steps(1);
                assert!(!world.get::<ClothSleepState>(cloth).is_asleep(), "{held:?}");
                stretch = stretch.max(world.stretch(cloth).max);
            }
            let away = furthest(&before, &shape(&world, cloth));
            // Its holder has turned by 1 rad meanwhile, and damping comes from elsewhere: at 3/s and 5 m/s it pulls aside with 12.6 m/s², and
            // half a second of that would be 1.6 m, did the cape not hang.
            assert!(away < 0.4, "{held:?}, {unseen}: {away}");
            for i in 0..144 {
                let speed = world.velocity(cloth, i).length();
                assert!((speed - RUN).abs() < 0.5, "{held:?}, {unseen}: {speed}");
            }
            stretch
        });
        assert!(
            stretches[1] < 2.0 * stretches[0] + 1e-4,
            "{held:?}: {stretches:?}"
        );
    }
}

#[test]
fn it_stays_awake_without_the_setting_and_with_targets_and_wakes_by_nothing_else() {
    let (mut world, cloth) = cape(Held::Pinned, false);
    see(&mut world, cloth, false);
    world.steps(10);
    assert!(!world.get::<ClothSleepState>(cloth).is_asleep());
    world.edit::<ClothSleep>(cloth, |sleep| sleep.unseen = true);
    world.steps(1);
    assert!(world.get::<ClothSleepState>(cloth).is_asleep());
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 1.0);
    world.edit::<ClothForces>(cloth, |forces| forces.add_force(100, Vec3::X));
    let shape_before = shape(&world, cloth);
    for paused in [false, true, false] {
        world.settings().paused = paused;
        world.steps(5);
        assert!(world.get::<ClothSleepState>(cloth).is_unseen());
        assert!(furthest(&shape_before, &shape(&world, cloth)) < 1e-6);
    }
    let mut targets = world.app.world_mut().entity_mut(cloth);
    targets.insert(ClothMotionTargets::default());
    world.steps(1);
    assert!(!world.get::<ClothSleepState>(cloth).is_asleep());
}

/// While it is paused it may be seen again; it goes on with the simulation.
#[test]
fn it_comes_back_during_a_pause() {
    for held in ALL {
        let (mut world, cloth) = cape(held, true);
        world.steps(240);
        see(&mut world, cloth, false);
        world.steps(60);
        let before = shape(&world, cloth);
        world.settings().paused = true;
        // The runner runs on.
        world.steps(3);
        see(&mut world, cloth, true);
        world.steps(3);
        assert!(furthest(&before, &shape(&world, cloth)) < 1e-5, "{held:?}");
        world.settings().paused = false;
        let mut stretch = 0.0f32;
        for step in 0..30 {
            world.steps(1);
            let fastest = world.fastest(cloth);
            assert!(fastest < 1.2 * RUN, "{held:?}, step {step}: {fastest}");
            stretch = stretch.max(world.stretch(cloth).max);
        }
        assert!(stretch < 2e-4, "{held:?}: {stretch}");
        for i in 0..144 {
            let speed = world.velocity(cloth, i).length();
            assert!((speed - RUN).abs() < 0.3, "{held:?}: {speed}");
        }
        assert!(!world.get::<ClothSleepState>(cloth).is_asleep());
    }
}

/// Its entity walks away from it, its holder does not.
#[test]
fn it_stays_with_a_holder_that_stands_while_its_entity_moves() {
    let mut world = vacuum();
    let walker = world.spawn((Transform::default(), runner()));
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn((square(12), ChildOf(walker)));
    world.attach(cloth, hand, ClothAttachment::edge(ClothEdge::Top));
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 3.0);
    world.edit::<ClothSleep>(cloth, |sleep| sleep.unseen = true);
    world.steps(240);
    let before = world.positions(cloth);
    see(&mut world, cloth, false);
    world.steps(240);
    assert!(furthest(&before, &world.positions(cloth)) < 1.1e-3);
    see(&mut world, cloth, true);
    world.steps(1);
    assert!(world.fastest(cloth) < 0.07, "{}", world.fastest(cloth));
}

#[test]
fn it_is_whole_when_it_is_rebuilt_and_takes_one_step_when_it_is_woken() {
    let (mut world, cloth) = cape(Held::Attached, true);
    world.steps(60);
    see(&mut world, cloth, false);
    world.steps(5);
    for (n, scale) in [(20, 1.0), (6, 3.0), (30, 0.5)] {
        world.edit::<Cloth>(cloth, |cloth| {
            *cloth = Cloth::grid(bevy_math::Vec2::ONE, bevy_math::UVec2::splat(n)).centered();
        });
        world.edit::<Transform>(cloth, |at| at.scale = Vec3::splat(scale));
        world.steps(1);
        assert!(world.get::<ClothSleepState>(cloth).is_unseen());
        let count = (n * n) as usize;
        assert_eq!(world.particles(cloth).len(), count);
        assert_eq!(world.get::<ClothNormals>(cloth).len(), count);
        let bounds: &ClothBounds = world.get(cloth);
        let size = (bounds.max - bounds.min).max_element();
        assert!((0.8 * scale..2.0 * scale).contains(&size), "{size}");
    }
    let hash = world.hash(cloth);
    world.edit::<ClothSleepState>(cloth, ClothSleepState::wake);
    world.steps(1);
    let after = world.hash(cloth);
    assert_ne!(after, hash);
    world.steps(1);
    assert!(world.get::<ClothSleepState>(cloth).is_unseen());
}
