//! The demo in other hands: fingers and keys drag cloth, a gamepad moves the ball. And what the camera does by itself.

use bevy::{
    input::{
        ButtonState,
        gamepad::{GamepadAxis, GamepadButton, RawGamepadButtonChangedEvent, RawGamepadEvent},
        touch::{TouchInput, TouchPhase},
    },
    post_process::dof::DepthOfField,
    prelude::*,
    window::{PrimaryWindow, WindowEvent},
};
use tailorbird::prelude::*;

use crate::{
    common::{
        camera::{Followed, OrbitCamera},
        hand::Hand,
        scenes::{SceneCloth, SceneKind, SceneSphere},
    },
    demo::*,
    game::*,
};

/// Puts a finger somewhere, moves it, or lifts it [logical pixels].
fn finger(app: &mut App, id: u64, phase: TouchPhase, position: Vec2) {
    let window = one::<With<PrimaryWindow>>(app);
    let touch = TouchInput {
        phase,
        position,
        window,
        force: None,
        id,
    };
    app.world_mut().write_message(touch);
    app.world_mut()
        .write_message(WindowEvent::TouchInput(touch));
}

/// A cloth, a particle of it, and where that is seen.
fn on_cloth(app: &mut App) -> (Entity, Vec2) {
    let cloth = one::<With<SceneCloth>>(app);
    let camera = one::<With<OrbitCamera>>(app);
    let place = particle(app, cloth, get::<ClothParticles>(app, cloth).len() / 2);
    (cloth, on_screen(app, camera, place))
}

#[test]
fn one_finger_drags_cloth() {
    let mut app = demo(SceneKind::Curtain);
    frames(&mut app, 30);
    let (cloth, place) = on_cloth(&mut app);
    finger(&mut app, 7, TouchPhase::Started, place);
    frames(&mut app, 2);
    let held = get::<ClothGrab>(&app, cloth).particle().expect("held") as usize;
    let before = particle(&app, cloth, held);
    for step in 1..=30 {
        let displacement = Vec2::new(2.0, -1.0) * step as f32;
        finger(&mut app, 7, TouchPhase::Moved, place + displacement);
        frames(&mut app, 1);
    }
    frames(&mut app, 20);
    let moved = particle(&app, cloth, held) - before;
    assert!(moved.length() > 0.1 && moved.y > 0.0, "{moved}");
    finger(&mut app, 7, TouchPhase::Ended, place);
    frames(&mut app, 3);
    assert_eq!(get::<ClothGrab>(&app, cloth).particle(), None);
}

#[test]
fn two_fingers_turn_and_zoom_and_hold_nothing() {
    let mut app = demo(SceneKind::Curtain);
    frames(&mut app, 30);
    let before = view(&mut app);
    let (cloth, place) = on_cloth(&mut app);
    let other = place + Vec2::new(60.0, 0.0);
    finger(&mut app, 1, TouchPhase::Started, place);
    frames(&mut app, 2);
    assert!(get::<ClothGrab>(&app, cloth).particle().is_some());
    finger(&mut app, 2, TouchPhase::Started, other);
    frames(&mut app, 3);
    assert_eq!(get::<ClothGrab>(&app, cloth).particle(), None);
    for step in 1..=10 {
        let displacement = step as f32;
        finger(
            &mut app,
            1,
            TouchPhase::Moved,
            place + 4.0 * displacement * Vec2::X,
        );
        finger(
            &mut app,
            2,
            TouchPhase::Moved,
            other + 8.0 * displacement * Vec2::X,
        );
        frames(&mut app, 1);
    }
    let after = view(&mut app);
    // Both go to the right: what is seen goes along.
    assert!(after.yaw < before.yaw, "{after:?}");
    // From 60 to 100 pixels apart.
    let expected = before.distance * 60.0 / 100.0;
    assert!(
        (after.distance - expected).abs() < 1e-3 * expected,
        "{after:?}"
    );
}

#[test]
fn keys_move_a_hand_that_drags_cloth() {
    let mut app = demo(SceneKind::Curtain);
    frames(&mut app, 30);
    let cloth = one::<With<SceneCloth>>(&mut app);
    let holds = |app: &App| get::<ClothGrab>(app, cloth).particle();
    let hand = |app: &App| *app.world().resource::<Hand>();
    assert_eq!(hand(&app).at, None);
    tap(&mut app, KeyCode::KeyG);
    frames(&mut app, 10);
    let held = holds(&app).expect("held") as usize;
    assert_eq!(get::<ClothDrag>(&app, cloth).pointer, Hand::POINTER);
    let (before, at) = (particle(&app, cloth, held), hand(&app).at.expect("shown"));
    for code in [KeyCode::KeyL, KeyCode::KeyI] {
        key(&mut app, code, ButtonState::Pressed);
    }
    frames(&mut app, 30);
    for code in [KeyCode::KeyL, KeyCode::KeyI] {
        key(&mut app, code, ButtonState::Released);
    }
    frames(&mut app, 20);
    let displacement = hand(&app).at.expect("shown") - at;
    assert!(
        displacement.x > 50.0 && displacement.y < -50.0,
        "{displacement}"
    );
    let moved = particle(&app, cloth, held) - before;
    assert!(moved.x > 0.1 && moved.y > 0.1, "{moved}");

    let depth = get::<ClothDrag>(&app, cloth).depth;
    key(&mut app, KeyCode::KeyO, ButtonState::Pressed);
    frames(&mut app, 15);
    key(&mut app, KeyCode::KeyO, ButtonState::Released);
    // A quarter of a second at 0.8 m/s.
    let away = get::<ClothDrag>(&app, cloth).depth - depth;
    assert!((0.15..0.25).contains(&away), "{away}");

    tap(&mut app, KeyCode::KeyP);
    let user_pins = |app: &App| {
        let pins = &get::<ClothPins>(app, cloth).pins;
        pins.iter()
            .filter(|pin| pin.author == ClothPinAuthor::User)
            .count()
    };
    assert!(user_pins(&app) > 0);
    tap(&mut app, KeyCode::KeyG);
    frames(&mut app, 3);
    assert_eq!(holds(&app), None);
    tap(&mut app, KeyCode::KeyP);
    assert_eq!(user_pins(&app), 0);
    tap(&mut app, KeyCode::Escape);
    assert_eq!(hand(&app), Hand::default());
}

#[test]
fn b_blurs_what_is_not_in_focus() {
    let mut app = demo(SceneKind::Flag);
    let camera = one::<With<OrbitCamera>>(&mut app);
    tap(&mut app, KeyCode::KeyB);
    frames(&mut app, 2);
    let lens = *get::<DepthOfField>(&app, camera);
    assert_eq!(lens.focal_distance, view(&mut app).distance);
    assert_eq!(lens.aperture_f_stops, settings(&app).look.f_number);
    key(&mut app, KeyCode::Minus, ButtonState::Pressed);
    frames(&mut app, 10);
    let farther = get::<DepthOfField>(&app, camera).focal_distance;
    assert!(farther > lens.focal_distance);
    assert_eq!(farther, view(&mut app).distance);
    tap(&mut app, KeyCode::KeyB);
    frames(&mut app, 2);
    assert!(app.world().get::<DepthOfField>(camera).is_none());
}

#[test]
fn the_camera_goes_along_with_the_wearer_of_the_cape_and_with_nobody_else() {
    let mut app = demo(SceneKind::Cape);
    let runner = one::<With<Followed>>(&mut app);
    for _ in 0..5 {
        frames(&mut app, 60);
        let place = get::<Transform>(&app, runner).translation.with_y(0.0);
        let followed = view(&mut app).followed.expect("followed");
        // At 3 m/s, a fifth of a second late, or put elsewhere half a second ago.
        assert!(followed.distance(place) < 1.3, "{followed} {place}");
    }
    tap(&mut app, KeyCode::Digit1);
    frames(&mut app, 3);
    assert_eq!(view(&mut app).followed, None);
}

/// A gamepad that nobody touches yet.
fn gamepad(app: &mut App) -> Entity {
    app.world_mut().spawn(Gamepad::default()).id()
}

fn pad(app: &mut App, entity: Entity) -> Mut<'_, Gamepad> {
    app.world_mut().get_mut(entity).expect("a gamepad")
}

#[test]
fn sticks_and_triggers_move_ball_and_view() {
    let mut app = demo(SceneKind::Ball);
    let entity = gamepad(&mut app);
    let ball = |app: &mut App| {
        let ball = one::<With<SceneSphere>>(app);
        get::<Transform>(app, ball).translation
    };
    let (start, from) = (ball(&mut app), view(&mut app));
    pad(&mut app, entity)
        .analog_mut()
        .set(GamepadAxis::LeftStickX, 1.0);
    frames(&mut app, 60);
    let displacement = ball(&mut app) - start;
    // A second at 1.5 m/s, to the right as seen; drawn up to a step late.
    let right = Quat::from_rotation_y(from.yaw) * Vec3::X;
    assert!(
        (displacement.dot(right) - 1.5).abs() < 0.06,
        "{displacement}"
    );
    assert!(
        displacement.reject_from(right).length() < 1e-4,
        "{displacement}"
    );
    pad(&mut app, entity)
        .analog_mut()
        .set(GamepadAxis::LeftStickX, 0.0);
    frames(&mut app, 2);
    let rests = ball(&mut app);
    frames(&mut app, 20);
    assert_eq!(ball(&mut app), rests);

    let mut now = pad(&mut app, entity);
    now.analog_mut().set(GamepadAxis::RightStickX, 0.5);
    now.analog_mut().set(GamepadButton::RightTrigger2, 1.0);
    frames(&mut app, 10);
    let to = view(&mut app);
    assert!(to.yaw > from.yaw && to.distance < from.distance, "{to:?}");
}

#[test]
fn buttons_of_the_gamepad_pause_and_change_scenes() {
    let mut app = demo(SceneKind::Curtain);
    let entity = gamepad(&mut app);
    let press = |app: &mut App, button| {
        for value in [1.0, 0.0] {
            let raw = RawGamepadButtonChangedEvent::new(entity, button, value);
            app.world_mut().write_message(RawGamepadEvent::Button(raw));
            app.update();
        }
    };
    press(&mut app, GamepadButton::South);
    assert!(settings(&app).paused);
    press(&mut app, GamepadButton::RightTrigger);
    assert_eq!(settings(&app).scene, SceneKind::Flag);
    press(&mut app, GamepadButton::LeftTrigger);
    assert_eq!(settings(&app).scene, SceneKind::Curtain);
    let resets = settings(&app).resets;
    press(&mut app, GamepadButton::West);
    assert_eq!(settings(&app).resets, resets + 1);
}
