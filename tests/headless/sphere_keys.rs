//! The keys of a sphere move it at the speeds they say, evenly on the screen, and the cloth with it.

use bevy::{input::ButtonState, prelude::*};
use tailorbird::prelude::*;

use crate::game::*;

fn sphere(app: &mut App) -> Entity {
    app.world_mut()
        .spawn((
            ClothCollider::sphere(0.3),
            ClothSphereControls {
                speed: 1.0,
                fast_speed: 3.0,
                ..default()
            },
            Transform::from_xyz(0.5, 1.0, -2.0),
        ))
        .id()
}

fn moved_by(keys: &[KeyCode]) -> Vec3 {
    let mut app = game();
    let sphere = sphere(&mut app);
    frames(&mut app, 2);
    let before = get::<Transform>(&app, sphere).translation;
    for k in keys {
        key(&mut app, *k, ButtonState::Pressed);
    }
    frames(&mut app, 60);
    for k in keys {
        key(&mut app, *k, ButtonState::Released);
    }
    // The last steps reach the screen a step later.
    frames(&mut app, 3);
    let after = get::<Transform>(&app, sphere).translation;
    frames(&mut app, 3);
    assert_eq!(get::<Transform>(&app, sphere).translation, after);
    after - before
}

#[test]
fn each_key_moves_along_its_axis() {
    for (key, direction) in [
        (KeyCode::ArrowLeft, Vec3::NEG_X),
        (KeyCode::ArrowRight, Vec3::X),
        (KeyCode::ArrowUp, Vec3::NEG_Z),
        (KeyCode::ArrowDown, Vec3::Z),
        (KeyCode::PageUp, Vec3::Y),
        (KeyCode::PageDown, Vec3::NEG_Y),
    ] {
        let moved = moved_by(&[key]);
        assert!(moved.distance(direction) < 0.04, "{key:?}: {moved}");
    }
}

#[test]
fn shift_is_faster_opposite_keys_cancel_and_diagonals_are_no_faster() {
    let fast = moved_by(&[KeyCode::ShiftLeft, KeyCode::ArrowRight]);
    assert!(fast.distance(Vec3::X * 3.0) < 0.12, "{fast}");
    let none = moved_by(&[KeyCode::ArrowLeft, KeyCode::ArrowRight]);
    assert_eq!(none, Vec3::ZERO);
    let diagonal = moved_by(&[KeyCode::ArrowRight, KeyCode::PageUp]);
    assert!((diagonal.length() - 1.0).abs() < 0.04, "{diagonal}");
}

#[test]
fn frames_that_are_shorter_than_steps_show_even_motion() {
    use bevy::time::TimeUpdateStrategy;
    use std::time::Duration;
    let mut app = game();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 144.0,
    )));
    let sphere = sphere(&mut app);
    frames(&mut app, 5);
    key(&mut app, KeyCode::ArrowRight, ButtonState::Pressed);
    frames(&mut app, 20);
    let mut places = Vec::new();
    for _ in 0..40 {
        app.update();
        places.push(get::<Transform>(&app, sphere).translation.x);
    }
    for pair in places.windows(2) {
        assert!((pair[1] - pair[0] - 1.0 / 144.0).abs() < 1e-4, "{pair:?}");
    }
}

#[test]
fn a_game_may_still_put_the_sphere_elsewhere() {
    let mut app = game();
    let sphere = sphere(&mut app);
    frames(&mut app, 5);
    let there = Vec3::new(3.0, 4.0, 5.0);
    app.world_mut()
        .get_mut::<Transform>(sphere)
        .expect("one")
        .translation = there;
    frames(&mut app, 5);
    assert_eq!(get::<Transform>(&app, sphere).translation, there);
}

#[test]
fn printing_the_controls_names_the_keys() {
    let printed = ClothSphereControls::default().to_string();
    for name in [
        "ArrowLeft",
        "ArrowRight",
        "ArrowUp",
        "ArrowDown",
        "PageUp",
        "PageDown",
        "ShiftLeft",
    ] {
        assert!(printed.contains(name), "{name} in {printed}");
    }
}
