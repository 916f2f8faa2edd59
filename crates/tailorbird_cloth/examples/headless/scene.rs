//! An app with one sheet.

use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, TaskPoolOptions, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use super::{
    cli::{Args, Mesh, Pins, Solver},
    mesh,
    peaks::{Peaks, Seen},
    play::{self, Play},
};

/// Displacement of particles by a seed [m].
const NUDGE: f32 = 1e-4;

/// An app with one sheet.
pub struct Sheet {
    /// The app. Each update is one step.
    pub app: App,
    /// The sheet.
    pub entity: Entity,
    /// Largest values in the steps so far.
    pub peaks: Peaks,
    play: Play,
    step: u32,
    hz: f64,
}

impl Sheet {
    /// The sheet at its start: built, and no time has passed.
    pub fn new(args: &Args) -> Self {
        let mut app = App::new();
        let mut pools = TaskPoolOptions::default();
        if let Some(threads) = args.threads {
            pools.compute.min_threads = threads as usize;
            pools.compute.max_threads = threads as usize;
        }
        app.add_plugins((
            TaskPoolPlugin {
                task_pool_options: pools,
            },
            TimePlugin,
            ClothPlugin::default(),
        ));

        // Updates as long as a step, so that there is one step in each.
        let fixed = Time::<Fixed>::from_hz(args.hz);
        let timestep = fixed.timestep();
        app.insert_resource(fixed)
            .insert_resource(TimeUpdateStrategy::ManualDuration(timestep));
        let mut clock = app.world_mut().resource_mut::<Time<Virtual>>();
        // Else the clock cuts off steps longer than a quarter of a second.
        let most = clock.max_delta().max(timestep);
        clock.set_max_delta(most);

        app.insert_resource(ClothSettings {
            gravity: Vec3::NEG_Y * args.gravity,
            substeps: args.substeps,
            iterations: args.iterations,
            instruction_set: args.isa.into(),
            ..Default::default()
        })
        .insert_resource(match args.wind() {
            Vec3::ZERO => ClothWind::vacuum(),
            velocity => ClothWind::steady(velocity),
        });
        if let Some(sphere) = args.sphere() {
            app.world_mut().spawn((
                ClothCollider::sphere(sphere.radius),
                Transform::from_translation(sphere.center),
            ));
        }
        let entity = spawn_sheet(app.world_mut(), args);
        let play = Play::new(app.world_mut(), args, entity);
        app.finish();
        app.cleanup();

        // The clock stands still: this builds the sheet and does not move it, nor does the first update.
        app.world_mut().run_schedule(FixedPostUpdate);
        app.update();
        let mut sheet = Self {
            app,
            entity,
            peaks: Peaks::default(),
            play,
            step: 0,
            hz: args.hz,
        };
        sheet.peaks = Peaks::at_start(sheet.seen());
        if args.seed != 0 {
            sheet.nudge(args, timestep);
        }
        sheet
    }

    /// Simulates a step; how long it took.
    pub fn step(&mut self) -> Duration {
        self.step += 1;
        let time = (f64::from(self.step) / self.hz) as f32;
        self.play.interrupt(&mut self.app, time);
        self.play.act(self.app.world_mut(), self.entity, time);
        self.app.update();
        self.peaks.add(self.seen());
        self.app.world().resource::<ClothStepTime>().total
    }

    /// Values after a step.
    fn seen(&self) -> Seen {
        let gravity = self.app.world().resource::<ClothSettings>().gravity;
        let gravity = self.get::<ClothFrame>().vector_to_frame(gravity);
        let particles = self.get::<ClothParticles>();
        Peaks::of_step(particles, self.get(), gravity, self.hz as f32)
    }

    /// A component of the sheet.
    ///
    /// # Panics
    /// When the sheet does not have it; [`Cloth`] brings all that are asked for.
    pub fn get<C: Component>(&self) -> &C {
        self.app.world().entity(self.entity).components::<&C>()
    }

    /// Particles in a row.
    pub fn columns(&self) -> usize {
        let resolution = self.get::<Cloth>().resolution();
        resolution.map_or(1, |resolution| resolution.x as usize)
    }

    /// Positions of the particles in the world [m].
    pub fn world_positions(&self) -> impl Iterator<Item = Vec3> + '_ {
        let frame = self.get::<ClothFrame>();
        let particles = self.get::<ClothParticles>();
        particles.positions().map(|p| frame.to_world(p))
    }

    /// Errors that the simulation finds in the sheet.
    pub fn errors(&self) -> Vec<String> {
        let status = self.get::<ClothStatus>();
        status.errors().map(ToString::to_string).collect()
    }

    /// Pushes each particle up or down during the first step, by up to [`NUDGE`], without moving the sheet as a whole.
    fn nudge(&mut self, args: &Args, timestep: Duration) {
        let particles = self.get::<ClothParticles>();
        let free = |i: &usize| !particles.is_pinned(*i);
        let random = |i: usize| tailorbird_test::unit(args.seed ^ (i as u64).rotate_left(32));
        let (mass, moment) = (0..particles.len())
            .filter(free)
            .map(|i| (particles.mass(i), particles.mass(i) * random(i)))
            .fold((0.0, 0.0), |sum, of| (sum.0 + of.0, sum.1 + of.1));
        let mean = moment / mass;
        // An acceleration a moves by a h² (1 + 2 + … + n) in n substeps of length h.
        let n = self.app.world().resource::<ClothStep>().substeps() as f32;
        let h = timestep.as_secs_f32() / n;
        let acceleration = NUDGE / (h * h * n * (n + 1.0) / 2.0);
        let pushes: Vec<_> = (0..particles.len())
            .filter(free)
            .map(|i| (i as u32, Vec3::Y * ((random(i) - mean) * acceleration)))
            .collect();
        if let Some(mut forces) = self.app.world_mut().get_mut::<ClothForces>(self.entity) {
            for (particle, push) in pushes {
                forces.add_acceleration(particle, push);
            }
        }
    }
}

/// The sheet, held as asked for.
fn spawn_sheet(world: &mut World, args: &Args) -> Entity {
    let (cloth, size) = (play::cloth(args), args.scene.size());
    let reach = 0.5 * size - mesh::NEAR;
    let pins = match (args.pins(), args.mesh) {
        (Pins::Corners, Mesh::Grid) => ClothPins::corners(ClothCorner::TOP),
        (Pins::Edge, Mesh::Grid) => ClothPins::edges([ClothEdge::Top]),
        (Pins::Corners, _) => {
            let corner = (0.5 * size).extend(0.0);
            let [left, right] = [corner * Vec3::new(-1.0, 1.0, 1.0), corner];
            let within = |center| ClothSelection::Within {
                center,
                radius: mesh::NEAR,
            };
            ClothPins::default()
                .with(ClothPin::new(within(left)))
                .with(ClothPin::new(within(right)))
        }
        (Pins::Edge, _) => ClothPins::matching(&cloth, |p| p.y > reach.y),
        (Pins::Border, _) => {
            ClothPins::matching(&cloth, |p| p.x.abs() > reach.x || p.y.abs() > reach.y)
        }
        (Pins::None, _) => ClothPins::default(),
    };
    let solver = match args.solver {
        Solver::GaussSeidel => ClothSolver::GaussSeidel,
        Solver::Chains => ClothSolver::Chains,
    };
    world
        .spawn((
            cloth,
            args.material(),
            solver,
            pins,
            ClothSleep::never(),
            Transform::from_isometry(play::place(args.scene)),
        ))
        .id()
}
