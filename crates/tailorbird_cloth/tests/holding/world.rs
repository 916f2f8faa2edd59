//! An app whose updates are steps, for cloths that are held.

use std::{
    hash::{DefaultHasher, Hash, Hasher},
    time::Duration,
};

use bevy_app::{App, FixedUpdate, TaskPoolOptions, TaskPoolPlugin};
use bevy_ecs::{change_detection::Tick, component::Mutable, prelude::*};
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

/// Steps per second.
pub const HZ: f64 = 60.0;

/// The length of a step [s].
pub const DT: f32 = 1.0 / HZ as f32;

/// Standard gravity [m/s²].
pub const G: f32 = 9.81;

/// An app in a vacuum, where nothing sleeps.
pub struct World {
    pub app: App,
}

/// Gives the place of an entity for each step: moved before the step, in `FixedUpdate`.
#[derive(Component)]
pub struct Path(pub Box<dyn Fn(f32) -> Transform + Send + Sync>);

#[derive(Resource, Default)]
struct Steps(u32);

fn follow(mut steps: ResMut<Steps>, mut movers: Query<(&Path, &mut Transform)>) {
    steps.0 += 1;
    for (path, mut transform) in &mut movers {
        *transform = path.0(steps.0 as f32 * DT);
    }
}

impl World {
    pub fn new() -> Self {
        Self::with_threads(1)
    }

    /// The first app of a process decides on the number of threads.
    pub fn with_threads(threads: usize) -> Self {
        let mut app = App::new();
        let mut pools = TaskPoolOptions::default();
        pools.compute.min_threads = threads;
        pools.compute.max_threads = threads;
        let pools = TaskPoolPlugin {
            task_pool_options: pools,
        };
        app.add_plugins((pools, TimePlugin, ClothPlugin::default()))
            .insert_resource(ClothWind::vacuum())
            .init_resource::<Steps>()
            .add_systems(FixedUpdate, follow)
            .insert_resource(Time::<Fixed>::from_hz(HZ));
        let timestep: Duration = app.world().resource::<Time<Fixed>>().timestep();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(timestep));
        app.finish();
        app.cleanup();
        // No time passes in the first update of an app.
        app.update();
        Self { app }
    }

    pub fn without_gravity(mut self) -> Self {
        self.settings(|s| s.gravity = Vec3::ZERO);
        self
    }

    pub fn settings(&mut self, change: impl FnOnce(&mut ClothSettings)) {
        change(&mut self.app.world_mut().resource_mut::<ClothSettings>());
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    pub fn attach(&mut self, cloth: Entity, to: Entity, attachment: ClothAttachment) -> Entity {
        self.spawn((attachment.to(to), ClothAttachmentOf(cloth)))
    }

    pub fn despawn(&mut self, entity: Entity) {
        self.app.world_mut().despawn(entity);
    }

    pub fn exists(&self, entity: Entity) -> bool {
        self.app.world().get_entity(entity).is_ok()
    }

    pub fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.app.update();
        }
    }

    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app.world().get(entity).unwrap()
    }

    /// When it changed last.
    pub fn changed<C: Component>(&self, entity: Entity) -> Tick {
        let component = self.app.world().entity(entity).get_ref::<C>().unwrap();
        component.last_changed()
    }

    pub fn edit<C: Component<Mutability = Mutable>>(
        &mut self,
        entity: Entity,
        change: impl FnOnce(&mut C),
    ) {
        change(&mut self.app.world_mut().get_mut(entity).unwrap());
    }

    pub fn move_to(&mut self, entity: Entity, to: Transform) {
        self.edit::<Transform>(entity, |at| *at = to);
    }

    pub fn particles(&self, cloth: Entity) -> &ClothParticles {
        self.get(cloth)
    }

    /// Position of a particle in the world.
    pub fn at(&self, cloth: Entity, particle: usize) -> Vec3 {
        let frame: &ClothFrame = self.get(cloth);
        self.particles(cloth).world_position(particle, frame)
    }

    pub fn positions(&self, cloth: Entity) -> Vec<Vec3> {
        let count = self.particles(cloth).len();
        (0..count).map(|i| self.at(cloth, i)).collect()
    }

    /// Velocity of a particle, in world axes.
    pub fn velocity(&self, cloth: Entity, particle: usize) -> Vec3 {
        let frame: &ClothFrame = self.get(cloth);
        frame.vector_to_world(self.particles(cloth).velocity(particle))
    }

    pub fn fastest(&self, cloth: Entity) -> f32 {
        let count = self.particles(cloth).len();
        (0..count)
            .map(|i| self.velocity(cloth, i).length())
            .fold(0.0, f32::max)
    }

    pub fn stretch(&self, cloth: Entity) -> ClothStretch {
        let topology: &ClothTopology = self.get(cloth);
        self.particles(cloth).stretch(topology)
    }

    pub fn mass(&self, cloth: Entity) -> f32 {
        let particles = self.particles(cloth);
        (0..particles.len()).map(|i| particles.mass(i)).sum()
    }

    pub fn errors(&self, entity: Entity) -> Vec<String> {
        let status: &ClothStatus = self.get(entity);
        status.errors().map(ToString::to_string).collect()
    }

    /// A hash over the bits of all positions.
    pub fn hash(&self, cloth: Entity) -> u64 {
        let mut hasher = DefaultHasher::new();
        for p in self.particles(cloth).positions() {
            p.to_array().map(f32::to_bits).hash(&mut hasher);
        }
        hasher.finish()
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
}

#[derive(Resource)]
pub struct Recorded<E: Send + Sync + 'static>(Vec<E>);

impl<E: Send + Sync + 'static> Default for Recorded<E> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

/// Cotton that does not stretch, whose motion does not decay, and that does not sleep.
pub fn rigid() -> (ClothMaterial, ClothSleep) {
    let material = ClothMaterial {
        warp_compliance: 0.0,
        weft_compliance: 0.0,
        damping: 0.0,
        ..ClothMaterial::cotton()
    };
    (material, ClothSleep::never())
}

/// A sheet of 1 m × 1 m in the x-y plane, its middle at the entity's origin.
pub fn square(n: u32) -> impl Bundle {
    (Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered(), rigid())
}

/// A strip of two columns that is 1 m long: a rope.
pub fn rope() -> impl Bundle {
    let cloth =
        Cloth::grid(Vec2::new(0.02, 1.0), UVec2::new(2, 50)).with_origin(Vec2::new(0.5, 0.0));
    (cloth, rigid())
}
