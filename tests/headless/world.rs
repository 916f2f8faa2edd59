//! An app without a window whose clock is moved by hand.

use std::{
    hash::{DefaultHasher, Hash, Hasher},
    time::Duration,
};

use bevy::{
    ecs::{
        component::Mutable, event::EntityEvent, schedule::ScheduleLabel,
        schedule::SingleThreadedExecutor,
    },
    prelude::*,
    time::TimeUpdateStrategy,
};
use tailorbird::prelude::*;

/// Steps per second.
pub const HZ: f64 = 60.0;

/// The length of a step [s].
pub const DT: f32 = 1.0 / HZ as f32;

/// Earth's gravity [m/s²].
pub const G: f32 = 9.81;

/// An app, and a clock that stands still between calls of [`Sim::step`].
pub struct Sim {
    pub app: App,
    started: bool,
}

impl Sim {
    /// Cloth in still air.
    pub fn new() -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, ClothPlugin::default()));
        app.edit_schedule(FixedPostUpdate, |schedule| {
            // Small scenes are faster on one thread.
            schedule.set_executor(SingleThreadedExecutor::new());
        });
        Self::of(app)
    }

    /// Cloth without air.
    pub fn vacuum() -> Self {
        let mut sim = Self::new();
        sim.app.insert_resource(ClothWind::vacuum());
        sim
    }

    /// An app with plugins of the caller's choice, which bring `Time`.
    ///
    /// The solver is [`ClothSolver::GaussSeidel`] where the environment variable `TAILORBIRD_TEST_SOLVER` is
    /// `gauss-seidel`, so that all tests can be run for both.
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
        app.insert_resource(Time::<Fixed>::from_hz(HZ));
        let mut sim = Self {
            app,
            started: false,
        };
        sim.set_frame(Duration::from_secs_f64(1.0 / HZ));
        sim
    }

    /// The time that one update of the app covers from now on. As long as a step, unless set.
    pub fn set_frame(&mut self, frame: Duration) {
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    }

    pub fn with_settings(mut self, change: impl FnOnce(&mut ClothSettings)) -> Self {
        change(&mut self.settings());
        self
    }

    /// Substeps and iterations.
    pub fn with_passes(self, substeps: u32, iterations: u32) -> Self {
        self.with_settings(|s| (s.substeps, s.iterations) = (Some(substeps), iterations))
    }

    pub fn without_gravity(self) -> Self {
        self.with_settings(|s| s.gravity = Vec3::ZERO)
    }

    pub fn settings(&mut self) -> Mut<'_, ClothSettings> {
        self.app.world_mut().resource_mut()
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    /// Updates the app `n` times: `n` steps, unless [`Sim::set_frame`] says otherwise.
    pub fn step(&mut self, n: usize) {
        if !self.started {
            self.started = true;
            self.app.finish();
            self.app.cleanup();
            // No time passes in the first update of an app.
            self.app.update();
        }
        for _ in 0..n {
            self.app.update();
        }
    }

    pub fn seconds(&mut self, seconds: f64) {
        self.step((seconds * HZ).round() as usize);
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

    pub fn particles(&self, cloth: Entity) -> &ClothParticles {
        self.get(cloth)
    }

    /// Where a particle is in the world.
    pub fn at(&self, cloth: Entity, particle: usize) -> Vec3 {
        self.particles(cloth)
            .world_position(particle, self.get(cloth))
    }

    /// Where all particles are in the world.
    pub fn positions(&self, cloth: Entity) -> Vec<Vec3> {
        (0..self.particles(cloth).len())
            .map(|i| self.at(cloth, i))
            .collect()
    }

    /// The velocities of all particles, in world axes.
    pub fn velocities(&self, cloth: Entity) -> Vec<Vec3> {
        let frame: &ClothFrame = self.get(cloth);
        let particles = self.particles(cloth);
        (0..particles.len())
            .map(|i| frame.vector_to_world(particles.velocity(i)))
            .collect()
    }

    /// The mean of all particles' places in the world, weighted by mass.
    pub fn center_of_mass(&self, cloth: Entity) -> Vec3 {
        self.weighted_mean(cloth, &self.positions(cloth))
    }

    /// The mean of one value per particle, weighted by mass.
    pub fn weighted_mean(&self, cloth: Entity, values: &[Vec3]) -> Vec3 {
        let particles = self.particles(cloth);
        let sum: Vec3 = (0..particles.len())
            .map(|i| values[i] * particles.mass(i))
            .sum();
        sum / self.mass(cloth)
    }

    /// The mass of all particles [kg].
    pub fn mass(&self, cloth: Entity) -> f32 {
        let particles = self.particles(cloth);
        (0..particles.len()).map(|i| particles.mass(i)).sum()
    }

    /// The largest ratio of a stretch spring's length to that at rest.
    pub fn longest_edge(&self, cloth: Entity) -> f32 {
        1.0 + self
            .particles(cloth)
            .stretch(self.get::<ClothTopology>(cloth))
            .max
    }

    pub fn errors(&self, entity: Entity) -> Vec<ClothErrorKind> {
        self.get::<ClothStatus>(entity).errors().cloned().collect()
    }

    pub fn all_finite(&self, cloth: Entity) -> bool {
        let velocities = self.velocities(cloth);
        let mut all = self.positions(cloth).into_iter().chain(velocities);
        all.all(Vec3::is_finite)
    }

    /// A hash over the bits of all particles of one cloth.
    pub fn bits(&self, cloth: Entity) -> u64 {
        bits_of(self.particles(cloth))
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

    pub fn recorded<E: EntityEvent>(&self) -> &[E] {
        &self.app.world().resource::<Recorded<E>>().0
    }

    /// Runs a system at a place of the caller's choice.
    pub fn add_systems<M>(
        &mut self,
        schedule: impl ScheduleLabel,
        systems: impl IntoScheduleConfigs<bevy::ecs::system::ScheduleSystem, M>,
    ) {
        self.app.add_systems(schedule, systems);
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

/// A hash over the bits of all positions.
pub fn bits_of(particles: &ClothParticles) -> u64 {
    let mut hasher = DefaultHasher::new();
    for p in particles.positions() {
        p.to_array().map(f32::to_bits).hash(&mut hasher);
    }
    hasher.finish()
}

/// Cotton whose motion does not decay.
pub fn undamped() -> ClothMaterial {
    ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::cotton()
    }
}

/// A square of `n` × `n` particles and 1 m × 1 m, its middle at the entity's origin, in the x-y plane.
pub fn square(n: u32) -> Cloth {
    Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered()
}

/// Turns the x-y plane into the horizontal one; the front faces up, row 0 is at −z.
pub fn lying() -> Quat {
    Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
}

/// Half the distance between `x` and the next larger number: the most by which rounding to f32 is off.
pub fn rounding(x: f32) -> f32 {
    0.5 * (x.abs().next_up() - x.abs())
}
