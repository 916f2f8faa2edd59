//! Rigid attachments.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use proptest::prelude::*;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{DT, G, Path};

use crate::world::{rope, square, vacuum};

/// Spins and flies: 10 m/s, 10 rad/s.
fn wild(t: f32) -> Transform {
    Transform::from_xyz(10.0 * t, (3.0 * t).sin(), 0.0)
        .with_rotation(Quat::from_rotation_z(10.0 * t) * Quat::from_rotation_x(0.3 * t))
}

#[test]
fn the_one_line_of_the_guide_works() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::from_xyz(0.0, 1.0, 0.0));
    let cloth = world.spawn((
        square(9),
        related!(ClothAttachments[ClothAttachment::edge(ClothEdge::Top).to(hand)]),
    ));
    world.steps(60);
    for i in 0..9 {
        let rest = Vec3::new(i as f32 / 8.0 - 0.5, 0.5, 0.0);
        assert!(world.at(cloth, i).distance(rest) < 1e-6);
    }
    assert!(world.at(cloth, 80).y < -0.4);
    let held: &ClothAttachmentsHeld = world.get(hand);
    let listed: &ClothAttachments = world.get(cloth);
    assert!(held.iter().eq(listed.iter()) && held.len() == 1);
}

#[test]
fn an_edge_follows_a_fast_spinning_target_without_lag() {
    for solver in [ClothSolver::Chains, ClothSolver::GaussSeidel] {
        let mut world = vacuum();
        let hand = world.spawn((wild(0.0), Path::new(wild)));
        let cloth = world.spawn((square(17), solver));
        world.attach(cloth, hand, ClothAttachment::edge(ClothEdge::Top));
        // The same, pinned to a frame that moves so.
        let pins = ClothPins::edges([ClothEdge::Top]);
        let pinned = world.spawn((square(17), solver, pins, wild(0.0), Path::new(wild)));
        let local = |i: usize| Vec3::new(i as f32 / 16.0 - 0.5, 0.5, 0.0);
        let mut stretch = [0.0f32; 2];
        for step in 1..=120 {
            world.steps(1);
            // It is attached in the first step, to where the target is after it.
            let attached = wild(DT);
            let now = wild(step as f32 * DT);
            for i in 0..17 {
                let point = attached
                    .compute_affine()
                    .inverse()
                    .transform_point3(local(i));
                let expected = now.transform_point(point);
                let at = world.at(cloth, i);
                let size = 1.0 + expected.length();
                assert!(
                    at.distance(expected) < 1e-5 * size,
                    "step {step}: {at} {expected}"
                );
            }
            for (most, cloth) in stretch.iter_mut().zip([cloth, pinned]) {
                *most = most.max(world.stretch(cloth).p99);
            }
        }
        let [attached, pinned] = stretch;
        assert!(
            attached < 1.5 * pinned + 0.01,
            "{solver:?}: {attached}, pinned {pinned}"
        );
    }
}

#[test]
fn bones_carry_their_scale_and_their_parents() {
    let mut world = vacuum();
    let parent = world.spawn(
        Transform::from_xyz(1.0, 2.0, 3.0)
            .with_scale(Vec3::new(2.0, 1.0, 1.0))
            .with_rotation(Quat::from_rotation_y(0.5)),
    );
    let local = Transform::from_xyz(0.1, 0.2, 0.3).with_rotation(Quat::from_rotation_z(0.7));
    let bone = world.spawn((local, ChildOf(parent)));
    let cloth = world.spawn(square(5));
    let points = [Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.0, -0.1, 0.2)];
    let held = ClothAttachment::particles([3, 17]).with_points(points);
    world.attach(cloth, bone, held);
    // They are metres away, and are not thrown there.
    world.steps(20);
    let turned = Transform::from_rotation(Quat::from_rotation_x(1.0));
    for parent_at in [
        Transform::IDENTITY,
        turned,
        turned.with_scale(Vec3::new(1.0, 0.5, 3.0)),
    ] {
        world.move_to(parent, parent_at);
        world.steps(1);
        let to_world = parent_at.compute_affine() * local.compute_affine();
        for (i, point) in [3, 17].into_iter().zip(points) {
            let expected = to_world.transform_point3(point);
            assert!(world.at(cloth, i).distance(expected) < 1e-5);
        }
    }
}

#[test]
fn a_cloth_whose_entity_moves_is_held_in_the_world() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::from_xyz(0.0, 1.0, 0.0));
    let cloth = world.spawn((square(9), Transform::default(), Path::new(wild)));
    world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft));
    world.steps(1);
    let start = world.at(cloth, 0);
    for _ in 0..60 {
        world.steps(1);
        assert!(
            world.at(cloth, 0).distance(start) < 2e-5,
            "{}",
            world.at(cloth, 0)
        );
        // All motion there is is that of the frame through the coordinates.
        assert!(world.velocity(cloth, 0).length() < 0.0016);
    }
}

#[test]
fn a_rope_between_two_bones_hangs_as_a_catenary() {
    let mut world = vacuum();
    let bones = [0.0, 0.6].map(|x| world.spawn(Transform::from_xyz(x, 2.0, 0.0)));
    let cloth = world.spawn((rope(), Transform::from_xyz(0.0, 2.0, 0.0)));
    for (bone, edge) in bones.into_iter().zip([ClothEdge::Top, ClothEdge::Bottom]) {
        let held = ClothAttachment::edge(edge)
            .with_points([Vec3::new(0.0, 0.0, 0.01), Vec3::new(0.0, 0.0, -0.01)]);
        world.attach(cloth, bone, held);
    }
    world.edit::<ClothMaterial>(cloth, |material| {
        material.damping = 2.0;
        material.bend_compliance = 1e6;
    });
    world.steps(900);
    // A catenary of length 1 over 0.6: 2 a sinh(0.3/a) = 1.
    let (mut low, mut high) = (0.05f64, 1.0);
    for _ in 0..60 {
        let a: f64 = 0.5 * (low + high);
        if 2.0 * a * (0.3 / a).sinh() > 1.0 {
            low = a;
        } else {
            high = a;
        }
    }
    let sag = (low * ((0.3 / low).cosh() - 1.0)) as f32;
    let lowest = world
        .positions(cloth)
        .into_iter()
        .map(|p| p.y)
        .fold(f32::INFINITY, f32::min);
    assert!(
        (2.0 - lowest - sag).abs() < 0.001 * sag,
        "{} {sag}",
        2.0 - lowest
    );
    assert!(world.stretch(cloth).max < 1e-4);
}

#[test]
fn a_released_particle_keeps_its_velocity() {
    let throw = |t: f32| Transform::from_xyz(2.0 * t, 3.0 * t, 0.0);
    for despawn_target in [false, true] {
        let mut world = vacuum();
        world.record::<ClothAttachmentBroken>();
        let hand = world.spawn((throw(0.0), Path::new(throw)));
        let cloth = world.spawn(square(5));
        let all = ClothAttachment::within(Vec3::ZERO, 2.0);
        let attachment = world.attach(cloth, hand, all);
        world.steps(30);
        let start = world.at(cloth, 12);
        world.despawn(if despawn_target { hand } else { attachment });
        world.steps(30);
        let seconds = 30.0 * DT;
        let flown = world.at(cloth, 12) - start;
        let expected = Vec3::new(2.0, 3.0, 0.0) * seconds - Vec3::Y * (0.5 * G * seconds * seconds);
        // Semi-implicit: g h t/2 more, h a substep.
        assert!(flown.distance(expected) < 0.01, "{flown} {expected}");
        assert!(!world.exists(attachment));
        let told: Vec<ClothBreakReason> = world
            .recorded::<ClothAttachmentBroken>()
            .iter()
            .map(|broken| broken.reason)
            .collect();
        let expected: &[ClothBreakReason] = if despawn_target {
            &[ClothBreakReason::TargetGone]
        } else {
            &[]
        };
        assert_eq!(told, expected);
    }
}

#[test]
fn attachments_go_with_their_cloth_and_not_with_their_target() {
    let mut world = vacuum();
    let hands = [0.0, 1.0].map(|x| world.spawn(Transform::from_xyz(x, 0.0, 0.0)));
    let cloth = world.spawn(square(5));
    let attachments =
        hands.map(|hand| world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft)));
    world.steps(2);
    world.despawn(cloth);
    world.steps(2);
    assert!(
        attachments
            .iter()
            .all(|attachment| !world.exists(*attachment))
    );
    assert!(hands.iter().all(|hand| world.exists(*hand)));
}

#[test]
fn pins_count_before_attachments_and_later_attachments_before_earlier_ones() {
    let mut world = vacuum();
    let hands = [1.0, 2.0].map(|x| world.spawn(Transform::from_xyz(x, 0.0, 0.0)));
    let cloth = world.spawn((square(5), ClothPins::particles([0])));
    let at = |points| ClothAttachment::particles(points).with_points([Vec3::ZERO]);
    world.attach(cloth, hands[0], at([0, 1, 2]));
    world.attach(cloth, hands[1], at([9, 2, 3]));
    world.edit::<ClothGrab>(cloth, |grab| grab.take(1, 0.01, Vec3::NEG_Y));
    world.steps(10);
    let expected = [
        Vec3::new(-0.5, 0.5, 0.0),
        Vec3::X,
        2.0 * Vec3::X,
        2.0 * Vec3::X,
    ];
    for (i, place) in expected.into_iter().enumerate() {
        assert_eq!(world.at(cloth, i), place, "particle {i}");
    }
}

#[test]
fn a_target_that_is_put_elsewhere_takes_its_particles_along_without_speed() {
    let mut world = vacuum().without_gravity();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(9));
    world.attach(cloth, hand, ClothAttachment::within(Vec3::ZERO, 2.0));
    world.steps(5);
    world.move_to(hand, Transform::from_xyz(50.0, 0.0, 0.0));
    world.steps(1);
    assert!(world.at(cloth, 40).distance(Vec3::X * 50.0) < 1e-4);
    assert!(world.fastest(cloth) < 1e-3);
}

#[test]
fn a_cloth_jumps_with_all_that_holds_it() {
    let elsewhere = Transform::from_xyz(50.0, 5.0, -20.0).with_rotation(Quat::from_rotation_y(1.0));
    for entity_jumps in [false, true] {
        let mut worlds = [false, true].map(|jumps| {
            let mut world = vacuum();
            let hand = world.spawn(Transform::default());
            let cloth = world.spawn(square(9));
            world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft));
            let soft = ClothAttachment::corner(ClothCorner::TopRight).with_compliance(1e-3);
            world.attach(cloth, hand, soft);
            world.steps(40);
            if jumps {
                world.move_to(hand, elsewhere);
                if entity_jumps {
                    world.move_to(cloth, elsewhere);
                }
            }
            world.steps(20);
            (world, cloth)
        });
        // It swings on as if nothing had happened, but for gravity, which did not turn with it: about y it need not.
        let [(stayed, cloth), (jumped, other)] = &mut worlds;
        for (a, b) in stayed
            .positions(*cloth)
            .into_iter()
            .zip(jumped.positions(*other))
        {
            let expected = elsewhere.transform_point(a);
            assert!(b.distance(expected) < 0.01, "{b} {expected}");
        }
    }
}

#[test]
fn another_offset_target_or_selection_is_reached_at_thirty_metres_a_second() {
    let mut world = vacuum();
    let hands = [0.5, 0.7].map(|x| world.spawn(Transform::from_xyz(x, 0.0, 0.0)));
    let cloth = world.spawn(square(5));
    let attachment = world.attach(cloth, hands[0], ClothAttachment::particles([0]));
    world.steps(3);
    let start = world.at(cloth, 0);
    world.insert(attachment, ClothAttachedTo(hands[1]));
    world.steps(1);
    // It keeps its place at the new one.
    assert!(world.at(cloth, 0).distance(start) < 1e-6);
    world.edit::<ClothAttachment>(attachment, |held| {
        *held = ClothAttachment::particles([0]).with_points([Vec3::Y * 0.1]);
    });
    let to = Vec3::new(0.7, 0.1, 0.0);
    for _ in 0..5 {
        let left = (world.at(cloth, 0).distance(to) - 30.0 * DT).max(0.0);
        world.steps(1);
        let is = world.at(cloth, 0).distance(to);
        assert!((is - left).abs() < 1e-5, "{is} {left}");
    }
    world.edit::<ClothAttachment>(attachment, |held| *held = ClothAttachment::particles([24]));
    world.steps(1);
    let (held, free) = (world.at(cloth, 24), world.at(cloth, 0));
    world.steps(30);
    assert!(world.at(cloth, 24).distance(held) < 1e-6);
    assert!(world.at(cloth, 0).distance(free) > 0.1);
}

#[test]
fn a_rebuilt_grid_stays_attached() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::from_xyz(0.0, 1.0, 0.0));
    let cloth = world.spawn(square(9));
    world.attach(cloth, hand, ClothAttachment::edge(ClothEdge::Top));
    world.steps(30);
    world.edit::<Cloth>(cloth, |cloth| {
        *cloth = Cloth::grid(Vec2::ONE, UVec2::splat(13)).centered();
    });
    world.steps(30);
    world.move_to(hand, Transform::from_xyz(0.0, 2.0, 0.0));
    world.steps(1);
    for i in 0..13 {
        let expected = Vec3::new(i as f32 / 12.0 - 0.5, 1.5, 0.0);
        assert!(world.at(cloth, i).distance(expected) < 1e-5);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Wherever a target goes, however it turns, its particles are there, and the rest stays finite.
    #[test]
    fn particles_are_where_their_target_is(
        places in prop::collection::vec(([-3.0f32..3.0, -3.0f32..3.0, -3.0f32..3.0], -3.0f32..3.0), 1..12),
    ) {
        let mut world = vacuum();
        let hand = world.spawn(Transform::default());
        let cloth = world.spawn(square(8));
        let points = [Vec3::ZERO, Vec3::X * 0.3];
        world.attach(cloth, hand, ClothAttachment::particles([0, 7]).with_points(points));
        world.steps(1);
        for (at, angle) in places {
            let to = Transform::from_translation(at.into()).with_rotation(Quat::from_rotation_y(angle));
            world.move_to(hand, to);
            world.steps(1);
            for (i, point) in [0, 7].into_iter().zip(points) {
                prop_assert!(world.at(cloth, i).distance(to.transform_point(point)) < 1e-5);
            }
            prop_assert!(world.positions(cloth).into_iter().all(Vec3::is_finite));
        }
    }
}
