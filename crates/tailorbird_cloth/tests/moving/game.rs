//! A game whose frames are as long as it is told, and whose things move by themselves.

use std::time::Duration;

use bevy_app::{
    App, FixedPostUpdate, FixedUpdate, PostUpdate, TaskPoolOptions, TaskPoolPlugin, Update,
};
use bevy_ecs::{component::Mutable, prelude::*, schedule::ScheduleLabel};
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

/// When something moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    FixedUpdate,
    Update,
    PostUpdate,
}

/// Moves an entity by the clock of its schedule [s].
#[derive(Component, Clone, Copy)]
pub struct Mover(pub When, pub fn(f32) -> Transform);

/// Moves the targets of a cloth from their places at rest.
#[derive(Component, Clone, Copy)]
pub struct TargetMover(pub When, pub fn(f32) -> Transform);

fn go(when: When) -> impl Fn(Res<Time>, Query<(&Mover, &mut Transform)>) {
    move |time, mut movers| {
        for (mover, mut place) in &mut movers {
            if mover.0 == when {
                *place = mover.1(time.elapsed_secs());
            }
        }
    }
}

fn aim(when: When) -> impl Fn(Res<Time>, Query<(&TargetMover, &Cloth, &mut ClothMotionTargets)>) {
    move |time, mut movers| {
        for (mover, cloth, mut targets) in &mut movers {
            if mover.0 == when {
                let place = mover.1(time.elapsed_secs());
                let rest = cloth.rest_positions();
                targets.set_positions(rest.into_iter().map(|p| place.transform_point(p)));
            }
        }
    }
}

/// Positions of all particles of the first cloth after each step, in the world.
#[derive(Resource, Default)]
pub struct Film {
    pub steps: Vec<Vec<Vec3>>,
    pub stretch: Vec<ClothStretch>,
}

fn film(
    mut film: ResMut<Film>,
    cloths: Query<(&ClothParticles, &ClothFrame, &ClothTopology), With<Cloth>>,
) {
    let Some((particles, frame, topology)) = cloths.iter().next() else {
        return;
    };
    let all = (0..particles.len()).map(|i| particles.world_position(i, frame));
    film.steps.push(all.collect());
    film.stretch.push(particles.stretch(topology));
}

pub struct Game {
    pub app: App,
    frame: Duration,
}

impl Game {
    /// Of so many frames and steps a second.
    pub fn new(fps: f64, hz: f64) -> Self {
        Self::with(FixedPostUpdate, fps, hz)
    }

    /// Whose cloths step once a frame.
    pub fn stepping_in(schedule: impl ScheduleLabel + Clone, fps: f64) -> Self {
        Self::with(schedule, fps, fps)
    }

    fn with(schedule: impl ScheduleLabel + Clone, fps: f64, hz: f64) -> Self {
        let mut app = App::new();
        let mut pools = TaskPoolOptions::default();
        pools.compute.min_threads = 1;
        pools.compute.max_threads = 1;
        let pools = TaskPoolPlugin {
            task_pool_options: pools,
        };
        app.add_plugins((pools, TimePlugin, ClothPlugin::new(schedule.clone())))
            .insert_resource(ClothWind::vacuum())
            .init_resource::<Film>()
            .insert_resource(Time::<Fixed>::from_hz(hz))
            .add_systems(FixedUpdate, (go(When::FixedUpdate), aim(When::FixedUpdate)))
            .add_systems(Update, (go(When::Update), aim(When::Update)))
            .add_systems(PostUpdate, (go(When::PostUpdate), aim(When::PostUpdate)))
            .add_systems(schedule, film.after(ClothSystems::Writeback));
        app.finish();
        app.cleanup();
        let frame = Duration::from_secs_f64(1.0 / fps);
        let mut game = Self { app, frame };
        game.set_frame(frame);
        game.frames(1);
        game
    }

    /// Sets the length of frames from now on.
    pub fn set_frame(&mut self, frame: Duration) {
        self.frame = frame;
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    }

    pub fn frames(&mut self, count: u32) {
        for _ in 0..count {
            self.app.update();
        }
    }

    pub fn seconds(&mut self, seconds: f32) {
        self.frames((seconds / self.frame.as_secs_f32()).round() as u32);
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app.world().get(entity).unwrap()
    }

    pub fn edit<C: Component<Mutability = Mutable>>(
        &mut self,
        entity: Entity,
        change: impl FnOnce(&mut C),
    ) {
        change(&mut self.app.world_mut().get_mut(entity).unwrap());
    }

    /// Between two frames.
    pub fn shift(&mut self, entity: Entity, way: Vec3) {
        self.edit::<Transform>(entity, |place| place.translation += way);
    }

    pub fn pause(&mut self, paused: bool) {
        let mut time = self.app.world_mut().resource_mut::<Time<Virtual>>();
        if paused {
            time.pause();
        } else {
            time.unpause();
        }
    }

    pub fn film(&mut self) -> Film {
        std::mem::take(&mut self.app.world_mut().resource_mut::<Film>())
    }

    /// The fastest particle [m/s].
    pub fn fastest(&self, cloth: Entity) -> f32 {
        let particles: &ClothParticles = self.get(cloth);
        let speeds = (0..particles.len()).map(|i| particles.velocity(i).length());
        speeds.fold(0.0, f32::max)
    }

    pub fn at(&self, cloth: Entity, particle: usize) -> Vec3 {
        let particles: &ClothParticles = self.get(cloth);
        particles.world_position(particle, self.get::<ClothFrame>(cloth))
    }

    pub fn attach(&mut self, cloth: Entity, to: Entity, clip: ClothAttachment) {
        self.spawn((clip.to(to), ClothAttachmentOf(cloth)));
    }
}

impl Film {
    /// Mean of the second differences of places in each row of so many particles [m].
    pub fn jolts(&self, columns: usize) -> Vec<f32> {
        let rows = self.steps[0].len() / columns;
        let of_row = |row: usize| {
            let mut sum = 0.0;
            let particles = row * columns..(row + 1) * columns;
            for three in self.steps.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|k| &three[k][particles.clone()]);
                for ((a, b), c) in a.iter().zip(b).zip(c) {
                    sum += (*a - 2.0 * *b + *c).length();
                }
            }
            sum / ((self.steps.len() - 2) * columns) as f32
        };
        (0..rows).map(of_row).collect()
    }

    /// The largest stretch of all [-].
    pub fn stretch(&self) -> f32 {
        self.stretch.iter().map(|s| s.max).fold(0.0, f32::max)
    }

    /// The fastest of the particles, from step to step [m/s].
    pub fn speed(&self, hz: f32) -> f32 {
        let mut fastest = 0.0f32;
        for two in self.steps.windows(2) {
            for (from, to) in two[0].iter().zip(&two[1]) {
                fastest = fastest.max(from.distance(*to) * hz);
            }
        }
        fastest
    }
}

/// Columns and rows of a cape.
pub const SIZE: UVec2 = UVec2::new(16, 24);

/// A cape of 0.8 m × 1.2 m that hangs from its middle.
pub fn cape() -> impl Bundle {
    (
        Cloth::grid(Vec2::new(0.8, 1.2), SIZE).with_origin(Vec2::new(0.5, 0.0)),
        ClothMaterial::cotton(),
        ClothSleep::never(),
    )
}

/// Holder of the cape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Pinned to its entity, which moves.
    Pinned,
    /// Pinned, below an entity that moves.
    Child,
    /// Attached to an entity that moves.
    Attached,
    /// The same, by springs.
    Sprung,
}

pub const HELD: [Held; 4] = [Held::Pinned, Held::Child, Held::Attached, Held::Sprung];

/// A cape, and the entity that moves.
pub fn spawn_cape(game: &mut Game, held: Held) -> (Entity, Entity) {
    let cloth = game.spawn(cape());
    let top = || ClothAttachment::edge(ClothEdge::Top);
    let pins = ClothPins::edges([ClothEdge::Top]);
    match held {
        Held::Pinned => {
            game.app.world_mut().entity_mut(cloth).insert(pins);
            (cloth, cloth)
        }
        Held::Child => {
            let body = game.spawn(Transform::default());
            let mut cloth = game.app.world_mut().entity_mut(cloth);
            cloth.insert((pins, ChildOf(body)));
            (cloth.id(), body)
        }
        Held::Attached | Held::Sprung => {
            let body = game.spawn(Transform::default());
            let clip = if held == Held::Sprung {
                top().with_compliance(1e-4)
            } else {
                top()
            };
            game.attach(cloth, body, clip);
            (cloth, body)
        }
    }
}
