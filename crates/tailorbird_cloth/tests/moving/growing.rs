//! A scale that changes keeps shape and motion.

use bevy_app::Update;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::Time;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Path, Sim, When, furthest};

use crate::game::{HELD, Held, cape, film, game, spawn_cape};

/// The cape as it hangs, by its own size.
fn shape(game: &Sim, cloth: Entity) -> Vec<Vec3> {
    let particles: &ClothParticles = game.get(cloth);
    let frame: &ClothFrame = game.get(cloth);
    particles.positions().map(|p| p / frame.scale()).collect()
}

#[test]
fn a_scale_that_changes_at_once_keeps_the_shape() {
    for scale in [
        Vec3::splat(2.0),
        Vec3::splat(0.5),
        Vec3::new(1.0, 1.5, 1.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.0, -1.0, 1.0),
        Vec3::new(1.0, 1.0, -1.0),
        Vec3::new(-1.0, -1.0, 1.0),
        Vec3::splat(-1.0),
    ] {
        for fixed in [Vec3::ONE, Vec3::new(1.0, 0.8, 0.6)] {
            let mut game = game(60.0, 60.0);
            let (cloth, body) = spawn_cape(&mut game, Held::Pinned);
            game.settings().gravity = Vec3::new(0.0, -6.0, -6.0);
            game.edit::<Transform>(body, |place| place.scale = fixed);
            game.frames(30);
            // It swings, and is far from its rest shape.
            let (before, speed) = (shape(&game, cloth), game.fastest(cloth));
            assert!(speed > 1.0, "{speed}");
            game.edit::<Transform>(body, |place| place.scale = scale * fixed);
            game.frames(1);
            let away = furthest(&before, &shape(&game, cloth));
            // What is turned out of its plane has other lengths after a stretch along one axis, and goes back to those of the fabric.
            let even = scale.abs() == Vec3::ONE * scale.x.abs();
            let step = if even { 2.0 * speed / 60.0 } else { 0.5 };
            assert!(away < step, "{scale} {fixed}: {away} of {step}");
            let now = game.fastest(cloth) / scale.abs().max_element();
            assert!(
                now < if even { 1.5 } else { 3.0 } * speed && now > 0.3 * speed,
                "{scale}: {now}, before {speed}"
            );
            let errors: &ClothStatus = game.get(cloth);
            assert!(errors.errors().next().is_none());
        }
    }
}

/// Writes it in the way of rollback, which writes all that a game set.
#[test]
fn a_cloth_that_is_written_as_it_was_while_it_grows_keeps_its_shape() {
    let grown = |written: bool| {
        let mut game = game(60.0, 60.0);
        let (cloth, body) = spawn_cape(&mut game, Held::Pinned);
        game.settings().gravity = Vec3::new(0.0, -6.0, -6.0);
        game.frames(30);
        game.edit::<Transform>(body, |place| place.scale = Vec3::splat(1.01));
        if written {
            game.edit::<Cloth>(cloth, |cloth| *cloth = cloth.clone());
        }
        game.frames(1);
        shape(&game, cloth)
    };
    assert_eq!(grown(true), grown(false));
}

#[derive(Component)]
struct Tween(fn(f32) -> f32);

fn tween(time: Res<Time>, mut all: Query<(&Tween, &mut Transform)>) {
    for (tween, mut place) in &mut all {
        place.scale = Vec3::splat(tween.0(time.elapsed_secs()));
    }
}

/// From 1 to 2 and back within two seconds.
fn there_and_back(t: f32) -> f32 {
    let t = (t - 2.0).clamp(0.0, 2.0);
    1.0 + 0.5 * (1.0 - (std::f32::consts::PI * t).cos())
}

/// A cape that hangs grows and shrinks: it is never flat, nor fast, nor stretched.
#[test]
fn a_tween_keeps_the_shape_in_each_frame() {
    for fps in [30.0, 60.0, 144.0] {
        for held in HELD {
            let mut game = game(fps, 60.0);
            game.app.add_systems(Update, tween);
            let (cloth, body) = spawn_cape(&mut game, held);
            game.insert(body, Tween(there_and_back));
            if matches!(held, Held::Attached | Held::Sprung) {
                // The cloth itself grows as well.
                game.insert(cloth, Tween(there_and_back));
            }
            game.seconds(2.0);
            let before = shape(&game, cloth);
            film(&mut game);
            let mut away = 0.0f32;
            let mut largest = 0.0f32;
            for _ in 0..(2.5 * fps) as u32 {
                game.frames(1);
                away = away.max(furthest(&before, &shape(&game, cloth)));
                largest = largest.max(game.get::<ClothFrame>(cloth).scale().x);
            }
            let film = film(&mut game);
            let name = format!("{fps} {held:?}");
            println!(
                "{name}: {away} m, {} , {} m/s",
                film.stretch(),
                film.speed(60.0)
            );
            assert!((largest - 2.0).abs() < 1e-3, "{name}: {largest}");
            assert!(away < 4e-4, "{name}: {away} m");
            assert!(film.stretch() < 4e-4, "{name}: {}", film.stretch());
            assert!(film.speed(60.0) < 3.0, "{name}: {}", film.speed(60.0));
        }
    }
}

/// The cape alone grows, while what holds it walks.
#[test]
fn a_cape_that_grows_goes_where_its_holder_goes() {
    fn walk(t: f32) -> Transform {
        Transform::from_xyz((t - 1.0).max(0.0), 0.0, 0.0)
    }
    let mut game = game(60.0, 60.0);
    game.app.add_systems(Update, tween);
    let (cloth, body) = spawn_cape(&mut game, Held::Attached);
    let mover = Path::when(When::PostUpdate, walk);
    game.insert(body, mover);
    game.insert(cloth, Tween(there_and_back));
    game.seconds(5.0);
    let film = film(&mut game);
    assert!(film.stretch() < 2.2e-3, "{}", film.stretch());
    let middle = 0.5 * (game.at(cloth, 0) + game.at(cloth, 15));
    let place = game.get::<Transform>(body).translation;
    assert!(middle.distance(place) < 0.025, "{middle} {place}");
}

#[test]
fn free_fall_goes_on() {
    let mut game = game(60.0, 60.0);
    let cloth = game.spawn(cape());
    game.edit::<ClothMaterial>(cloth, |material| material.damping = 0.0);
    game.seconds(0.5);
    let speed = game.fastest(cloth);
    game.edit::<Transform>(cloth, |place| place.scale = Vec3::splat(2.0));
    game.frames(1);
    let expected = 2.0 * speed + 9.81 / 60.0;
    let is = game.fastest(cloth);
    assert!((is - expected).abs() < 3e-4, "{is} {expected}");
}
