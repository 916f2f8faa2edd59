//! Bodies that cannot move in all directions.

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Form, Motion, World, all_edges, lying};

const PLACE: Vec3 = Vec3::new(0.5, 0.15, 0.3);

/// A ball of 1 kg that lies on a sheet, off its middle: how it moves after 4 s and a second later.
fn ball(on_rail: bool) -> [Motion; 2] {
    let mut world = World::earth();
    let sheet = world.sheet(2.0, 32, ClothMaterial::cotton(), all_edges(), lying(0.0));
    let body = world.body(&Body {
        on_rail,
        damping: 1.0,
        ..Body::new(Form::Ball(0.1), 1.0, PLACE)
    });
    world.seconds(4.0);
    let before = world.motion(body);
    world.seconds(1.0);
    assert_eq!(world.complaint(sheet), None);
    [before, world.motion(body)]
}

#[test]
fn a_ball_on_a_rail_stays_on_it() {
    let away = |motion: &Motion| (motion.position - PLACE).with_y(0.0).length();
    let [before, after] = ball(false);
    assert!(away(&before).max(away(&after)) > 0.02, "a free one leaves");
    let [before, after] = ball(true);
    for motion in [before, after] {
        assert!(away(&motion) < 1e-5, "{:?}", motion.position);
        assert!(motion.spin.length() < 1e-5, "{}", motion.spin);
        assert!(
            (-0.5..0.14).contains(&motion.position.y),
            "{}",
            motion.position.y
        );
    }
    // It lies.
    let sinks = before.position.y - after.position.y;
    assert!(sinks.abs() < 0.01, "{sinks} m in a second");
}
