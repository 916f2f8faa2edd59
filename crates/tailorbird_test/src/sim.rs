//! The app.

use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, TaskPoolOptions, TaskPoolPlugin};
use bevy_ecs::{change_detection::Tick, component::Mutable, prelude::*, schedule::ScheduleLabel};
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::{measure, path};

/// Steps in a second, unless [`Sim::set_hz`] says otherwise.
pub const HZ: f64 = 60.0;

/// The length of a step \[s\].
pub const DT: f32 = 1.0 / HZ as f32;

/// Standard gravity [m/s²].
pub const G: f32 = 9.81;

/// An app without a window, and a clock that stands still between calls of [`Sim::frames`].
pub struct Sim {
    /// Can be given more plugins before the first step, or before [`Sim::started`].
    pub app: App,
    frame: Duration,
    started: bool,
}

impl Default for Sim {
    fn default() -> Self {
        Self::new()
    }
}

impl Sim {
    /// Cloth in still air, on one thread, on which small scenes are faster.
    pub fn new() -> Self {
        Self::with_threads(Some(1))
    }

    /// The same without air.
    pub fn vacuum() -> Self {
        let mut sim = Self::new();
        sim.app.insert_resource(ClothWind::vacuum());
        sim
    }

    /// The same as [`Sim::new`] on so many threads, as many as there are cores by default. The first app of a process decides.
    pub fn with_threads(threads: Option<usize>) -> Self {
        Self::with(ClothPlugin::default(), threads)
    }

    /// The same as [`Sim::new`], whose cloths step in this schedule.
    pub fn stepping_in(schedule: impl ScheduleLabel) -> Self {
        Self::with(ClothPlugin::new(schedule), Some(1))
    }

    fn with(cloth: ClothPlugin, threads: Option<usize>) -> Self {
        let mut pools = TaskPoolOptions::default();
        if let Some(threads) = threads {
            pools.compute.min_threads = threads;
            pools.compute.max_threads = threads;
        }
        let pools = TaskPoolPlugin {
            task_pool_options: pools,
        };
        let mut app = App::new();
        app.add_plugins((pools, TimePlugin, cloth));
        Self::of(app)
    }

    /// An app with plugins of the caller's choice, which bring `Time`.
    ///
    /// The solver is [`ClothSolver::GaussSeidel`] where the environment variable `TAILORBIRD_TEST_SOLVER` is `gauss-seidel`, so that all
    /// tests can be run for both.
    pub fn of(mut app: App) -> Self {
        if std::env::var("TAILORBIRD_TEST_SOLVER").is_ok_and(|name| name == "gauss-seidel") {
            app.add_observer(
                |added: On<Add<Cloth>>, mut solvers: Query<&mut ClothSolver>| {
                    if let Ok(mut solver) = solvers.get_mut(added.entity) {
                        *solver = ClothSolver::GaussSeidel;
                    }
                },
            );
        }
        path::follow(&mut app);
        let mut sim = Self {
            app,
            frame: Duration::ZERO,
            started: false,
        };
        sim.set_hz(HZ);
        sim
    }

    /// Steps in a second from now on, one in each update.
    pub fn set_hz(&mut self, hz: f64) {
        let fixed = Time::<Fixed>::from_hz(hz);
        let timestep = fixed.timestep();
        self.app.insert_resource(fixed);
        self.set_frame(timestep);
        // Else the clock cuts off steps longer than a quarter of a second.
        let mut clock = self.resource_mut::<Time<Virtual>>();
        let most = clock.max_delta().max(timestep);
        clock.set_max_delta(most);
    }

    /// The time that one update of the app covers from now on. As long as a step, unless set.
    pub fn set_frame(&mut self, frame: Duration) {
        self.frame = frame;
        let strategy = TimeUpdateStrategy::ManualDuration(frame);
        self.app.insert_resource(strategy);
    }

    /// Changes the settings.
    pub fn with_settings(mut self, change: impl FnOnce(&mut ClothSettings)) -> Self {
        change(&mut self.settings());
        self
    }

    /// Sets substeps and iterations.
    pub fn with_passes(self, substeps: u32, iterations: u32) -> Self {
        self.with_settings(|s| (s.substeps, s.iterations) = (Some(substeps), iterations))
    }

    /// Takes gravity away.
    pub fn without_gravity(self) -> Self {
        self.with_settings(|s| s.gravity = Vec3::ZERO)
    }

    /// The settings, to change.
    pub fn settings(&mut self) -> Mut<'_, ClothSettings> {
        self.app.world_mut().resource_mut()
    }

    /// Finishes the app now, and not with the first step: what is spawned from here on is not seen before time passes.
    pub fn started(mut self) -> Self {
        self.start();
        self
    }

    fn start(&mut self) {
        if !self.started {
            self.finish();
            // No time passes in the first update of an app.
            self.app.update();
        }
    }

    /// Builds what is spawned, in a step without time.
    pub(crate) fn build(&mut self) {
        self.finish();
        self.app.world_mut().run_schedule(FixedPostUpdate);
        self.app.update();
    }

    fn finish(&mut self) {
        self.started = true;
        self.app.finish();
        self.app.cleanup();
    }

    /// Updates the app so many times.
    pub fn frames(&mut self, count: u32) {
        self.start();
        for _ in 0..count {
            self.app.update();
        }
    }

    /// The same, where each update is a step: unless [`Sim::set_frame`] says otherwise.
    pub fn steps(&mut self, count: u32) {
        self.frames(count);
    }

    /// Stops the clock of the game, or lets it go on.
    pub fn pause(&mut self, paused: bool) {
        let mut time = self.resource_mut::<Time<Virtual>>();
        if paused {
            time.pause();
        } else {
            time.unpause();
        }
    }

    /// Updates the app so many times as take so long.
    pub fn seconds(&mut self, seconds: f32) {
        self.frames((seconds / self.frame.as_secs_f32()).round() as u32);
    }

    /// Spawns an entity.
    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    /// Attaches a cloth to an entity.
    pub fn attach(&mut self, cloth: Entity, to: Entity, clip: ClothAttachment) -> Entity {
        self.spawn((clip.to(to), ClothAttachmentOf(cloth)))
    }

    /// Adds components to an entity.
    pub fn insert(&mut self, entity: Entity, bundle: impl Bundle) {
        self.app.world_mut().entity_mut(entity).insert(bundle);
    }

    /// Despawns an entity.
    pub fn despawn(&mut self, entity: Entity) {
        self.app.world_mut().despawn(entity);
    }

    /// Returns whether there is such an entity.
    pub fn exists(&self, entity: Entity) -> bool {
        self.app.world().get_entity(entity).is_ok()
    }

    /// A component of an entity.
    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app.world().get(entity).unwrap()
    }

    /// Tick of the last change of a component.
    pub fn changed<C: Component>(&self, entity: Entity) -> Tick {
        let component = self.app.world().entity(entity).get_ref::<C>().unwrap();
        component.last_changed()
    }

    /// Changes a component of an entity.
    pub fn edit<C: Component<Mutability = Mutable>>(
        &mut self,
        entity: Entity,
        change: impl FnOnce(&mut C),
    ) {
        change(&mut self.app.world_mut().get_mut(entity).unwrap());
    }

    /// Puts an entity to a place.
    pub fn move_to(&mut self, entity: Entity, to: Transform) {
        self.edit(entity, |at: &mut Transform| *at = to);
    }

    /// Moves an entity by a displacement.
    pub fn shift(&mut self, entity: Entity, displacement: Vec3) {
        self.edit(entity, |at: &mut Transform| at.translation += displacement);
    }

    /// A resource.
    pub fn resource<R: Resource>(&self) -> &R {
        self.app.world().resource()
    }

    /// A resource, to change.
    pub fn resource_mut<R: Resource<Mutability = Mutable>>(&mut self) -> Mut<'_, R> {
        self.app.world_mut().resource_mut()
    }

    /// The particles of a cloth.
    pub fn particles(&self, cloth: Entity) -> &ClothParticles {
        self.get(cloth)
    }

    /// Place of a particle in the world.
    pub fn at(&self, cloth: Entity, particle: usize) -> Vec3 {
        let frame: &ClothFrame = self.get(cloth);
        self.particles(cloth).world_position(particle, frame)
    }

    /// Places of all particles in the world.
    pub fn positions(&self, cloth: Entity) -> Vec<Vec3> {
        let count = self.particles(cloth).len();
        (0..count).map(|i| self.at(cloth, i)).collect()
    }

    /// The velocity of a particle, in world axes [m/s].
    pub fn velocity(&self, cloth: Entity, particle: usize) -> Vec3 {
        let frame: &ClothFrame = self.get(cloth);
        frame.vector_to_world(self.particles(cloth).velocity(particle))
    }

    /// The velocities of all particles, in world axes [m/s].
    pub fn velocities(&self, cloth: Entity) -> Vec<Vec3> {
        let count = self.particles(cloth).len();
        (0..count).map(|i| self.velocity(cloth, i)).collect()
    }

    /// The speed of the fastest particle [m/s].
    pub fn fastest(&self, cloth: Entity) -> f32 {
        let speeds = self.velocities(cloth).into_iter().map(Vec3::length);
        speeds.fold(0.0, f32::max)
    }

    /// Returns whether places and velocities of all particles are finite.
    pub fn all_finite(&self, cloth: Entity) -> bool {
        let velocities = self.velocities(cloth);
        let mut all = self.positions(cloth).into_iter().chain(velocities);
        all.all(Vec3::is_finite)
    }

    /// Stretch of all edges.
    pub fn stretch(&self, cloth: Entity) -> ClothStretch {
        let topology: &ClothTopology = self.get(cloth);
        self.particles(cloth).stretch(topology)
    }

    /// The mass of all particles, pinned ones as well \[kg\].
    pub fn mass(&self, cloth: Entity) -> f32 {
        let particles = self.particles(cloth);
        (0..particles.len()).map(|i| particles.mass(i)).sum()
    }

    /// The mean of one value per particle, weighted by mass.
    pub fn weighted_mean(&self, cloth: Entity, values: &[Vec3]) -> Vec3 {
        let particles = self.particles(cloth);
        let values = values.iter().enumerate();
        let sum: Vec3 = values.map(|(i, value)| *value * particles.mass(i)).sum();
        sum / self.mass(cloth)
    }

    /// The mean of all particles' places in the world, weighted by mass.
    pub fn center_of_mass(&self, cloth: Entity) -> Vec3 {
        self.weighted_mean(cloth, &self.positions(cloth))
    }

    /// Errors of an entity.
    pub fn errors(&self, entity: Entity) -> Vec<ClothErrorKind> {
        self.get::<ClothStatus>(entity).errors().cloned().collect()
    }

    /// The same in words.
    pub fn complaints(&self, entity: Entity) -> Vec<String> {
        let errors = self.errors(entity);
        errors.iter().map(ToString::to_string).collect()
    }

    /// A hash over the bits of all particles of one cloth.
    pub fn hash(&self, cloth: Entity) -> u64 {
        measure::hash([self.particles(cloth)])
    }

    /// Collects the events of one kind that are triggered from now on.
    pub fn record<E: EntityEvent + Clone>(&mut self)
    where
        for<'a> E::Trigger<'a>: Send + Sync,
    {
        self.app.init_resource::<Recorded<E>>();
        self.app
            .add_observer(|event: On<E>, mut list: ResMut<Recorded<E>>| {
                list.0.push(event.event().clone());
            });
    }

    /// The events that were collected.
    pub fn recorded<E: EntityEvent>(&self) -> &[E] {
        &self.resource::<Recorded<E>>().0
    }
}

/// Events in the order in which they were triggered.
#[derive(Resource)]
pub struct Recorded<E: Send + Sync + 'static>(pub Vec<E>);

impl<E: Send + Sync + 'static> Default for Recorded<E> {
    fn default() -> Self {
        Self(Vec::new())
    }
}
