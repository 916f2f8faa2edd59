//! A free sheet and a body that hits it, alone in space.

use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Form, HZ, World};

/// Largest change of linear and angular momentum within 2 s, as parts of them, and the part of its speed that the body keeps.
fn hit(body: &Body) -> [f64; 3] {
    let mut world = World::new(Vec3::ZERO);
    let material = ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::cotton()
    };
    let pins = ClothPins::default();
    let sheet = world.sheet(1.0, 24, material, pins, Transform::IDENTITY);
    let entity = world.body(body);
    world.steps(1);
    let start = world.momentum(sheet, entity, body.mass);
    let mut worst = [0.0_f64; 2];
    let mut touched = 0;
    for _ in 0..2 * HZ {
        world.steps(1);
        touched += u32::from(world.reaction(entity).is_some());
        let now = world.momentum(sheet, entity, body.mass);
        for (worst, (now, start)) in worst.iter_mut().zip(now.iter().zip(start)) {
            *worst = worst.max(now.distance(start));
        }
    }
    assert_eq!(world.complaint(sheet), None);
    assert!(touched > 5, "touched in {touched} steps");
    let kept = world.motion(entity).velocity.length() / body.velocity.length();
    // About the origin, which the body passes at 5 cm.
    let turns = start[1].length();
    println!(
        "momentum off by {:.2e} of {:.3}, angular by {:.2e} of {turns:.4}, speed kept {kept:.3}",
        worst[0] / start[0].length(),
        start[0].length(),
        worst[1] / turns
    );
    [
        worst[0] / start[0].length(),
        worst[1] / turns,
        f64::from(kept),
    ]
}

#[test]
fn a_ball_and_a_free_sheet_keep_their_momentum() {
    let [linear, angular, kept] = hit(&Body {
        velocity: Vec3::NEG_Z * 5.0,
        ..Body::new(Form::Ball(0.1), 0.3, Vec3::new(0.05, 0.03, 0.4))
    });
    assert!(linear < 0.01, "{linear}");
    // Lines that are stretched in the impact keep it less well: about a line that passes the middle at 5 cm it is small as well.
    assert!(angular < 0.1, "{angular}");
    assert!((0.3..0.97).contains(&kept), "{kept}");
}

#[test]
fn a_tumbling_box_and_a_free_sheet_keep_their_momentum() {
    let mut body = Body {
        velocity: Vec3::NEG_Z * 5.0,
        spin: Vec3::new(3.0, 5.0, 2.0),
        ..Body::new(
            Form::Box(Vec3::new(0.3, 0.2, 0.1)),
            0.5,
            Vec3::new(0.05, 0.03, 0.4),
        )
    };
    body.at.rotation = Quat::from_rotation_x(0.7) * Quat::from_rotation_y(0.4);
    let [linear, angular, kept] = hit(&body);
    assert!(linear < 0.01, "{linear}");
    // Lines that are stretched in the impact keep it less well: about a line that passes the middle at 5 cm it is small as well.
    assert!(angular < 0.1, "{angular}");
    assert!((0.3..0.97).contains(&kept), "{kept}");
}
