//! An entity that is put elsewhere takes its cloth along.

use bevy_app::{PostUpdate, Update};
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Path, Sim, When};

use crate::game::{HELD, Held, cape, film, game, game_stepping_in, spawn_cape};

const RATES: [f64; 4] = [30.0, 60.0, 64.0, 144.0];

#[derive(Resource, Default)]
struct Told(Vec<ClothMotionTeleported>);

fn listen(game: &mut Sim) {
    game.app.init_resource::<Told>().add_systems(
        Update,
        |mut messages: MessageReader<ClothMotionTeleported>, mut told: ResMut<Told>| {
            told.0.extend(messages.read().copied());
        },
    );
}

fn told(game: &Sim) -> &[ClothMotionTeleported] {
    &game.resource::<Told>().0
}

/// A runner who hops 2 m ahead and then 2 m aside.
fn hopping(t: f32) -> Transform {
    let ahead = if t > 2.02 { 2.0 } else { 0.0 };
    let aside = if t > 2.52 { 2.0 } else { 0.0 };
    Transform::from_xyz(3.0 * (t - 1.0).clamp(0.0, 5.0) + ahead, 0.0, aside)
}

fn running(t: f32) -> Transform {
    Transform::from_xyz(3.0 * (t - 1.0).clamp(0.0, 5.0), 0.0, 0.0)
}

#[test]
fn a_hop_of_two_metres_stretches_nothing_and_is_told() {
    for fps in RATES {
        for held in HELD {
            for when in [When::FixedUpdate, When::Update, When::PostUpdate] {
                let run = |path: fn(f32) -> Transform| {
                    let mut game = game(fps, 60.0);
                    listen(&mut game);
                    let (_, body) = spawn_cape(&mut game, held);
                    game.insert(body, Path::when(when, path));
                    game.seconds(1.9);
                    film(&mut game);
                    game.seconds(1.5);
                    let film = film(&mut game);
                    game.frames(1);
                    let told = told(&game).to_vec();
                    (film, told, body)
                };
                let (hops, told, body) = run(hopping);
                let (runs, _, _) = run(running);
                let name = format!("{fps} {held:?} {when:?}");
                let (is, should) = (hops.stretch(), runs.stretch());
                assert!(is < 0.022, "{name}: {is}, {should} without");
                let expected = ClothMotionTeleported {
                    entity: body,
                    told: false,
                };
                assert_eq!(told, [expected; 2], "{name}");
                // Nothing but the place is another one.
                let (a, b) = (hops.steps.last().unwrap(), runs.steps.last().unwrap());
                for (a, b) in a.iter().zip(b) {
                    let displacement = *a - *b - Vec3::new(2.0, 0.0, 2.0);
                    assert!(displacement.length() < 2e-5, "{name}: {displacement}");
                }
            }
        }
    }
}

#[test]
fn a_hop_that_turns_round_turns_the_cape() {
    fn path(t: f32) -> Transform {
        if t > 2.0 {
            Transform::from_xyz(3.0, 1.0, 0.0).with_rotation(Quat::from_rotation_y(2.5))
        } else {
            Transform::default()
        }
    }
    for held in HELD {
        let mut game = game(60.0, 60.0);
        let (cloth, body) = spawn_cape(&mut game, held);
        let mover = Path::when(When::PostUpdate, path);
        game.insert(body, mover);
        game.seconds(3.0);
        let film = film(&mut game);
        assert!(film.stretch() < 2e-4, "{held:?}: {}", film.stretch());
        let speed = game.fastest(cloth);
        assert!(speed < 1e-3, "{held:?}: {speed}");
    }
}

/// Two shoulders, below one body or by themselves; and a cape that is the child of what it is attached to.
#[test]
fn what_several_hold_goes_along_with_all_of_them() {
    for fps in RATES {
        for (below, child) in [(true, false), (false, false), (true, true)] {
            let mut game = game(fps, 60.0);
            let cloth = game.spawn(cape());
            let body = game.spawn(Transform::default());
            let hands = [ClothCorner::TopLeft, ClothCorner::TopRight].map(|corner| {
                let hand = game.spawn(Transform::default());
                game.attach(cloth, hand, ClothAttachment::corner(corner));
                hand
            });
            let world = game.app.world_mut();
            if below {
                world.entity_mut(body).add_children(&hands);
            }
            if child {
                world.entity_mut(body).add_child(cloth);
            }
            // At once from a plane it snaps taut.
            game.seconds(6.0);
            film(&mut game);
            let before = game.at(cloth, 300);
            let hop = Vec3::new(2.0, 0.5, 0.0);
            if below {
                game.shift(body, hop);
            } else {
                for hand in hands {
                    game.shift(hand, hop);
                }
            }
            game.frames(10);
            let film = film(&mut game);
            let name = format!("{fps} {below} {child}");
            assert!(film.stretch() < 1.8e-3, "{name}: {}", film.stretch());
            let moved = game.at(cloth, 300) - before;
            assert!(moved.distance(hop) < 1e-5, "{name}: {moved}");
        }
    }
}

/// One of a quarter of a metre is told.
#[test]
fn a_short_hop_of_a_holder_is_told() {
    for fps in RATES {
        for held in HELD {
            let mut game = game(fps, 60.0);
            listen(&mut game);
            let (cloth, body) = spawn_cape(&mut game, held);
            game.seconds(2.0);
            let before = game.at(cloth, 300);
            game.shift(body, Vec3::X * 0.25);
            game.edit::<ClothSampledMotion>(body, ClothSampledMotion::teleport);
            let mut speed = 0.0f32;
            for _ in 0..20 {
                game.frames(1);
                speed = speed.max(game.fastest(cloth));
            }
            assert!(speed < 1e-3, "{fps} {held:?}: {speed}");
            let moved = game.at(cloth, 300) - before;
            assert!(moved.distance(Vec3::X * 0.25) < 1e-5, "{moved}");
            let expected = ClothMotionTeleported {
                entity: body,
                told: true,
            };
            assert_eq!(told(&game), [expected], "{fps} {held:?}");
        }
    }
}

/// Cape, body, ground: all of it.
#[test]
fn nobody_feels_that_the_origin_is_shifted() {
    for fps in RATES {
        for held in HELD {
            let run = |shift: Vec3| {
                let mut game = game(fps, 60.0);
                let (cloth, body) = spawn_cape(&mut game, held);
                let ball = Transform::from_xyz(0.1, -0.7, -0.15);
                game.spawn((ClothCollider::sphere(0.2), ball));
                game.spawn((
                    ClothCollider::half_space(),
                    Transform::from_xyz(0.0, -1.1, 0.0),
                ));
                game.seconds(2.0);
                for _ in 0..30 {
                    game.shift(body, Vec3::X * 0.05);
                    game.frames(1);
                }
                let mut all = game
                    .app
                    .world_mut()
                    .query_filtered::<&mut Transform, Without<ChildOf>>();
                for mut place in all.iter_mut(game.app.world_mut()) {
                    place.translation += shift;
                }
                for _ in 0..30 {
                    game.shift(body, Vec3::X * 0.05);
                    game.frames(1);
                }
                let particles: &ClothParticles = game.get(cloth);
                let count = particles.len();
                let places = (0..count).map(|i| game.at(cloth, i) - shift);
                (places.collect::<Vec<_>>(), film(&mut game).stretch())
            };
            let (still, stretch) = run(Vec3::ZERO);
            let (shifted, stretch_shifted) = run(Vec3::new(2.0, 0.0, -2.0));
            let name = format!("{fps} {held:?}");
            for (a, b) in still.iter().zip(&shifted) {
                assert!(a.distance(*b) < 2e-4, "{name}: {a} {b}");
            }
            assert!(
                stretch_shifted < 1.01 * stretch + 1e-4,
                "{name}: {stretch_shifted}"
            );
        }
    }
}

/// The ball is put to the other side.
#[test]
fn a_collider_that_hops_sweeps_nothing_along() {
    for fps in RATES {
        let mut game = game(fps, 60.0);
        let cloth = game.spawn((cape(), ClothPins::edges([ClothEdge::Top])));
        let ball = Transform::from_xyz(0.0, -0.6, -1.0);
        let ball = game.spawn((ClothCollider::sphere(0.2), ball));
        game.seconds(2.0);
        game.shift(ball, Vec3::Z * 2.0);
        for _ in 0..20 {
            game.frames(1);
            let speed = game.fastest(cloth);
            assert!(speed < 1e-4, "{fps}: {speed} m/s");
        }
    }
}

/// The cape's holder gets another parent.
#[test]
fn a_holder_that_gets_another_parent_takes_the_cloth_along() {
    for fps in RATES {
        let mut game = game(fps, 60.0);
        let (cloth, body) = spawn_cape(&mut game, Held::Attached);
        let other = game.spawn(Transform::from_xyz(1.0, 0.3, 0.0));
        game.seconds(2.0);
        film(&mut game);
        game.insert(body, ChildOf(other));
        let mut speed = 0.0f32;
        for _ in 0..20 {
            game.frames(1);
            speed = speed.max(game.fastest(cloth));
        }
        assert!(speed < 5e-4, "{fps}: {speed}");
        assert!(film(&mut game).stretch() < 2e-4);
    }
}

/// A bone in centimetres swings as any other; the threshold is in metres.
#[test]
fn a_scaled_parent_does_not_make_hops_of_motion() {
    fn swing(t: f32) -> Transform {
        Transform::from_xyz(50.0 * (6.0 * t).sin(), 0.0, 0.0)
    }
    let mut game = game(60.0, 60.0);
    listen(&mut game);
    let armature = game.spawn(Transform::from_scale(Vec3::splat(0.01)));
    let bone = game.spawn((
        Transform::default(),
        ChildOf(armature),
        Path::when(When::PostUpdate, swing),
    ));
    let cloth = game.spawn(cape());
    game.attach(cloth, bone, ClothAttachment::edge(ClothEdge::Top));
    game.seconds(3.0);
    assert_eq!(told(&game), []);
}

#[test]
fn the_threshold_is_a_setting_and_a_wrong_one_is_told() {
    let mut game = game(60.0, 60.0);
    listen(&mut game);
    let (_, body) = spawn_cape(&mut game, Held::Attached);
    for (speed, hops) in [(f32::INFINITY, 0), (30.0, 1), (f32::NAN, 2), (5.0, 3)] {
        let mut settings = game.resource_mut::<ClothSettings>();
        settings.teleport_speed = speed;
        let wrong = settings.errors();
        assert_eq!(wrong.len(), usize::from(speed.is_nan()), "{wrong:?}");
        game.shift(body, Vec3::X * if hops == 3 { 0.2 } else { 2.0 });
        game.seconds(1.0);
        assert_eq!(told(&game).len(), hops, "{speed}");
    }
}

/// A holder that stood moves at this speed from one step to the next, for good.
#[test]
fn no_start_is_too_sudden() {
    for held in HELD {
        for speed in [2.0, 4.0, 6.0, 8.0, 12.0, 20.0, 29.0f32] {
            let mut game = game(60.0, 60.0);
            listen(&mut game);
            let (cloth, body) = spawn_cape(&mut game, held);
            game.seconds(2.0);
            film(&mut game);
            for _ in 0..60 {
                game.shift(body, Vec3::X * speed / 60.0);
                game.frames(1);
            }
            let film = film(&mut game);
            let mean = film.stretch.iter().map(|s| s.mean).fold(0.0, f32::max);
            let largest = film.stretch();
            println!("{speed} {held:?}: mean {mean:.4}, largest {largest:.3}");
            // Springs between the cloth and what holds it swing, and are as they were.
            if held != Held::Sprung {
                assert!(mean < 0.002 && largest < 0.014, "{held:?} {speed}");
                // It is where it is held in each step all the same.
                let corner = game.at(cloth, 0).x + 0.4;
                assert!(
                    (corner - speed).abs() < 1.5e-5,
                    "{held:?} {speed}: {corner}"
                );
            }
        }
    }
}

/// Without a fixed loop there is a step in each frame, and nothing between.
#[test]
fn a_cloth_that_steps_in_each_frame_is_carried_as_well() {
    let mut game = game_stepping_in(PostUpdate, 60.0);
    listen(&mut game);
    let (cloth, body) = spawn_cape(&mut game, Held::Attached);
    game.insert(body, Path::when(When::Update, hopping));
    game.seconds(1.9);
    film(&mut game);
    game.seconds(1.5);
    assert!(film(&mut game).stretch() < 7.5e-4);
    assert_eq!(told(&game).len(), 2);
    let place = game.get::<Transform>(body).translation;
    assert!(game.at(cloth, 0).distance(place - 0.4 * Vec3::X) < 1e-5);
    game.pause(true);
    game.frames(2);
    game.app.world_mut().entity_mut(body).remove::<Path>();
    game.shift(body, Vec3::X * 0.4);
    game.frames(2);
    game.pause(false);
    let speed = game.fastest(cloth);
    game.frames(20);
    assert!(game.fastest(cloth) < speed + 1e-3);
    assert!(film(&mut game).stretch() < 0.01);
}
