//! Errors are told, and the last valid state stays in force.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use proptest::prelude::*;
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

use crate::world::{square, vacuum};

/// A cloth that hangs by one corner at a hand.
fn hung() -> (Sim, Entity, Entity, Entity) {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(5));
    let attachment = world.attach(cloth, hand, ClothAttachment::corner(ClothCorner::TopLeft));
    world.steps(3);
    assert!(world.complaints(attachment).is_empty());
    (world, cloth, hand, attachment)
}

const CORNER: Vec3 = Vec3::new(-0.5, 0.5, 0.0);

#[test]
fn wrong_values_are_named_and_the_last_valid_ones_hold() {
    let wrong: [(&str, fn(&mut ClothAttachment)); 6] = [
        ("compliance", |held| held.compliance = f32::NAN),
        ("compliance", |held| held.compliance = -1.0),
        ("break_force", |held| held.break_force = Some(0.0)),
        ("break_force", |held| held.break_force = Some(f32::INFINITY)),
        ("offset", |held| {
            held.offset = ClothAttachmentOffset::Points(vec![Vec3::NAN]);
        }),
        ("offset", |held| {
            held.offset = ClothAttachmentOffset::Points(vec![Vec3::ZERO; 3]);
        }),
    ];
    for (name, change) in wrong {
        let (mut world, cloth, _, attachment) = hung();
        world.edit::<ClothAttachment>(attachment, change);
        world.steps(5);
        let errors = world.complaints(attachment);
        assert!(
            errors.len() == 1 && errors[0].contains(name),
            "{name}: {errors:?}"
        );
        assert!(world.at(cloth, 0).distance(CORNER) < 1e-6, "{name}");
        world.edit::<ClothAttachment>(attachment, |held| {
            *held = ClothAttachment::corner(ClothCorner::TopLeft);
        });
        world.steps(1);
        assert!(world.complaints(attachment).is_empty(), "{name}");
    }
}

#[test]
fn a_selection_that_is_wrong_is_left_out() {
    let (mut world, cloth, _, attachment) = hung();
    world.edit::<ClothAttachment>(attachment, |held| {
        held.selections.push(ClothSelection::Particle(25));
    });
    world.steps(60);
    let errors = world.complaints(attachment);
    assert!(
        errors.len() == 1 && errors[0].contains("ClothAttachment names particle 25"),
        "{errors:?}"
    );
    assert!(world.at(cloth, 0).distance(CORNER) < 1e-6);
}

#[test]
fn a_target_that_is_nowhere_holds_where_it_was() {
    for broken in [Vec3::NAN, Vec3::INFINITY] {
        let (mut world, cloth, hand, attachment) = hung();
        world.move_to(hand, Transform::from_translation(broken));
        world.steps(5);
        assert!(world.complaints(attachment)[0].contains("GlobalTransform"));
        assert!(world.at(cloth, 0).distance(CORNER) < 1e-6);
        world.move_to(hand, Transform::from_xyz(0.1, 0.0, 0.0));
        world.steps(1);
        assert!(world.complaints(attachment).is_empty());
        assert!(world.at(cloth, 0).distance(CORNER + Vec3::X * 0.1) < 1e-6);
    }
    let (mut world, cloth, hand, attachment) = hung();
    world.app.world_mut().entity_mut(hand).remove::<Transform>();
    world.steps(2);
    assert!(world.complaints(attachment)[0].contains("no Transform"));
    assert!(world.at(cloth, 0).distance(CORNER) < 1e-6);
    world.insert(hand, Transform::default());
    world.steps(1);
    assert!(world.complaints(attachment).is_empty());
}

#[test]
fn another_target_that_is_nowhere_changes_nothing_until_it_is_somewhere() {
    let (mut world, cloth, _, attachment) = hung();
    let nowhere = world.spawn(Transform::from_translation(Vec3::NAN));
    world.insert(attachment, ClothAttachedTo(nowhere));
    world.steps(3);
    assert!(world.complaints(attachment)[0].contains("GlobalTransform"));
    assert!(world.at(cloth, 0).distance(CORNER) < 1e-6);
    // Its particles may be others meanwhile.
    world.edit::<Cloth>(cloth, |cloth| {
        *cloth = Cloth::grid(Vec2::ONE, UVec2::splat(2));
    });
    world.steps(3);
    world.move_to(nowhere, Transform::from_xyz(3.0, 0.0, 0.0));
    world.steps(1);
    assert!(world.complaints(attachment).is_empty());
    let held = world.at(cloth, 0);
    world.steps(30);
    assert!(world.at(cloth, 0).distance(held) < 1e-6 && held.is_finite());
}

#[test]
fn an_attachment_without_its_relationships_says_so() {
    let mut world = vacuum();
    let hand = world.spawn(Transform::default());
    let cloth = world.spawn(square(5));
    let held = || ClothAttachment::corner(ClothCorner::TopLeft);
    let loose = world.spawn(held().to(hand));
    let aimless = world.spawn((held(), ClothAttachmentOf(cloth)));
    world.steps(2);
    assert!(world.complaints(loose)[0].contains("ClothAttachmentOf"));
    assert!(world.complaints(aimless)[0].contains("ClothAttachedTo"));
    assert!(world.exists(aimless));
    // It is never too late.
    world.insert(loose, ClothAttachmentOf(cloth));
    world.steps(1);
    assert!(world.complaints(loose).is_empty());
    let at = world.at(cloth, 0);
    world.steps(30);
    assert!(world.at(cloth, 0).distance(at) < 1e-6);
}

#[test]
fn motion_constraints_that_are_wrong_are_named_and_the_last_valid_ones_hold() {
    let wrong: [(&str, fn(&mut ClothMotionConstraints)); 5] = [
        ("max_distance", |c| {
            c.max_distance = ClothPerParticle::All(-1.0);
        }),
        ("max_distance[3]", |c| {
            let mut values = vec![0.1; 25];
            values[3] = f32::NAN;
            c.max_distance = values.into();
        }),
        ("max_distance has 24 entries", |c| {
            c.max_distance = vec![0.1; 24].into();
        }),
        ("backstop_distance", |c| {
            c.backstop_distance = f32::NAN.into();
        }),
        ("backstop_radius", |c| c.backstop_radius = 0.0.into()),
    ];
    for (name, change) in wrong {
        let mut world = vacuum();
        let cloth = world.spawn((square(5), ClothMotionConstraints::at_most(0.2)));
        world.steps(2);
        world.edit(cloth, change);
        world.steps(60);
        let errors = world.complaints(cloth);
        assert!(
            errors.len() == 1 && errors[0].contains(name),
            "{name}: {errors:?}"
        );
        assert!(world.at(cloth, 12).length() < 0.2 + 1e-5);
        world.edit(cloth, |c: &mut ClothMotionConstraints| {
            *c = ClothMotionConstraints::at_most(0.3);
        });
        world.steps(60);
        assert!(world.complaints(cloth).is_empty());
        assert!((0.2..0.3 + 1e-5).contains(&world.at(cloth, 12).length()));
    }
}

#[test]
fn targets_that_are_wrong_are_named_and_stay_where_they_were() {
    let rest = |world: &Sim, cloth| world.get::<Cloth>(cloth).rest_positions();
    for (name, broken) in [("positions[7]", Vec3::NAN), ("normals[7]", Vec3::INFINITY)] {
        let mut world = vacuum();
        let targets = ClothMotionTargets::default();
        let cloth = world.spawn((square(5), ClothMotionConstraints::at_most(0.0), targets));
        let mut positions = rest(&world, cloth);
        let mut normals = vec![Vec3::Z; 25];
        world.steps(2);
        positions[8] = Vec3::ONE;
        if name.starts_with("positions") {
            positions[7] = broken;
        } else {
            normals[7] = broken;
        }
        world.edit(cloth, |targets: &mut ClothMotionTargets| {
            targets.set(positions, normals);
        });
        world.steps(3);
        assert!(
            world.complaints(cloth)[0].contains(name),
            "{:?}",
            world.complaints(cloth)
        );
        assert_eq!(world.positions(cloth), rest(&world, cloth));
        world.edit(cloth, |targets: &mut ClothMotionTargets| {
            targets.set_positions([Vec3::ZERO; 4]);
        });
        world.steps(1);
        assert!(world.complaints(cloth)[0].contains("4 entries"));
        world.edit(cloth, |targets: &mut ClothMotionTargets| {
            targets.set_positions([Vec3::ONE; 25]);
        });
        world.steps(1);
        assert!(world.complaints(cloth).is_empty());
        assert_eq!(world.at(cloth, 7), Vec3::ONE);
    }
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        Just(0.0),
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(-1.0),
        Just(1e-30),
        Just(1e30),
        0.0f32..2.0
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn nothing_makes_a_cloth_non_finite(
        numbers in prop::array::uniform8(any_number()), place in prop::array::uniform3(any_number()),
        particle in 0u32..30, points in 0usize..4,
    ) {
        let mut world = vacuum();
        let hand = world.spawn(Transform::default());
        let cloth = world.spawn((square(5), ClothMotionTargets::default()));
        let [compliance, force, most, distance, radius, x, y, z] = numbers;
        let mut held = ClothAttachment::particles([particle, 3]).with_compliance(compliance).with_break_force(force);
        if points > 0 {
            held = held.with_points(vec![Vec3::new(x, y, z); points]);
        }
        world.attach(cloth, hand, held);
        let limits = ClothMotionConstraints::at_most(most).with_backstop(distance, radius);
        world.insert(cloth, limits);
        for at in [Vec3::ZERO, Vec3::from(place), Vec3::ONE] {
            world.move_to(hand, Transform::from_translation(at));
            world.edit(cloth, |targets: &mut ClothMotionTargets| {
                targets.set([at; 25], [Vec3::new(x, y, z); 25]);
            });
            world.steps(3);
            let finite = world.positions(cloth).into_iter().all(Vec3::is_finite);
            prop_assert!(finite && world.fastest(cloth).is_finite());
        }
    }
}
