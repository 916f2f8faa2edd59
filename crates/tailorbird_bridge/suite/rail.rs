//! Bodies that cannot move in all directions.

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Form, Motion, World, all_edges, lying};

const PLACE: Vec3 = Vec3::new(0.5, 0.15, 0.3);

/// A ball of 1 kg that lies on a sheet, off its middle, after 5 s.
fn ball(on_rail: bool) -> Motion {
    let mut world = World::earth();
    let sheet = world.sheet(2.0, 32, ClothMaterial::cotton(), all_edges(), lying(0.0));
    let body = world.body(&Body {
        on_rail,
        damping: 1.0,
        ..Body::new(Form::Ball(0.1), 1.0, PLACE)
    });
    world.seconds(5.0);
    assert_eq!(world.complaint(sheet), None);
    world.motion(body)
}

#[test]
fn a_ball_on_a_rail_stays_on_it() {
    let free = ball(false);
    let rolled = (free.position - PLACE).with_y(0.0).length();
    assert!(rolled > 0.02, "a free one rolls to the middle: {rolled}");
    let held = ball(true);
    let away = (held.position - PLACE).with_y(0.0);
    assert!(away.length() < 1e-5, "{away}");
    assert!(held.spin.length() < 1e-5, "{}", held.spin);
    // It lies: lower than it was let go, and in the sheet, not below it.
    assert!(
        (-0.5..0.14).contains(&held.position.y),
        "{:?}",
        held.position
    );
    assert!(held.velocity.length() < 0.05, "{}", held.velocity);
}
