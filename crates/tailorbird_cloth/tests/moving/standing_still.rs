//! Motion while a cloth did not simulate carries it along.

use bevy_ecs::{entity_disabling::Disabled, prelude::*};
use bevy_math::Vec3;
use bevy_time::{Time, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

use crate::game::{HELD, SIZE, cape, film, game, spawn_cape};

const RATES: [f64; 3] = [30.0, 60.0, 144.0];

/// Why a cloth does not simulate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Why {
    Paused,
    StandsStill,
    SettingsPaused,
    Disabled,
    TakenOff,
}

const ALL: [Why; 5] = [
    Why::Paused,
    Why::StandsStill,
    Why::SettingsPaused,
    Why::Disabled,
    Why::TakenOff,
];

fn stop(game: &mut Sim, cloth: Entity, why: Why, stops: bool) {
    match why {
        Why::Paused => game.pause(stops),
        Why::StandsStill => {
            let mut time = game.resource_mut::<Time<Virtual>>();
            time.set_relative_speed(if stops { 0.0 } else { 1.0 });
        }
        Why::SettingsPaused => {
            game.settings().paused = stops;
        }
        Why::Disabled => {
            let mut cloth = game.app.world_mut().entity_mut(cloth);
            if stops {
                cloth.insert(Disabled);
            } else {
                cloth.remove::<Disabled>();
            }
        }
        Why::TakenOff => {
            let mut cloth = game.app.world_mut().entity_mut(cloth);
            if stops {
                let shape = cloth.take::<Cloth>();
                cloth.insert(Shape(shape));
            } else if let Some(Shape(Some(shape))) = cloth.take::<Shape>() {
                cloth.insert(shape);
            }
        }
    }
}

/// Cloth that was taken off.
#[derive(Component)]
struct Shape(Option<Cloth>);

#[test]
fn what_moved_meanwhile_is_not_felt() {
    for fps in RATES {
        for held in HELD {
            for why in ALL {
                for displacement in [0.5, 2.0] {
                    let mut game = game(fps, 60.0);
                    let (cloth, body) = spawn_cape(&mut game, held);
                    game.seconds(2.0);
                    let before = game.at(cloth, 300);
                    stop(&mut game, cloth, why, true);
                    game.frames(3);
                    // At once, and then bit by bit.
                    game.shift(body, Vec3::X * 0.8 * displacement);
                    for _ in 0..10 {
                        game.frames(1);
                        game.shift(body, Vec3::X * 0.02 * displacement);
                    }
                    game.frames(3);
                    stop(&mut game, cloth, why, false);
                    film(&mut game);
                    let mut speed = 0.0f32;
                    for _ in 0..20 {
                        game.frames(1);
                        speed = speed.max(game.fastest(cloth));
                    }
                    let film = film(&mut game);
                    let name = format!("{fps} {held:?} {why:?} {displacement}");
                    assert!(speed < 1e-3, "{name}: {speed} m/s");
                    assert!(film.stretch() < 2e-4, "{name}: {}", film.stretch());
                    let moved = game.at(cloth, 300) - before;
                    assert!(
                        moved.distance(Vec3::X * displacement) < 1e-5,
                        "{name}: {moved}"
                    );
                }
            }
        }
    }
}

/// A cloth whose targets were set elsewhere in a pause.
#[test]
fn targets_that_moved_meanwhile_are_not_felt() {
    for space in [ClothTargetSpace::Frame, ClothTargetSpace::World] {
        for why in ALL {
            let mut game = game(60.0, 60.0);
            let held =
                (0..SIZE.element_product()).map(|i| if i < SIZE.x { 0.0 } else { f32::INFINITY });
            let cloth = game.spawn((
                cape(),
                ClothMotionConstraints::at_most(ClothPerParticle::Each(held.collect())),
                ClothMotionTargets::in_space(space),
            ));
            let rest = game.get::<Cloth>(cloth).rest_positions();
            let aim = |game: &mut Sim, displacement: Vec3| {
                game.edit::<ClothMotionTargets>(cloth, |targets| {
                    targets.set_positions(rest.iter().map(|p| *p + displacement));
                });
            };
            aim(&mut game, Vec3::ZERO);
            game.seconds(2.0);
            stop(&mut game, cloth, why, true);
            game.frames(2);
            aim(&mut game, Vec3::X * 2.0);
            game.frames(2);
            stop(&mut game, cloth, why, false);
            let mut speed = 0.0f32;
            for _ in 0..20 {
                game.frames(1);
                speed = speed.max(game.fastest(cloth));
            }
            assert!(speed < 6e-4, "{space:?} {why:?}: {speed} m/s");
            assert!(game.at(cloth, 0).distance(Vec3::new(1.6, 0.0, 0.0)) < 1e-4);
        }
    }
}

/// A level is loaded, or the app was suspended.
#[test]
fn what_moved_in_a_frame_that_took_very_long_is_not_felt() {
    for fps in RATES {
        for held in HELD {
            let mut game = game(fps, 60.0);
            let (cloth, body) = spawn_cape(&mut game, held);
            game.seconds(2.0);
            film(&mut game);
            game.set_frame(std::time::Duration::from_secs(10));
            game.frames(1);
            game.shift(body, Vec3::X * 1.5);
            game.set_frame(std::time::Duration::from_secs_f64(1.0 / fps));
            let mut speed = 0.0f32;
            for _ in 0..20 {
                game.frames(1);
                speed = speed.max(game.fastest(cloth));
            }
            assert!(speed < 1e-3, "{fps} {held:?}: {speed} m/s");
            assert!(film(&mut game).stretch() < 2e-4);
        }
    }
}

/// A body that moved meanwhile sweeps nothing along.
#[test]
fn a_collider_that_moved_meanwhile_sweeps_nothing_along() {
    let mut game = game(60.0, 60.0);
    let cloth = game.spawn((cape(), ClothPins::edges([ClothEdge::Top])));
    let ball = game.spawn((
        ClothCollider::sphere(0.2),
        Transform::from_xyz(0.0, -0.6, -1.0),
    ));
    game.seconds(2.0);
    game.pause(true);
    game.frames(2);
    game.shift(ball, Vec3::Z * 2.0);
    game.frames(2);
    game.pause(false);
    for _ in 0..20 {
        game.frames(1);
        let speed = game.fastest(cloth);
        assert!(speed < 1e-4, "{speed} m/s");
    }
}
