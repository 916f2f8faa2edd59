//! A crate that flies through a curtain.

use bevy_math::Vec3;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Form, HZ, World};

#[test]
fn a_crate_goes_through_a_curtain_and_loses_speed() {
    let mut world = World::earth();
    let pins = ClothPins::edges([ClothEdge::Top]);
    let at = Transform::from_xyz(0.0, 1.0, 0.0);
    let curtain = world.sheet(2.0, 32, ClothMaterial::cotton(), pins, at);
    let cube = world.body(&Body {
        velocity: Vec3::NEG_Z * 3.0,
        falls: false,
        ..Body::new(Form::Box(Vec3::splat(0.5)), 5.0, Vec3::new(0.0, 0.5, 1.0))
    });
    let (mut deepest, mut furthest) = (f32::MIN, 0.0_f32);
    for _ in 0..3 * HZ {
        world.steps(1);
        deepest = deepest.max(world.depth(curtain, cube));
        let points = world.points(curtain);
        furthest = points.iter().fold(furthest, |z, p| z.min(p.z));
        assert!(points.iter().all(|p| p.is_finite()));
        assert!(world.motion(cube).position.is_finite());
    }
    let motion = world.motion(cube);
    println!("{motion:?}, curtain at {furthest:.3} m, {deepest:.4} m deep");
    assert_eq!(world.complaint(curtain), None);
    assert!(furthest < -0.5, "the curtain gave way by {furthest} m");
    assert!(motion.velocity.z > -2.9, "{motion:?}");
    // It pushes 1 kg of cloth aside, a part of the way up.
    assert!(motion.velocity.z < -0.5, "{motion:?}");
    assert!(deepest < 5e-3, "{deepest} m deep");
}
