//! One sheet (or several alike), made for tests. Its frame is the world's: columns along +x, rows along −y.

use bevy_ecs::{component::Mutable, prelude::*};
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::{
    measure,
    sim::{G, HZ, Sim},
};

/// Scene to simulate.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Width and height \[m\].
    pub size: Vec2,
    /// Columns and rows.
    pub resolution: UVec2,
    /// In place of the grid of this size and resolution.
    pub cloth: Option<Cloth>,
    /// Of each sheet.
    pub material: ClothMaterial,
    /// Of each sheet.
    pub pins: ClothPins,
    /// [m/s²].
    pub gravity: Vec3,
    /// In the whole world.
    pub wind: ClothWind,
    /// Number of substeps, by default what the resolution asks for.
    pub substeps: Option<u32>,
    /// Of the kernels.
    pub instruction_set: ClothInstructionSet,
    /// Steps in a second.
    pub hz: f64,
    /// Middle and radius \[m\].
    pub sphere: Option<(Vec3, f32)>,
    /// Of the pool; a process has one, that of the first scene.
    pub threads: Option<usize>,
    /// Number of sheets, 3 m apart along x.
    pub sheets: u32,
    /// Of each sheet.
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
            hz: HZ,
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

/// A [`Sim`] whose updates are steps, and a sheet in it.
pub struct Sheet {
    /// All that is not about the first sheet.
    pub sim: Sim,
    /// The first sheet.
    pub entity: Entity,
    /// The sphere.
    pub sphere: Option<Entity>,
}

impl Sheet {
    /// Built, and no time has passed.
    pub fn new(scene: &Scene) -> Self {
        let mut sim = Sim::with_threads(scene.threads).with_settings(|settings| {
            settings.gravity = scene.gravity;
            settings.substeps = scene.substeps;
            settings.instruction_set = scene.instruction_set;
        });
        sim.app.insert_resource(scene.wind.clone());
        sim.set_hz(scene.hz);
        let sphere = scene.sphere.map(|(center, radius)| {
            let at = Transform::from_translation(center);
            sim.spawn((ClothCollider::sphere(radius), at))
        });
        let sheets: Vec<Entity> = (0..scene.sheets)
            .map(|k| {
                let grid = || Cloth::grid(scene.size, scene.resolution).centered();
                let cloth = scene.cloth.clone().unwrap_or_else(grid);
                let at = Transform::from_xyz(3.0 * k as f32, 0.0, 0.0);
                sim.spawn((cloth, scene.material, scene.pins.clone(), scene.sleep, at))
            })
            .collect();
        sim.build();
        Self {
            sim,
            entity: sheets[0],
            sphere,
        }
    }

    /// Simulates a step.
    pub fn step(&mut self) {
        self.steps(1);
    }

    /// Simulates so many steps.
    pub fn steps(&mut self, count: u32) {
        self.sim.steps(count);
    }

    /// A component of the first sheet.
    pub fn get<T: Component>(&self) -> &T {
        self.sim.get(self.entity)
    }

    /// Adds components to the first sheet.
    pub fn insert(&mut self, bundle: impl Bundle) {
        self.sim.insert(self.entity, bundle);
    }

    /// A component of the first sheet, to change.
    pub fn change<T: Component<Mutability = Mutable>>(&mut self, change: impl FnOnce(&mut T)) {
        self.sim.edit(self.entity, change);
    }

    /// The settings, to change.
    pub fn settings(&mut self, change: impl FnOnce(&mut ClothSettings)) {
        change(&mut self.sim.settings());
    }

    /// The particles, in their frame.
    pub fn particles(&self) -> &ClothParticles {
        self.get()
    }

    /// Places of all particles, in their frame.
    pub fn positions(&self) -> Vec<Vec3> {
        self.particles().positions().collect()
    }

    /// Places of all particles, in the world.
    pub fn world_positions(&self) -> Vec<Vec3> {
        self.sim.positions(self.entity)
    }

    /// The speed of the fastest particle [m/s].
    pub fn fastest(&self) -> f32 {
        self.sim.fastest(self.entity)
    }

    /// The length of a substep \[s\].
    pub fn substep_seconds(&self) -> f32 {
        self.sim.resource::<ClothStep>().substep_seconds()
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

    /// Stretch of all edges.
    pub fn stretch(&self) -> ClothStretch {
        self.sim.stretch(self.entity)
    }

    /// Mass of all particles \[kg\].
    pub fn mass(&self) -> f64 {
        let particles = self.particles();
        let mass = |i| f64::from(particles.mass(i));
        (0..particles.len()).map(mass).sum()
    }

    /// Returns whether the first sheet sleeps.
    pub fn is_asleep(&self) -> bool {
        self.get::<ClothSleepState>().is_asleep()
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

    /// A hash over the bits of all particles of all sheets.
    pub fn hash(&mut self) -> u64 {
        let mut query = self.sim.app.world_mut().query::<&ClothParticles>();
        measure::hash(query.iter(self.sim.app.world()))
    }
}
