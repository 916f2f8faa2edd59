//! Nothing that the next step depends on is kept anywhere else.

use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, FixedUpdate, TaskPoolPlugin, Update};
use bevy_math::Vec3;
use bevy_time::{Fixed, Real, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::{GlobalTransform, Transform};
use tailorbird_solver::particles::Scratch;

mod scenes;

use super::*;
use crate::prelude::*;
use scenes::scenes;

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
