//! An app with one sheet (or several), made for tests. The sheet's frame is the world's: columns along +x, rows along −y.

use std::time::Duration;

use bevy_app::{App, TaskPoolOptions, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

/// Standard gravity [m/s²].
pub const G: f32 = 9.81;

/// Scene to simulate.
#[derive(Clone, Debug)]
pub struct Scene {
    pub size: Vec2,
    pub resolution: UVec2,
    /// In place of the grid of this size and resolution.
    pub cloth: Option<Cloth>,
    pub material: ClothMaterial,
    pub pins: ClothPins,
    pub gravity: Vec3,
    pub wind: ClothWind,
    pub substeps: Option<u32>,
    pub instruction_set: ClothInstructionSet,
    pub hz: f64,
    /// Middle and radius.
    pub sphere: Option<(Vec3, f32)>,
    /// Of the pool; a process has one, that of the first scene.
    pub threads: Option<usize>,
    /// Number of sheets, 3 m apart along x.
    pub sheets: u32,
    pub sleep: ClothSleep,
}

impl Default for Scene {
    /// A sheet of 2 m × 2 m that lies horizontal, as gravity is along −z, in a vacuum, free.
    fn default() -> Self {
        Self {
            size: Vec2::splat(2.0),
            resolution: UVec2::splat(32),
            cloth: None,
            material: rigid(),
            pins: ClothPins::default(),
            gravity: Vec3::NEG_Z * G,
            wind: ClothWind::vacuum(),
            substeps: None,
            instruction_set: ClothInstructionSet::Auto,
            hz: 60.0,
            sphere: None,
            threads: None,
            sheets: 1,
            sleep: ClothSleep::never(),
        }
    }
}

impl Scene {
    /// Hangs by two corners.
    pub fn hang(resolution: UVec2) -> Self {
        Self {
            resolution,
            pins: ClothPins::corners(ClothCorner::TOP),
            ..Self::default()
        }
    }

    /// Falls on a sphere.
    pub fn drape(resolution: UVec2) -> Self {
        Self {
            resolution,
            sphere: Some((Vec3::new(0.0, 0.0, -0.55), 0.5)),
            ..Self::default()
        }
    }
}

/// Cotton that does not stretch.
pub fn rigid() -> ClothMaterial {
    ClothMaterial {
        warp_compliance: 0.0,
        weft_compliance: 0.0,
        ..ClothMaterial::cotton()
    }
}

/// An app whose updates are steps.
pub struct Sheet {
    pub app: App,
    /// The first sheet.
    pub entity: Entity,
    /// The sphere.
    pub sphere: Option<Entity>,
}

impl Sheet {
    /// Built, and no time has passed.
    pub fn new(scene: &Scene) -> Self {
        let mut app = App::new();
        let mut pools = TaskPoolOptions::default();
        if let Some(threads) = scene.threads {
            pools.compute.min_threads = threads;
            pools.compute.max_threads = threads;
        }
        app.add_plugins((
            TaskPoolPlugin {
                task_pool_options: pools,
            },
            TimePlugin,
            ClothPlugin::default(),
        ));
        app.insert_resource(ClothSettings {
            gravity: scene.gravity,
            substeps: scene.substeps,
            instruction_set: scene.instruction_set,
            ..Default::default()
        })
        .insert_resource(scene.wind.clone());
        let sphere = scene.sphere.map(|(center, radius)| {
            let at = Transform::from_translation(center);
            app.world_mut()
                .spawn((ClothCollider::sphere(radius), at))
                .id()
        });
        let sheets: Vec<Entity> = (0..scene.sheets)
            .map(|k| {
                let grid = || Cloth::grid(scene.size, scene.resolution).centered();
                let cloth = scene.cloth.clone().unwrap_or_else(grid);
                let at = Transform::from_xyz(3.0 * k as f32, 0.0, 0.0);
                let bundle = (cloth, scene.material, scene.pins.clone(), scene.sleep, at);
                app.world_mut().spawn(bundle).id()
            })
            .collect();
        let mut sheet = Self {
            app,
            entity: sheets[0],
            sphere,
        };
        sheet.set_hz(scene.hz);
        sheet.app.finish();
        sheet.app.cleanup();
        // The clock stands still.
        sheet
            .app
            .world_mut()
            .run_schedule(bevy_app::FixedPostUpdate);
        sheet.app.update();
        sheet
    }

    /// Steps in a second from now on.
    pub fn set_hz(&mut self, hz: f64) {
        let fixed = Time::<Fixed>::from_hz(hz);
        let timestep: Duration = fixed.timestep();
        self.app
            .insert_resource(fixed)
            .insert_resource(TimeUpdateStrategy::ManualDuration(timestep));
        let mut clock = self.app.world_mut().resource_mut::<Time<Virtual>>();
        let most = clock.max_delta().max(timestep);
        clock.set_max_delta(most);
    }

    pub fn step(&mut self) {
        self.app.update();
    }

    pub fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.step();
        }
    }

    /// A component of the first sheet.
    pub fn get<T: Component>(&self) -> &T {
        self.app.world().get(self.entity).unwrap()
    }

    /// A component of the first sheet, to change.
    pub fn change<T: Component<Mutability = bevy_ecs::component::Mutable>>(
        &mut self,
        change: impl FnOnce(&mut T),
    ) {
        change(&mut self.app.world_mut().get_mut::<T>(self.entity).unwrap());
    }

    pub fn settings(&mut self, change: impl FnOnce(&mut ClothSettings)) {
        change(&mut self.app.world_mut().resource_mut::<ClothSettings>());
    }

    pub fn particles(&self) -> &ClothParticles {
        self.get()
    }

    pub fn substep_seconds(&self) -> f32 {
        self.app.world().resource::<ClothStep>().substep_seconds()
    }

    /// Displacement of particles in the last step of 1/60 s, by its length, root of the mean square [m/s].
    pub fn speed(&self) -> f64 {
        let particles = self.particles();
        let (to, from) = (particles.points(), particles.previous_points());
        let moved = to.iter().zip(from.iter());
        let sum: f64 = moved
            .map(|(to, from)| f64::from(to.distance_squared(from)))
            .sum();
        60.0 * (sum / particles.len() as f64).sqrt()
    }

    pub fn stretch(&self) -> ClothStretch {
        self.particles().stretch(self.get::<ClothTopology>())
    }

    /// Mass of all particles [kg].
    pub fn mass(&self) -> f64 {
        let particles = self.particles();
        let mass = |i| f64::from(particles.mass(i));
        (0..particles.len()).map(mass).sum()
    }

    /// Complaint about the first sheet, or about its place.
    pub fn complaint(&self) -> Option<String> {
        let status = self.get::<ClothStatus>();
        if let Some(error) = status.errors().next() {
            return Some(error.to_string());
        }
        let lost = self.particles().positions().position(|p| !p.is_finite())?;
        Some(format!("particle {lost} is nowhere"))
    }

    /// FNV-1a, 64 bits, over the bits of all coordinates of all sheets.
    pub fn hash(&mut self) -> u64 {
        let mut query = self.app.world_mut().query::<&ClothParticles>();
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for particles in query.iter(self.app.world()) {
            let coordinates = particles.positions().flat_map(|p| p.to_array());
            for byte in coordinates.flat_map(|v| v.to_bits().to_le_bytes()) {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        hash
    }
}
