//! The same bits whether a game has systems between the stages or not, with all shapes and bodies.

use bevy_math::{Isometry3d, Mat3, UVec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, external};

use crate::shapes;

fn bits(own_stages: bool, instruction_set: ClothInstructionSet) -> Vec<[u32; 3]> {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::splat(40),
        substeps: Some(8),
        instruction_set,
        ..Scene::default()
    });
    if own_stages {
        sheet.sim.app.add_systems(ClothSubstep, || {});
    }
    let world = sheet.sim.app.world_mut();
    for (k, case) in shapes::all().into_iter().enumerate() {
        let at = Vec3::new(
            0.35 * (k % 4) as f32 - 0.6,
            0.35 * (k / 4) as f32 - 0.6,
            -0.7,
        );
        let small = Transform::from_translation(at).with_scale(Vec3::splat(0.5));
        world.spawn((case.collider, small));
    }
    let entity = world.spawn_empty().id();
    let mut reactions = Vec::new();
    for _ in 0..40 {
        let at = Isometry3d::from_translation(Vec3::new(0.5, -0.5, -0.2));
        sheet
            .sim
            .resource_mut::<ClothExternalColliders>()
            .push(external(
                entity,
                ClothColliderShape::Capsule {
                    radius: 0.1,
                    half_length: 0.2,
                },
                [at, at],
                Some(ClothColliderBody {
                    body: entity,
                    inv_mass: Vec3::splat(10.0),
                    inv_inertia: Mat3::IDENTITY * 1000.0,
                    center_of_mass: at.translation.into(),
                    linear_velocity: Vec3::ZERO,
                    angular_velocity: Vec3::ZERO,
                }),
            ));
        sheet.steps(1);
        let of = sheet.sim.resource::<ClothReactions>();
        reactions.extend(
            of.get(entity)
                .map(|r| r.impulse.to_array().map(f32::to_bits)),
        );
    }
    assert!(!reactions.is_empty(), "the body was met");
    let particles = sheet.particles();
    let places = particles
        .positions()
        .map(|p| p.to_array().map(f32::to_bits));
    places.chain(reactions).collect()
}

#[test]
fn both_runners_and_all_instruction_sets_give_the_same_bits() {
    let whole = bits(false, ClothInstructionSet::Auto);
    assert!(
        whole == bits(true, ClothInstructionSet::Auto),
        "stage by stage"
    );
    assert!(
        whole == bits(false, ClothInstructionSet::Scalar),
        "without vectors"
    );
}

/// A body that lies on a sheet between two posts keeps it awake, with systems of a game as without, and gets the same pushes.
#[test]
fn what_carries_a_body_stays_awake_either_way() {
    let run = |own_stages: bool| {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(17),
            substeps: Some(12),
            pins: ClothPins::edges([ClothEdge::Left, ClothEdge::Right]),
            sleep: ClothSleep::default(),
            ..Scene::default()
        });
        if own_stages {
            sheet.sim.app.add_systems(ClothSubstep, || {});
        }
        let entity = sheet.sim.spawn(());
        let mut pushes = Vec::new();
        for _ in 0..300 {
            let at = Isometry3d::from_translation(Vec3::new(0.0, 0.0, 0.05));
            let body = ClothColliderBody {
                body: entity,
                inv_mass: Vec3::splat(2.0),
                inv_inertia: Mat3::IDENTITY * 20.0,
                center_of_mass: at.translation.into(),
                linear_velocity: Vec3::ZERO,
                angular_velocity: Vec3::ZERO,
            };
            let mut colliders = sheet.sim.resource_mut::<ClothExternalColliders>();
            colliders.push(external(
                entity,
                ClothColliderShape::Sphere { radius: 0.2 },
                [at, at],
                Some(body),
            ));
            sheet.steps(1);
            let reactions = sheet.sim.resource::<ClothReactions>();
            let impulse = reactions.get(entity).map(|reaction| reaction.impulse);
            pushes.push(impulse.map(|impulse| impulse.to_array().map(f32::to_bits)));
        }
        let rest = sheet.sim.app.world().get::<ClothSleepState>(sheet.entity);
        (pushes, rest.is_some_and(ClothSleepState::is_asleep))
    };
    let (whole, asleep) = run(false);
    assert!(!asleep && whole.last().is_some_and(Option::is_some));
    let (staged, asleep) = run(true);
    assert!(!asleep, "asleep it pushes no more");
    let differs = whole.iter().zip(&staged).position(|(a, b)| a != b);
    assert_eq!(differs, None, "first step that differs");
}

/// A collider that wakes a cloth is met in the same step, with systems of a game as without.
#[test]
fn what_wakes_a_cloth_is_met_at_once_either_way() {
    let run = |own_stages: bool| {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(17),
            substeps: Some(8),
            pins: ClothPins::edges([
                ClothEdge::Left,
                ClothEdge::Right,
                ClothEdge::Top,
                ClothEdge::Bottom,
            ]),
            sleep: ClothSleep::default(),
            gravity: Vec3::ZERO,
            ..Scene::default()
        });
        if own_stages {
            sheet.sim.app.add_systems(ClothSubstep, || {});
        }
        // So that the list of colliders has something at its places.
        for x in [-5.0, -6.0, -7.0] {
            let far = Transform::from_xyz(x, 0.0, 0.0);
            sheet
                .sim
                .app
                .world_mut()
                .spawn((ClothCollider::sphere(0.1), far));
        }
        sheet.steps(240);
        let asleep = |sheet: &Sheet| {
            let rest = sheet.sim.app.world().get::<ClothSleepState>(sheet.entity);
            rest.is_some_and(ClothSleepState::is_asleep)
        };
        assert!(asleep(&sheet));
        let at = Transform::from_xyz(0.1, 0.05, -0.15);
        sheet
            .sim
            .app
            .world_mut()
            .spawn((ClothCollider::sphere(0.2), at));
        let mut bits = Vec::new();
        for _ in 0..20 {
            sheet.steps(1);
            let particles = sheet.particles();
            bits.push(
                particles
                    .positions()
                    .map(|p| p.to_array().map(f32::to_bits))
                    .collect::<Vec<_>>(),
            );
        }
        assert!(!asleep(&sheet));
        bits
    };
    let (whole, staged) = (run(false), run(true));
    assert_ne!(whole.first(), whole.last());
    let differs = whole.iter().zip(&staged).position(|(a, b)| a != b);
    assert_eq!(differs, None, "first step that differs");
}
