//! Bugs that others had.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{DT, Path, Sim};

use crate::world::{square, vacuum};

/// The velocities of all particles after each substep [m/s].
#[derive(Resource, Default)]
struct Substeps(Vec<Vec<Vec3>>);

fn note(mut substeps: ResMut<Substeps>, cloths: Query<(&ClothParticles, &ClothFrame)>) {
    for (particles, frame) in &cloths {
        let velocity = |i| frame.vector_to_world(particles.velocity(i));
        substeps
            .0
            .push((0..particles.len()).map(velocity).collect());
    }
}

fn noting(mut world: Sim) -> Sim {
    world.app.init_resource::<Substeps>();
    world
        .app
        .add_systems(ClothSubstep, note.after(ClothSubstepSystems::Collide));
    world
}

const SPEED: f32 = 10.0;

fn steady(t: f32) -> Transform {
    Transform::from_xyz(SPEED * t, 0.0, 0.0)
}

/// In each substep of every step the same speed, not all of it in the first one.
#[test]
fn no_velocity_spike_in_the_first_substep_of_an_attachment() {
    let mut world = noting(vacuum().without_gravity());
    let hand = world.spawn((steady(0.0), Path::new(steady)));
    let cloth = world.spawn(square(9));
    world.attach(cloth, hand, ClothAttachment::edge(ClothEdge::Top));
    // The rest is taken along; undamped it swings on for a while.
    world.edit::<ClothMaterial>(cloth, |material| material.damping = 4.0);
    world.steps(200);
    world.resource_mut::<Substeps>().0.clear();
    world.steps(10);
    let substeps = &world.resource::<Substeps>().0;
    assert!(substeps.len() >= 60);
    for (k, velocities) in substeps.iter().enumerate() {
        for (i, v) in velocities.iter().enumerate() {
            let most = if i < 9 { 0.01 } else { 0.5 };
            assert!(
                (*v - Vec3::X * SPEED).length() < most,
                "substep {k}, particle {i}: {v}"
            );
        }
    }
}

#[test]
fn no_velocity_spike_in_the_first_substep_of_a_backstop_or_a_target() {
    // A backstop pushes the whole sheet along its normal, at 10 m/s.
    let push = |t: f32| Transform::from_xyz(0.0, 0.0, SPEED * t);
    let held: ClothMotionConstraints = ClothMotionConstraints::at_most(0.0);
    let pushed = ClothMotionConstraints::default().with_backstop(0.01, 100.0);
    for constraints in [pushed, held, ClothMotionConstraints::at_most(0.02)] {
        let mut world = noting(vacuum().without_gravity());
        let cloth = world.spawn((square(9), constraints, ClothMotionTargets::default()));
        let rest = world.get::<Cloth>(cloth).rest_positions();
        for step in 1..=40 {
            let at = push(step as f32 * DT);
            world.edit::<ClothMotionTargets>(cloth, |targets| {
                targets.set_positions(rest.iter().map(|p| at.transform_point(*p)));
            });
            world.steps(1);
        }
        let substeps = &world.resource::<Substeps>().0;
        assert!(substeps.len() >= 240);
        let late = &substeps[substeps.len() / 4..];
        for (k, v) in late
            .iter()
            .enumerate()
            .flat_map(|(k, all)| all.iter().map(move |v| (k, v)))
        {
            assert!((*v - Vec3::Z * SPEED).length() < 3e-4, "substep {k}: {v}");
        }
        for velocities in substeps {
            let fastest = velocities.iter().map(|v| v.length()).fold(0.0, f32::max);
            assert!(fastest < 1.0001 * SPEED, "{fastest}");
        }
    }
}

#[test]
fn no_velocity_grows_on_a_resting_contact() {
    // Gravity presses the sheet against its backstop and the end of its way, for 30 s.
    let lying = Transform::from_rotation(Quat::from_rotation_x(-1.2));
    for constraints in [
        ClothMotionConstraints::default().with_backstop(0.05, 5.0),
        ClothMotionConstraints::at_most(0.05),
        ClothMotionConstraints::at_most(0.05).with_backstop(0.02, 0.5),
    ] {
        let mut world = vacuum();
        let cloth = world.spawn((
            square(12),
            lying,
            constraints,
            ClothPins::corners(ClothCorner::TOP),
        ));
        let mut fastest = Vec::new();
        for _ in 0..6 {
            world.steps(300);
            fastest.push(world.fastest(cloth));
        }
        assert!(fastest.iter().all(|v| *v < 1.0), "{fastest:?}");
        assert!(fastest[5] <= fastest[0].max(5e-4), "{fastest:?}");
    }
}

#[test]
fn the_last_motion_is_not_replayed_when_no_new_input_comes() {
    let mut world = noting(vacuum().without_gravity());
    let hand = world.spawn(Transform::default());
    let attached = world.spawn(square(5));
    world.attach(attached, hand, ClothAttachment::within(Vec3::ZERO, 2.0));
    let aimed = world.spawn((
        square(5),
        ClothMotionConstraints::at_most(0.0),
        ClothMotionTargets::default(),
    ));
    world.steps(2);
    let to = Vec3::new(0.1, 0.2, 0.3);
    world.move_to(hand, Transform::from_translation(to));
    let rest = world.get::<Cloth>(aimed).rest_positions();
    world.edit::<ClothMotionTargets>(aimed, |targets| {
        targets.set_positions(rest.iter().map(|p| *p + to));
    });
    world.steps(1);
    let places = [attached, aimed].map(|cloth| world.positions(cloth));
    for p in &places {
        assert!(p[12].distance(to) < 1e-6, "{}", p[12]);
    }
    for _ in 0..5 {
        world.steps(1);
        for (cloth, places) in [attached, aimed].into_iter().zip(&places) {
            for (now, then) in world.positions(cloth).into_iter().zip(places) {
                assert!(now.distance(*then) < 1e-6);
            }
            assert!(world.fastest(cloth) < 1e-4);
        }
    }
}

#[test]
fn motion_while_time_stands_still_is_no_blow() {
    let mut world = vacuum().without_gravity();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(5));
    world.attach(cloth, hand, ClothAttachment::within(Vec3::ZERO, 2.0));
    world.steps(5);
    world.settings().paused = true;
    // The cloth's entity moves rigidly with its particles while it is paused.
    for _ in 0..10 {
        for entity in [hand, cloth] {
            world.edit::<Transform>(entity, |at| at.translation.x += 1.0);
        }
        world.steps(1);
    }
    world.settings().paused = false;
    world.steps(1);
    assert!(
        world.at(cloth, 12).distance(Vec3::X * 10.0) < 1e-5,
        "{}",
        world.at(cloth, 12)
    );
    assert!(world.fastest(cloth) < 1e-2, "{}", world.fastest(cloth));
}
