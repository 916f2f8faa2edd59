//! Dragging: press grabs, moving moves, release lets fall, P pins, P releases; through the events of a window.

use std::time::Duration;

use bevy::{
    input::ButtonState, picking::events::PointerOver, prelude::*, time::TimeUpdateStrategy,
};
use tailorbird::prelude::*;

use crate::game::*;

const N: u32 = 17;

/// A game whose player has taken the cloth at a particle.
fn grabbed(at: usize) -> (App, Entity, Entity) {
    let mut app = game();
    let camera = camera(&mut app, 4.0, None, 0);
    let cloth = curtain(&mut app, N);
    app.insert_resource(ClothSettings {
        gravity: Vec3::ZERO,
        ..default()
    });
    // A breath of air: a sheet that hangs in a perfect plane has no side to buckle to when it is pushed together.
    app.insert_resource(ClothWind::steady(Vec3::new(0.0, 0.05, 0.3)));
    frames(&mut app, 3);
    let place = particle(&app, cloth, at);
    let place = on_screen(&app, camera, place);
    point(&mut app, place);
    frames(&mut app, 2);
    button(&mut app, MouseButton::Left, ButtonState::Pressed);
    frames(&mut app, 2);
    (app, camera, cloth)
}

const MIDDLE: usize = (N * (N / 2) + N / 2) as usize;

#[test]
fn press_grabs_the_nearest_particle_and_its_neighbors() {
    let (app, _, cloth) = grabbed(MIDDLE);
    assert!(app.world().get::<ClothDrag>(cloth).is_some());
    let grab = get::<ClothGrab>(&app, cloth);
    assert_eq!(grab.particle(), Some(MIDDLE as u32));
    assert!(grab.particles().count() >= 9);
}

#[test]
fn moving_moves_in_the_plane_parallel_to_the_screen_and_the_wheel_in_depth() {
    let (mut app, camera, cloth) = grabbed(MIDDLE);
    // Within reach of both pins, also after the wheel.
    let target = Vec3::new(0.1, 0.3, 0.0);
    let place = on_screen(&app, camera, target);
    point(&mut app, place);
    frames(&mut app, 60);
    let held = particle(&app, cloth, MIDDLE);
    assert!(held.distance(target) < 0.02, "{held}");

    wheel(&mut app, -3.0);
    frames(&mut app, 60);
    let held = particle(&app, cloth, MIDDLE);
    let step = app.world().resource::<ClothDragSettings>().wheel_step;
    assert!((held.z - 3.0 * step).abs() < 0.02, "{held}");
    // Neighbours came along, smoothly: no edge of the sheet is a spike.
    let stretch = get::<ClothParticles>(&app, cloth).stretch(get::<ClothTopology>(&app, cloth));
    assert!(stretch.max < 0.15, "{stretch:?}");
}

#[test]
fn release_lets_fall() {
    let (mut app, camera, cloth) = grabbed(MIDDLE);
    let place = on_screen(&app, camera, Vec3::new(0.2, 0.5, 0.0));
    point(&mut app, place);
    frames(&mut app, 60);
    let before = particle(&app, cloth, MIDDLE);
    button(&mut app, MouseButton::Left, ButtonState::Released);
    app.world_mut().resource_mut::<ClothSettings>().gravity = Vec3::NEG_Y * 9.81;
    frames(&mut app, 30);
    assert!(app.world().get::<ClothDrag>(cloth).is_none());
    assert_eq!(get::<ClothGrab>(&app, cloth).particle(), None);
    assert!(particle(&app, cloth, MIDDLE).y < before.y - 0.1);
}

#[test]
fn released_far_from_the_cloth_it_is_let_go_all_the_same() {
    let (mut app, _, cloth) = grabbed(MIDDLE);
    point(&mut app, Vec2::new(5.0, 5.0));
    button(&mut app, MouseButton::Left, ButtonState::Released);
    frames(&mut app, 2);
    assert!(app.world().get::<ClothDrag>(cloth).is_none());
}

#[test]
fn p_pins_what_is_held_and_p_again_releases_that_and_no_more() {
    let (mut app, camera, cloth) = grabbed(MIDDLE);
    let target = Vec3::new(0.1, 0.3, 0.0);
    let place = on_screen(&app, camera, target);
    point(&mut app, place);
    frames(&mut app, 60);
    tap(&mut app, KeyCode::KeyP);
    button(&mut app, MouseButton::Left, ButtonState::Released);
    let pinned = particle(&app, cloth, MIDDLE);
    app.world_mut().resource_mut::<ClothSettings>().gravity = Vec3::NEG_Y * 9.81;
    frames(&mut app, 120);
    assert!(get::<ClothPins>(&app, cloth).has_user_pins());
    assert!(particle(&app, cloth, MIDDLE).distance(pinned) < 1e-5);

    tap(&mut app, KeyCode::KeyP);
    frames(&mut app, 60);
    assert!(!get::<ClothPins>(&app, cloth).has_user_pins());
    assert_eq!(get::<ClothPins>(&app, cloth).pins.len(), 2);
    assert!(particle(&app, cloth, MIDDLE).distance(pinned) > 0.05);
    // The pins of the scene hold.
    assert!(particle(&app, cloth, 0).distance(Vec3::new(-1.0, 1.0, 0.0)) < 1e-6);
}

#[test]
fn scene_pins_are_released_where_that_is_configured() {
    let mut app = game();
    let cloth = curtain(&mut app, N);
    app.world_mut()
        .resource_mut::<ClothDragSettings>()
        .release_scene_pins = true;
    frames(&mut app, 3);
    tap(&mut app, KeyCode::KeyP);
    frames(&mut app, 30);
    assert!(get::<ClothPins>(&app, cloth).pins.is_empty());
    assert!(particle(&app, cloth, 0).y < 0.9);
}

#[test]
fn events_tell_what_happened() {
    #[derive(Resource, Default)]
    struct Log(Vec<&'static str>);
    let (mut app, ..) = grabbed(MIDDLE);
    app.init_resource::<Log>();
    app.add_observer(|_: On<ClothPinned>, mut log: ResMut<Log>| log.0.push("pinned"));
    app.add_observer(|_: On<ClothReleased>, mut log: ResMut<Log>| log.0.push("released"));
    app.add_observer(|_: On<ClothUnpinned>, mut log: ResMut<Log>| log.0.push("unpinned"));
    app.add_observer(|_: On<ClothGrabbed>, mut log: ResMut<Log>| log.0.push("grabbed"));
    tap(&mut app, KeyCode::KeyP);
    button(&mut app, MouseButton::Left, ButtonState::Released);
    frames(&mut app, 2);
    tap(&mut app, KeyCode::KeyP);
    frames(&mut app, 2);
    button(&mut app, MouseButton::Left, ButtonState::Pressed);
    frames(&mut app, 2);
    assert_eq!(
        app.world().resource::<Log>().0,
        ["pinned", "released", "unpinned", "grabbed"]
    );
}

#[test]
fn despawn_while_dragging_harms_nothing() {
    let (mut app, camera, cloth) = grabbed(MIDDLE);
    app.world_mut().despawn(cloth);
    let place = on_screen(&app, camera, Vec3::ZERO);
    point(&mut app, place);
    frames(&mut app, 3);
    tap(&mut app, KeyCode::KeyP);
    button(&mut app, MouseButton::Left, ButtonState::Released);
    frames(&mut app, 3);

    let (mut app, camera, cloth) = grabbed(MIDDLE);
    app.world_mut().despawn(camera);
    frames(&mut app, 3);
    assert!(app.world().get::<ClothDrag>(cloth).is_none());
}

#[test]
fn each_viewport_drags_through_its_own_camera() {
    let mut app = game();
    let half = UVec2::new(SIZE.x / 2, SIZE.y);
    let left = camera(&mut app, 4.0, Some((UVec2::ZERO, half)), 0);
    let right = camera(&mut app, 8.0, Some((UVec2::new(SIZE.x / 2, 0), half)), 1);
    let cloth = curtain(&mut app, N);
    app.insert_resource(ClothSettings {
        gravity: Vec3::ZERO,
        ..default()
    });
    frames(&mut app, 3);
    for view in [left, right] {
        let at = 5 * N as usize + 12;
        let place = particle(&app, cloth, at);
        let place = on_screen(&app, view, place);
        point(&mut app, place);
        frames(&mut app, 2);
        button(&mut app, MouseButton::Left, ButtonState::Pressed);
        frames(&mut app, 2);
        assert_eq!(get::<ClothDrag>(&app, cloth).camera, view);
        assert_eq!(get::<ClothGrab>(&app, cloth).particle(), Some(at as u32));
        button(&mut app, MouseButton::Left, ButtonState::Released);
        frames(&mut app, 2);
    }
}

#[test]
fn pointer_events_carry_triangle_and_weights() {
    #[derive(Resource, Default)]
    struct Found(Option<(ClothPointerHit, Vec3)>);
    let mut app = game();
    let camera = camera(&mut app, 4.0, None, 0);
    let cloth = curtain(&mut app, N);
    app.insert_resource(ClothSettings {
        paused: true,
        ..default()
    });
    app.init_resource::<Found>();
    app.world_mut()
        .entity_mut(cloth)
        .observe(|over: On<PointerOver>, mut found: ResMut<Found>| {
            let (Some(hit), Some(position)) =
                (over.hit.extra_as::<ClothPointerHit>(), over.hit.position)
            else {
                panic!("a hit without data");
            };
            found.0 = Some((*hit, position));
        });
    frames(&mut app, 3);
    let target = Vec3::new(0.33, -0.21, 0.0);
    let place = on_screen(&app, camera, target);
    point(&mut app, place);
    frames(&mut app, 2);
    let (hit, position) = app
        .world()
        .resource::<Found>()
        .0
        .expect("the pointer is over the cloth");
    assert!(position.distance(target) < 1e-3);
    let triangles = get::<ClothTopology>(&app, cloth).triangles();
    let corners = triangles
        .get(hit.triangle)
        .expect("a triangle of the cloth");
    assert!(corners.contains(&(hit.particle as u32)));
    let [a, b, c] = corners.map(|i| particle(&app, cloth, i as usize));
    let weighted = a * hit.barycentric.x + b * hit.barycentric.y + c * hit.barycentric.z;
    assert!(weighted.distance(target) < 1e-3);
}

/// Frames of a quarter of a second, of 15 steps each: what is held is in the hand all the same, also in a fine sheet.
#[test]
fn the_hand_holds_at_few_frames_per_second() {
    for n in [N, 97] {
        let mut app = game();
        let camera = camera(&mut app, 4.0, None, 0);
        let cloth = curtain(&mut app, n);
        let middle = (n * (n / 2) + n / 2) as usize;
        // A sheet in a perfect plane has no side to buckle to.
        app.insert_resource(ClothWind::steady(Vec3::new(0.0, 0.05, 0.8)));
        frames(&mut app, 120);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
            250,
        )));
        let before = particle(&app, cloth, middle);
        let place = on_screen(&app, camera, before);
        point(&mut app, place);
        frames(&mut app, 2);
        button(&mut app, MouseButton::Left, ButtonState::Pressed);
        frames(&mut app, 2);
        let held = get::<ClothGrab>(&app, cloth).particle().expect("held") as usize;
        let from = particle(&app, cloth, held);
        let target = from + Vec3::new(0.1, 0.3, 0.0);
        let displacement = on_screen(&app, camera, target) - on_screen(&app, camera, from);
        point(&mut app, place + displacement);
        frames(&mut app, 12);
        let away = particle(&app, cloth, held).distance(target);
        assert!(away < 0.04, "{n}: {away}");
    }
}

/// A shooter: its mouse buttons fire, its arrow keys and its P mean what it says.
#[test]
fn a_game_that_does_not_ask_for_it_lets_nobody_drag_pin_or_move() {
    let mut app = without_hands();
    app.finish();
    app.cleanup();
    let camera = camera(&mut app, 4.0, None, 0);
    let cloth = curtain(&mut app, N);
    let ball = (
        ClothCollider::sphere(0.1),
        ClothSphereControls::default(),
        Transform::from_xyz(0.0, 0.0, -2.0),
    );
    let ball = app.world_mut().spawn(ball).id();
    frames(&mut app, 3);
    let place = particle(&app, cloth, MIDDLE);
    let place = on_screen(&app, camera, place);
    point(&mut app, place);
    frames(&mut app, 2);
    button(&mut app, MouseButton::Left, ButtonState::Pressed);
    let (pins, at) = (
        get::<ClothPins>(&app, cloth).clone(),
        *get::<Transform>(&app, ball),
    );
    frames(&mut app, 2);
    for key_code in [KeyCode::KeyP, KeyCode::ArrowLeft] {
        key(&mut app, key_code, ButtonState::Pressed);
        frames(&mut app, 5);
    }
    assert!(app.world().get::<ClothDrag>(cloth).is_none());
    assert_eq!(get::<ClothGrab>(&app, cloth).particle(), None);
    assert_eq!(get::<ClothPins>(&app, cloth), &pins);
    assert_eq!(get::<Transform>(&app, ball), &at);
}
