//! Motion in each frame gives the same as motion in `FixedUpdate`, at all rates.

use bevy_app::{FixedFirst, FixedLast, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;
use proptest::prelude::*;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Path, Sim, When};

use crate::game::{Film, HELD, Held, SIZE, TargetMover, cape, film, game, spawn_cape};

const RATES: [f64; 4] = [30.0, 60.0, 64.0, 144.0];

/// At most 3 m/s, 18 m/s².
fn swing(t: f32) -> Transform {
    let t = (t - 1.0).max(0.0);
    let ramp = (0.5 * t).min(1.0);
    Transform::from_xyz(
        0.5 * ramp * (6.0 * t).sin(),
        0.1 * ramp * (9.0 * t).sin(),
        0.0,
    )
    .with_rotation(Quat::from_rotation_y(0.4 * ramp * (5.0 * t).sin()))
}

/// Film from the fourth second on, for eight seconds, in air that is still: in a vacuum folds are as sharp as chance has it, and
/// twice the same motion, a step later, differs by 10 %.
fn filmed(fps: f64, hz: f64, prepare: impl FnOnce(&mut Sim)) -> Film {
    let mut game = game(fps, hz);
    game.app.insert_resource(ClothWind::default());
    prepare(&mut game);
    game.seconds(3.0);
    film(&mut game);
    game.seconds(8.0);
    film(&mut game)
}

/// Ratio of the jolts of all rows to those with motion in `FixedUpdate`, at worst.
fn worst(film: &Film, fixed: &Film, columns: usize) -> f32 {
    let rows = film.jolts(columns).into_iter().zip(fixed.jolts(columns));
    rows.map(|(is, should)| is / should).fold(0.0, f32::max)
}

fn swinging(fps: f64, hz: f64, held: Held, when: When) -> Film {
    filmed(fps, hz, |game| {
        let (_, body) = spawn_cape(game, held);
        game.insert(body, Path::when(when, swing));
    })
}

#[test]
fn a_cape_is_jolted_as_by_motion_in_fixed_steps() {
    for hz in [60.0, 64.0] {
        for held in HELD {
            let fixed = swinging(60.0, hz, held, When::FixedUpdate);
            for fps in RATES {
                for when in [When::Update, When::PostUpdate] {
                    let film = swinging(fps, hz, held, when);
                    let worst = worst(&film, &fixed, SIZE.x as usize);
                    println!("{held:?} {when:?} {fps} frames, {hz} steps: {worst:.3}");
                    assert!(worst < 1.2, "{held:?} {when:?} {fps} {hz}: {worst}");
                }
            }
        }
    }
}

/// A character that physics moves, and its bone, which is animated.
#[test]
fn a_bone_that_is_animated_on_what_the_fixed_loop_moves() {
    fn run(t: f32) -> Transform {
        Transform::from_xyz(5.0 * t, 0.0, 0.0)
    }
    let bones = |fps, when| {
        filmed(fps, 60.0, |game| {
            let cloth = game.spawn(cape());
            let body = game.spawn((Transform::default(), Path::when(When::FixedUpdate, run)));
            let bone = game.spawn((Transform::default(), Path::when(when, swing), ChildOf(body)));
            game.attach(cloth, bone, ClothAttachment::edge(ClothEdge::Top));
        })
    };
    let fixed = bones(60.0, When::FixedUpdate);
    for fps in RATES {
        let worst = worst(&bones(fps, When::PostUpdate), &fixed, SIZE.x as usize);
        println!("{fps}: {worst:.3}");
        assert!(worst < 1.2, "{fps}: {worst}");
    }
}

#[test]
fn targets_that_are_set_once_a_frame() {
    for space in [ClothTargetSpace::Frame, ClothTargetSpace::World] {
        let aimed = |fps, when| {
            filmed(fps, 60.0, |game| {
                game.spawn((
                    cape(),
                    ClothMotionConstraints::at_most(ClothPerParticle::Each(
                        (0..SIZE.element_product())
                            .map(|i| if i < SIZE.x { 0.0 } else { f32::INFINITY })
                            .collect(),
                    )),
                    ClothMotionTargets::in_space(space),
                    TargetMover(when, swing),
                ));
            })
        };
        let fixed = aimed(60.0, When::FixedUpdate);
        for fps in RATES {
            let worst = worst(&aimed(fps, When::PostUpdate), &fixed, SIZE.x as usize);
            println!("{space:?} {fps}: {worst:.3}");
            assert!(worst < 1.2, "{space:?} {fps}: {worst}");
        }
    }
}

/// A ball swings through the middle of a curtain.
#[test]
fn a_collider_that_is_moved_once_a_frame() {
    fn ball(t: f32) -> Transform {
        Transform::from_xyz(0.0, -0.6, 0.25 + 0.3 * (4.0 * t).cos())
    }
    let pushed = |fps, when| {
        filmed(fps, 60.0, |game| {
            game.spawn((
                Cloth::grid(Vec2::new(0.8, 1.2), SIZE).with_origin(Vec2::new(0.5, 0.0)),
                ClothPins::edges([ClothEdge::Top]),
                ClothMaterial::cotton(),
                ClothSleep::never(),
            ));
            game.spawn((
                ClothCollider::sphere(0.2),
                ball(0.0),
                Path::when(when, ball),
            ));
        })
    };
    let fixed = pushed(60.0, When::FixedUpdate);
    let all = |film: &Film| film.jolts(SIZE.x as usize).iter().sum::<f32>();
    for fps in RATES {
        let ratio = all(&pushed(fps, When::PostUpdate)) / all(&fixed);
        println!("{fps}: {ratio:.3}");
        assert!(ratio < 1.2, "{fps}: {ratio}");
    }
}

/// Steps see what `FixedUpdate` set, whatever the frames are.
#[test]
fn what_the_fixed_loop_moves_is_not_delayed() {
    for fps in RATES {
        for held in [Held::Pinned, Held::Child, Held::Attached] {
            let mut game = game(fps, 60.0);
            let (cloth, body) = spawn_cape(&mut game, held);
            game.insert(body, Path::when(When::FixedUpdate, swing));
            game.seconds(2.0);
            for _ in 0..40 {
                game.frames(1);
                let place = *game.get::<Transform>(body);
                let corner = place.transform_point(Vec3::new(-0.4, 0.0, 0.0));
                let away = game.at(cloth, 0).distance(corner);
                assert!(away < 1e-5, "{fps} {held:?}: {away}");
            }
        }
    }
}

/// State between the poses of a physics engine, which it puts back before its steps.
#[derive(Component, Default)]
struct Eased {
    poses: [Transform; 2],
}

fn restore(mut bodies: Query<(&Eased, &mut Transform)>) {
    for (eased, mut place) in &mut bodies {
        *place = eased.poses[1];
    }
}

fn note(mut bodies: Query<(&mut Eased, &Transform)>) {
    for (mut eased, place) in &mut bodies {
        eased.poses = [eased.poses[1], *place];
    }
}

fn ease(time: Res<Time<Fixed>>, mut bodies: Query<(&Eased, &mut Transform)>) {
    let part = time.overstep_fraction();
    for (eased, mut place) in &mut bodies {
        let [from, to] = &eased.poses;
        place.translation = from.translation.lerp(to.translation, part);
        place.rotation = from.rotation.slerp(to.rotation, part);
    }
}

#[test]
fn a_pose_that_is_eased_after_the_fixed_loop_and_restored_before_it_gives_the_same_bits() {
    for fps in RATES {
        for held in HELD {
            let run = |eases: bool| {
                let mut game = game(fps, 60.0);
                let (cloth, body) = spawn_cape(&mut game, held);
                let mover = (Path::when(When::FixedUpdate, swing), Eased::default());
                game.insert(body, mover);
                if eases {
                    game.app
                        .add_systems(FixedFirst, restore)
                        .add_systems(FixedLast, note)
                        .add_systems(
                            RunFixedMainLoop,
                            ease.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
                        );
                }
                game.seconds(3.0);
                let particles: &ClothParticles = game.get(cloth);
                particles.positions().collect::<Vec<Vec3>>()
            };
            assert_eq!(run(false), run(true), "{fps} {held:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Frames of any length, one after the other.
    #[test]
    fn frames_that_vary(lengths in proptest::collection::vec(0.004f64..0.035, 20), hz in prop_oneof![Just(60.0), Just(64.0)]) {
        let size = UVec2::new(4, 8);
        let run = |when: When, lengths: &[f64]| {
            let mut game = game(60.0, hz);
            game.app.insert_resource(ClothWind::default());
            let cloth = game.spawn((
                Cloth::grid(Vec2::new(0.3, 0.8), size),
                ClothMaterial::cotton(),
                ClothSleep::never(),
            ));
            let body = game.spawn((Transform::default(), Path::when(when, swing)));
            game.attach(cloth, body, ClothAttachment::edge(ClothEdge::Top));
            for (k, length) in lengths.iter().cycle().take(400).enumerate() {
                if k == 200 {
                    film(&mut game);
                }
                game.set_frame(std::time::Duration::from_secs_f64(*length));
                game.frames(1);
            }
            film(&mut game)
        };
        let film = run(When::PostUpdate, &lengths);
        let fixed = run(When::FixedUpdate, &lengths);
        let worst = worst(&film, &fixed, size.x as usize);
        prop_assert!(worst < 1.3, "{worst}");
    }
}
