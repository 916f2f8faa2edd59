//! Held particles are drawn where their target is drawn.

use bevy::prelude::*;
use tailorbird::{
    cloth::{attachment::ClothAttachedParticles, topology::order::Stored},
    drawn::ClothDrawnHolds,
    prelude::*,
};

use crate::world::{Sim, square};

/// A sheet of 1 m × 1 m whose threads do not stretch.
fn sheet(n: u32) -> impl Bundle {
    let material = ClothMaterial {
        warp_compliance: 0.0,
        weft_compliance: 0.0,
        damping: 0.0,
        ..ClothMaterial::cotton()
    };
    (square(n), material, ClothSleep::never())
}

fn attach(sim: &mut Sim, cloth: Entity, to: Entity, attachment: ClothAttachment) {
    sim.spawn((attachment.to(to), ClothAttachmentOf(cloth)));
}

/// Drawn places of all particles, in the world, where the cloth and its targets are now.
fn drawn(
    sim: &Sim,
    cloth: Entity,
    place: Transform,
    fraction: f32,
    now: impl Fn(Entity) -> Option<Transform>,
) -> Vec<Vec3> {
    let mut holds = ClothDrawnHolds::default();
    let particles = sim.particles(cloth);
    let place = GlobalTransform::from(place);
    holds.update(
        sim.get::<ClothTopology>(cloth),
        particles,
        sim.get::<ClothAttachedParticles>(cloth),
        &place,
        fraction,
        |target| Some(now(target)?.into()),
    );
    let at = |i| place.transform_point(particles.interpolated(i, fraction) + holds.offset(i));
    let all = (0..particles.len() as u32).map(Stored);
    all.map(at).collect()
}

#[test]
fn a_pin_is_where_its_bone_is_drawn_and_the_rest_follows_smoothly() {
    let mut sim = Sim::vacuum();
    let hand = sim.spawn(Transform::default());
    let cloth = sim.spawn(sheet(33));
    attach(&mut sim, cloth, hand, ClothAttachment::edge(ClothEdge::Top));
    sim.steps(20);
    let moved = Transform::from_xyz(0.05, 0.1, 0.02).with_rotation(Quat::from_rotation_z(0.1));
    let place = Transform::from_xyz(0.0, 0.01, 0.0).with_rotation(Quat::from_rotation_y(0.03));
    for fraction in [0.0, 0.4, 1.0] {
        let still = drawn(&sim, cloth, place, fraction, |_| None);
        let at = drawn(&sim, cloth, place, fraction, |_| Some(moved));
        let offset = |i: usize| at[i] - still[i];
        for (i, at) in at.iter().enumerate().take(33) {
            let rest = Vec3::new(i as f32 / 32.0 - 0.5, 0.5, 0.0);
            assert!(at.distance(moved.transform_point(rest)) < 1e-5);
        }
        for row in 1..33 {
            for i in 33 * row..33 * (row + 1) {
                // From row to row less by little.
                let change = offset(i).distance(offset(i - 33));
                assert!(change < 0.03, "{i}: {change}");
                // 0.6 of 1 m: none from the twentieth row on.
                assert!(row < 20 || offset(i) == Vec3::ZERO, "{i}: {}", offset(i));
            }
        }
        assert!(offset(33).length() > 0.9 * offset(0).length());
    }
}

#[test]
fn nothing_is_drawn_elsewhere_where_nothing_moved() {
    let mut sim = Sim::vacuum();
    let hand = sim.spawn(Transform::from_xyz(0.3, 0.2, 0.1));
    let cloth = sim.spawn(sheet(17));
    attach(
        &mut sim,
        cloth,
        hand,
        ClothAttachment::corner(ClothCorner::TopLeft),
    );
    sim.steps(30);
    let hand_at = *sim.get::<Transform>(hand);
    let here = Transform::default();
    let still = drawn(&sim, cloth, here, 0.7, |_| None);
    let at = drawn(&sim, cloth, here, 0.7, |_| Some(hand_at));
    for (a, b) in still.iter().zip(&at) {
        assert!(a.distance(*b) < 1e-6);
    }
}

#[test]
fn each_of_two_targets_moves_its_own_side_and_pins_stay() {
    let mut sim = Sim::vacuum();
    let hands = [0.0, 1.0].map(|x| sim.spawn(Transform::from_xyz(x, 0.0, 0.0)));
    let cloth = sim.spawn((sheet(17), ClothPins::corners([ClothCorner::BottomLeft])));
    for (hand, corner) in hands.into_iter().zip(ClothCorner::TOP) {
        attach(&mut sim, cloth, hand, ClothAttachment::corner(corner));
    }
    sim.steps(3);
    let here = Transform::default();
    let still = drawn(&sim, cloth, here, 1.0, |_| None);
    let at = drawn(&sim, cloth, here, 1.0, |target| {
        let x = if target == hands[0] { 0.0 } else { 1.0 };
        let up = if target == hands[0] { 0.1 } else { 0.0 };
        Some(Transform::from_xyz(x, up, 0.0))
    });
    let lifted = |i: usize| at[i].y - still[i].y;
    assert!((lifted(0) - 0.1).abs() < 1e-6 && lifted(16).abs() < 1e-6);
    assert!(lifted(1) > 0.08 && lifted(15).abs() < 1e-3);
    assert_eq!(lifted(16 * 17), 0.0);
    // Less and less along the row.
    assert!((1..16).all(|i| lifted(i) <= lifted(i - 1) + 1e-6));
}

#[test]
fn where_all_that_holds_it_hopped_the_whole_cloth_is_drawn_there() {
    let mut sim = Sim::vacuum();
    let hand = sim.spawn(Transform::default());
    let cloth = sim.spawn(sheet(33));
    attach(&mut sim, cloth, hand, ClothAttachment::edge(ClothEdge::Top));
    sim.steps(20);
    let here = Transform::default();
    let hopped = Transform::from_xyz(2.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(1.0));
    let still = drawn(&sim, cloth, here, 1.0, |_| None);
    let at = drawn(&sim, cloth, here, 1.0, |_| Some(hopped));
    for (from, to) in still.iter().zip(&at) {
        assert!(to.distance(hopped.transform_point(*from)) < 1e-5);
    }
}
