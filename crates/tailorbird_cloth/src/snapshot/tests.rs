//! Nothing that the next step depends on is kept anywhere else.

use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, FixedUpdate, TaskPoolPlugin, Update};
use bevy_math::Vec3;
use bevy_math::{UVec2, Vec2};
use bevy_time::{Fixed, Real, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::{GlobalTransform, Transform};
use tailorbird_solver::particles::Scratch;

use super::*;
use crate::prelude::*;

/// An app in which each update is a step.
fn app(scene: &dyn Fn(&mut World)) -> App {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        ClothPlugin::default(),
    ));
    let fixed = Time::<Fixed>::from_hz(60.0);
    let step = fixed.timestep();
    app.insert_resource(fixed)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.update();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step))
        .init_resource::<Played>()
        .add_systems(Update, play_between_steps)
        .add_systems(FixedUpdate, (play, go, turn, sink).chain());
    scene(app.world_mut());
    app
}

/// Number of steps of the game that have begun.
#[derive(Resource, Clone, Default)]
struct Played(u32);

/// Actions of the game in a step.
#[derive(Component, Clone, Copy)]
struct Plays(fn(u32, EntityWorldMut));

/// Moves the targets of motion constraints along in each frame, where [`Plays`] would in each step.
#[derive(Component, Clone, Copy)]
struct PlaysBetweenSteps(fn(u32, EntityWorldMut));

fn play_between_steps(world: &mut World) {
    let step = world.resource::<Played>().0;
    let mut players = world.query::<(Entity, &PlaysBetweenSteps)>();
    let players: Vec<_> = players.iter(world).map(|(e, plays)| (e, *plays)).collect();
    for (entity, plays) in players {
        plays.0(step, world.entity_mut(entity));
    }
}

/// Puts the targets of a square on a wave.
fn wave(step: u32, mut cloth: EntityWorldMut) {
    let places = (0..576).map(|k| {
        let (x, y) = (k % 24, k / 24);
        let place = Vec3::new(x as f32, -(y as f32), 0.0) * (2.0 / 23.0);
        place + Vec3::Z * (0.1 * (0.1 * (step + k) as f32).sin())
    });
    let places: Vec<Vec3> = places.collect();
    if let Some(mut targets) = cloth.get_mut::<ClothMotionTargets>() {
        targets.set_positions(places);
    }
}

fn play(world: &mut World) {
    let mut played = world.resource_mut::<Played>();
    played.0 += 1;
    let step = played.0;
    let mut players = world.query::<(Entity, &Plays)>();
    let players: Vec<_> = players.iter(world).map(|(e, plays)| (e, *plays)).collect();
    for (entity, plays) in players {
        plays.0(step, world.entity_mut(entity));
    }
}

/// Moves at this velocity [m/s].
#[derive(Component)]
struct Moves(Vec3);

fn go(time: Res<Time>, mut movers: Query<(&Moves, &mut Transform)>) {
    for (moves, mut place) in &mut movers {
        place.translation += time.delta_secs() * moves.0;
    }
}

/// Turns about y at this rate [rad/s].
#[derive(Component)]
struct Turns(f32);

fn turn(time: Res<Time>, mut movers: Query<(&Turns, &mut Transform)>) {
    for (turns, mut place) in &mut movers {
        place.rotate_y(time.delta_secs() * turns.0);
    }
}

/// A body that is pushed down into what lies below.
#[derive(Resource, Clone)]
struct Sinks(f32, Entity);

fn sink(sinks: Option<ResMut<Sinks>>, mut colliders: ResMut<ClothExternalColliders>) {
    let Some(mut sinks) = sinks else {
        return;
    };
    let at = |height| bevy_math::Isometry3d::from_translation(Vec3::new(0.05, height, -0.02));
    let (start, end) = (at(sinks.0), at(sinks.0 - 0.002));
    sinks.0 -= 0.002;
    colliders.push(ClothExternalCollider {
        entity: sinks.1,
        part: 0,
        shape: ClothColliderShape::Sphere { radius: 0.3 },
        friction: 0.5,
        margin: 0.0,
        layers: ClothLayers::ALL,
        start,
        end,
        body: Some(ClothColliderBody {
            body: sinks.1,
            inv_mass: Vec3::splat(0.5),
            inv_inertia: bevy_math::Mat3::from_diagonal(Vec3::splat(14.0)),
            center_of_mass: Vec3::from(end.translation),
            linear_velocity: Vec3::NEG_Y * 0.12,
            angular_velocity: Vec3::ZERO,
        }),
    });
}

fn spoil(mut cloths: Query<&mut ClothParticles>) {
    for mut particles in &mut cloths {
        particles.bypass_change_detection().0.scratch = Scratch::default();
    }
}

/// The bits of all cloths after each of some steps, and which of them sleep.
fn bits(app: &mut App, steps: usize) -> Vec<(Vec<bool>, Vec<u32>)> {
    let mut step = || {
        app.update();
        let mut cloths = app
            .world_mut()
            .query::<(&ClothParticles, &ClothSleepState)>();
        let cloths = cloths.iter(app.world());
        let points = cloths
            .clone()
            .flat_map(|(particles, _)| particles.positions());
        let points = points
            .flat_map(|p| p.to_array())
            .map(f32::to_bits)
            .collect();
        (cloths.map(|(_, rest)| rest.is_asleep()).collect(), points)
    };
    (0..steps).map(|_| step()).collect()
}

/// State that the game itself puts back: its own writes, and the time.
struct Game {
    places: Vec<(Entity, Transform, GlobalTransform)>,
    targets: Vec<(Entity, ClothMotionTargets)>,
    times: (Time, Time<Virtual>, Time<Fixed>, Time<Real>),
    played: Played,
    sinks: Option<Sinks>,
    settings: ClothSettings,
    wind: ClothWind,
}

impl Game {
    fn take(world: &mut World) -> Self {
        let mut places = world.query::<(Entity, &Transform, &GlobalTransform)>();
        let places = places
            .iter(world)
            .map(|(e, place, global)| (e, *place, *global));
        let places = places.collect();
        let mut targets = world.query::<(Entity, &ClothMotionTargets)>();
        let targets = targets.iter(world).map(|(e, targets)| (e, targets.clone()));
        Self {
            places,
            targets: targets.collect(),
            times: (
                *world.resource(),
                *world.resource(),
                *world.resource(),
                *world.resource(),
            ),
            played: world.resource::<Played>().clone(),
            sinks: world.get_resource::<Sinks>().cloned(),
            settings: world.resource::<ClothSettings>().clone(),
            wind: world.resource::<ClothWind>().clone(),
        }
    }

    fn restore(&self, world: &mut World) {
        for (entity, place, global) in &self.places {
            world.entity_mut(*entity).insert((*place, *global));
        }
        for (entity, targets) in &self.targets {
            world.entity_mut(*entity).insert(targets.clone());
        }
        let (time, of_game, fixed, real) = self.times;
        world.insert_resource(time);
        world.insert_resource(of_game);
        world.insert_resource(fixed);
        world.insert_resource(real);
        world.insert_resource(self.played.clone());
        if let Some(sinks) = &self.sinks {
            world.insert_resource(sinks.clone());
        }
        world.insert_resource(self.settings.clone());
        world.insert_resource(self.wind.clone());
        // As rollback writes what is the same.
        rewrite::<Cloth>(world);
        rewrite::<ClothPins>(world);
        rewrite::<ClothMaterial>(world);
        rewrite::<ClothSolver>(world);
        rewrite::<ClothShading>(world);
        rewrite::<ClothSleep>(world);
        rewrite::<ClothInertia>(world);
        rewrite::<ClothAttachment>(world);
        rewrite::<ClothMotionConstraints>(world);
        rewrite::<ClothCollider>(world);
    }
}

fn rewrite<C: Component<Mutability = Mutable>>(world: &mut World) {
    let mut values = world.query::<&mut C>();
    values
        .iter_mut(world)
        .for_each(|mut value| value.set_changed());
}

fn scenes() -> [(&'static str, fn(&mut World)); 15] {
    fn square() -> (Cloth, ClothMaterial) {
        let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(24)).centered();
        (cloth, ClothMaterial::cotton())
    }
    fn lying() -> Transform {
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(bevy_math::Quat::from_rotation_x(-1.57))
    }
    [
        ("wind", |world| {
            world.insert_resource(ClothWind {
                velocity: Vec3::new(6.0, 0.0, 2.0),
                turbulence: ClothTurbulence {
                    speed: 2.0,
                    ..ClothTurbulence::default()
                },
                ..ClothWind::default()
            });
            world.spawn((square(), ClothPins::edges([ClothEdge::Left])));
            world.spawn((square(), ClothSolver::GaussSeidel));
        }),
        ("falls on shapes", |world| {
            world.spawn((square(), lying()));
            world.spawn(ClothCollider::half_space());
            world.spawn((
                ClothCollider::sphere(0.3),
                Transform::from_xyz(0.3, 0.6, 0.1),
            ));
            world.spawn((
                ClothCollider::cuboid(0.3, 0.4, 0.5),
                Transform::from_xyz(-0.5, 0.5, 0.2),
            ));
        }),
        ("falls on an open mesh", |world| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let positions = corners.map(|(x, z)| Vec3::new(x, 0.3 + 0.1 * x, z));
            let mesh = ClothCollider::trimesh(positions, [[0, 2, 1], [0, 3, 2]]);
            world.spawn(mesh.expect("triangles"));
            world.spawn((square(), lying()));
        }),
        ("more than it has", |world| {
            let pins = ClothPins::edges([ClothEdge::Top]);
            world.spawn((square(), pins, Transform::default()));
            world.spawn((
                ClothCollider::sphere(0.3),
                Transform::from_xyz(0.1, 0.0, 0.05),
            ));
        }),
        ("a shot", |world| {
            world.spawn((
                square(),
                ClothPins::edges([
                    ClothEdge::Top,
                    ClothEdge::Bottom,
                    ClothEdge::Left,
                    ClothEdge::Right,
                ]),
            ));
            world.spawn((
                ClothCollider::sphere(0.3),
                Moves(Vec3::new(0.1, 0.0, -1.0)),
                Transform::from_xyz(0.0, 0.0, 0.5),
            ));
        }),
        ("a body", |world| {
            let edges = [ClothEdge::Left, ClothEdge::Right];
            world.spawn((square(), lying(), ClothPins::edges(edges)));
            let body = world.spawn_empty().id();
            world.insert_resource(Sinks(1.35, body));
        }),
        ("limits", |world| {
            world.spawn((square(), lying(), ClothMotionConstraints::at_most(0.2)));
        }),
        ("held by what turns, and by springs", |world| {
            let pole = world
                .spawn((Transform::from_xyz(0.0, 2.0, 0.0), Turns(2.0)))
                .id();
            let at = Transform::from_xyz(0.0, 2.0, 0.0);
            let cloth = world.spawn((square(), at)).id();
            let [rigid, soft] =
                [ClothCorner::TopLeft, ClothCorner::TopRight].map(ClothSelection::Corner);
            for (selection, compliance) in [(rigid, 0.0), (soft, 0.01)] {
                let attachment = ClothAttachment {
                    selections: vec![selection],
                    compliance,
                    ..ClothAttachment::default()
                };
                world.spawn((attachment, ClothAttachmentOf(cloth), ClothAttachedTo(pole)));
            }
        }),
        ("sleeps, and is woken", |world| {
            let pins = ClothPins::edges([ClothEdge::Top]);
            world.spawn((
                square(),
                pins,
                ClothSleep {
                    speed: 10.0,
                    ..ClothSleep::default()
                },
            ));
            world.spawn((
                ClothCollider::sphere(0.1),
                Moves(Vec3::new(0.0, 0.0, -0.5)),
                Transform::from_xyz(0.0, 0.0, 1.2),
            ));
        }),
        ("sleeps at what holds it", |world| {
            let pole = world.spawn(Transform::default()).id();
            let still = ClothSleep {
                speed: 10.0,
                ..ClothSleep::default()
            };
            let cloth = world.spawn((square(), still, Transform::default())).id();
            let top = ClothSelection::Edge(ClothEdge::Top);
            let attachment = ClothAttachment {
                selections: vec![top],
                ..ClothAttachment::default()
            };
            world.spawn((attachment, ClothAttachmentOf(cloth), ClothAttachedTo(pole)));
            let limited = (square(), still, ClothMotionConstraints::at_most(0.0));
            world.spawn((limited, Transform::from_xyz(5.0, 0.0, 0.0)));
        }),
        ("in a hand", |world| {
            let pins = ClothPins::corners([ClothCorner::TopLeft]);
            world.spawn((
                square(),
                pins,
                Transform::default(),
                Plays(|step, mut cloth| {
                    let Some(mut grab) = cloth.get_mut::<ClothGrab>() else {
                        return;
                    };
                    match step {
                        40 => grab.take(300, 0.3, Vec3::new(0.3, 0.2, 0.4)),
                        41..110 => grab.move_to(Vec3::new(0.3 + 0.01 * step as f32, 0.2, 0.4)),
                        110 => grab.release(),
                        _ => {}
                    }
                }),
            ));
        }),
        ("pushed, reset, paused, written wrongly", |world| {
            world.spawn((
                square(),
                ClothPins::edges([ClothEdge::Left]),
                Plays(|step, mut cloth| {
                    if step < 30
                        && let Some(mut forces) = cloth.get_mut::<ClothForces>()
                    {
                        forces.add_force(300, Vec3::new(0.0, 0.1, 0.02 * step as f32));
                    }
                    cloth.world_scope(|world| {
                        let mut settings = world.resource_mut::<ClothSettings>();
                        match step {
                            50 => settings.gravity = Vec3::NAN,
                            60 => settings.paused = true,
                            70 => settings.paused = false,
                            120 => settings.gravity = Vec3::NEG_Y,
                            _ => {}
                        }
                    });
                }),
            ));
        }),
        ("targets that a step moves", |world| {
            let cloth = (square(), ClothMotionConstraints::at_most(0.05));
            world.spawn((cloth, ClothMotionTargets::default(), Plays(wave)));
        }),
        ("targets that a frame moves", |world| {
            let cloth = (square(), ClothMotionConstraints::at_most(0.05));
            world.spawn((
                cloth,
                ClothMotionTargets::default(),
                PlaysBetweenSteps(wave),
            ));
        }),
        ("a mesh of any triangles in a zone, seen no more", |world| {
            let points: Vec<Vec3> = (0..200)
                .map(|k| {
                    let (x, y) = (k % 20, k / 20);
                    let shift = 0.3 * ((k * 7919) % 13) as f32 / 13.0;
                    Vec3::new(0.1 * (x as f32 + shift), -0.1 * (y as f32 + shift), 0.0)
                })
                .collect();
            let cells = (0..19u32).flat_map(|x| (0..9u32).map(move |y| 20 * y + x));
            let corners = cells.flat_map(|k| [k, k + 20, k + 1, k + 1, k + 20, k + 21]);
            let near = ClothSelection::Within {
                center: Vec3::ZERO,
                radius: 0.25,
            };
            let pins = ClothPins {
                pins: vec![ClothPin::new(near)],
            };
            let cloth = Cloth::mesh(points, corners.collect::<Vec<_>>());
            let sleep = ClothSleep {
                unseen: true,
                ..ClothSleep::default()
            };
            world.spawn((
                cloth,
                pins,
                sleep,
                Moves(Vec3::X),
                Transform::default(),
                Plays(|step, mut cloth| {
                    cloth.insert(ClothSeen(!(80..130).contains(&step)));
                }),
            ));
            let zone = ClothWindZone::cuboid(Vec3::splat(6.0), Vec3::new(1.0, 0.0, 4.0));
            world.spawn((zone, Transform::from_xyz(1.0, 0.0, 0.0)));
        }),
    ]
}

/// Scratch of a step has no say in the next one.
#[test]
fn scratch_can_be_dropped_before_each_step() {
    for (name, scene) in scenes() {
        let [kept, dropped] = [false, true].map(|spoils| {
            let mut app = app(&scene);
            if spoils {
                app.add_systems(FixedPostUpdate, spoil.before(ClothSystems::Prepare));
            }
            bits(&mut app, 150)
        });
        let differs = kept.iter().zip(&dropped).position(|(a, b)| a != b);
        assert_eq!(differs, None, "{name}: first step that differs");
    }
}

/// In the same world after having gone on, and in another one that was at another step.
#[test]
fn a_snapshot_holds_all_that_the_next_step_depends_on() {
    for (name, scene) in scenes() {
        for at in [1, 45, 100] {
            let mut first = app(&scene);
            bits(&mut first, at);
            let world = first.world_mut();
            let (game, cloths) = (Game::take(world), ClothSnapshot::take(world));
            let expected = bits(&mut first, 60);
            let mut second = app(&scene);
            bits(&mut second, 20);
            for (which, app) in [("the same", &mut first), ("another", &mut second)] {
                game.restore(app.world_mut());
                cloths.restore(app.world_mut());
                let found = bits(app, 60);
                let differs = expected.iter().zip(&found).position(|(a, b)| a != b);
                assert_eq!(
                    differs, None,
                    "{name}, {which} world, taken after {at} steps: first that differs"
                );
            }
        }
    }
}
