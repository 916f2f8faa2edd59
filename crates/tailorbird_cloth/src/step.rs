//! The step in progress.

mod begin;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tailorbird_solver::{substep::Substep, topology::Topology, workers::Workers};

pub(crate) use begin::begin_cloths;
pub use begin::{begin_step, plan_substeps};

use crate::{
    particles::ClothParticles,
    settings::ClothSettings,
    solver::{ClothSolver, ClothSubsteps},
};

/// The step in progress, for systems in [`ClothSubstep`](crate::schedule::ClothSubstep).
///
/// Written by [`begin_step`], [`plan_substeps`] and [`run_substeps`](crate::schedule::run_substeps) alone.
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothStep {
    /// The last valid settings.
    pub(crate) settings: ClothSettings,
    pub(crate) seconds: f32,
    pub(crate) world_seconds: f32,
    pub(crate) substeps: u32,
    pub(crate) substep: u32,
    /// The part that cloths get of the substeps that they want in a storm.
    pub(crate) granted_substeps: f32,
    pub(crate) elapsed: f64,
    pub(crate) steps: u64,
    /// Number of times that a snapshot was restored: steps of one number may differ.
    pub(crate) restores: u64,
    pub(crate) running: bool,
    pub(crate) parallel: bool,
    pub(crate) whole: bool,
    #[reflect(ignore)]
    pub(crate) level: SimdLevel,
}

/// The instruction set that the kernels use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SimdLevel(pub Level);

impl Default for SimdLevel {
    fn default() -> Self {
        Self(Level::new())
    }
}

/// Largest factor of the substeps for bodies that a cloth carries.
const MOST_LOADED: f32 = 4.0;

/// Least gravity for the weight that loads are compared with [m/s²].
const LEAST_GRAVITY: f32 = 1.0;

impl ClothStep {
    /// The length of the step \[s\].
    pub fn seconds(&self) -> f32 {
        self.seconds
    }

    /// Time that passes meanwhile for everything else \[s\]: see [`ClothSettings::time_scale`](crate::settings::ClothSettings::time_scale).
    pub fn world_seconds(&self) -> f32 {
        self.world_seconds
    }

    /// The length of a substep \[s\].
    pub fn substep_seconds(&self) -> f32 {
        self.seconds / self.substeps.max(1) as f32
    }

    /// The largest number of substeps of any cloth. Where a game has systems of its own in [`ClothSubstep`](crate::schedule::ClothSubstep),
    /// every cloth takes this many.
    pub fn substeps(&self) -> u32 {
        self.substeps
    }

    /// The substep in progress, from 0.
    pub fn substep(&self) -> u32 {
        self.substep
    }

    /// Part of the step that has passed at the end of the substep in progress, 0 to 1.
    pub fn fraction(&self) -> f32 {
        (self.substep + 1) as f32 / self.substeps.max(1) as f32
    }

    /// Passes over the constraints in each substep.
    pub fn iterations(&self) -> u32 {
        self.settings.iterations
    }

    /// Acceleration of every particle [m/s²], in world axes.
    pub fn gravity(&self) -> Vec3 {
        self.settings.gravity
    }

    /// Simulated time at the start of the step \[s\].
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// Number of steps that have begun.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Number of times that a [`ClothSnapshot`](crate::snapshot::ClothSnapshot) was restored: a step of the same [number](Self::steps) may be
    /// another one after it.
    pub fn restores(&self) -> u64 {
        self.restores
    }

    /// Returns whether this tick simulates: not paused, and time passes.
    pub fn running(&self) -> bool {
        self.running
    }

    /// The instruction set that the kernels use.
    pub(crate) fn level(&self) -> Level {
        self.level.0
    }

    /// Returns whether it pays to share several cloths out to threads.
    pub fn parallel(&self) -> bool {
        self.parallel
    }

    /// The number of substeps that is set for a cloth.
    pub(crate) fn fixed_substeps(&self, own: Option<&ClothSubsteps>) -> Option<u32> {
        own.map(|own| own.0).or(self.settings.substeps)
    }

    /// Number of substeps of this cloth if it need not keep step with others.
    pub(crate) fn substeps_of(
        &self,
        (solver, own): (ClothSolver, Option<&ClothSubsteps>),
        topology: &Topology,
        particles: &ClothParticles,
    ) -> u32 {
        let automatic = || {
            let unloaded =
                solver.substeps(topology) * self.settings.time_scale.ceil().max(1.0) as u32;
            let stretched = 1.0 + more_substeps(solver, particles) * self.granted_substeps;
            let times = self.loaded(particles).max(stretched);
            let loaded = (unloaded as f32 * times).ceil() as u32;
            let held = if particles.input.held.in_hand().is_some() {
                loaded.max(solver.substeps_in_hand(topology))
            } else {
                loaded
            };
            held.min(self.settings.most_substeps)
        };
        self.fixed_substeps(own).unwrap_or_else(automatic).max(1)
    }

    /// Factor of the substeps of a cloth for the bodies that it carries: the tension grows with their weight, and raises the speed of
    /// transverse waves, which a substep must resolve.
    fn loaded(&self, particles: &ClothParticles) -> f32 {
        let load = particles.0.state.load;
        if load == 0.0 || !particles.0.input.inv_mass.contains(&0.0) {
            return 1.0;
        }
        let mass: f32 = particles.0.input.mass.iter().sum();
        let weight = mass * self.settings.gravity.length().max(LEAST_GRAVITY);
        (1.0 + 1.5 * load / weight).min(MOST_LOADED)
    }

    /// The substep `index` of `count`.
    pub(crate) fn nth_of<'a>(&self, index: u32, count: u32, workers: Workers<'a>) -> Substep<'a> {
        Substep {
            level: self.level.0,
            seconds: self.seconds / count.max(1) as f32,
            index,
            count: count.max(1),
            iterations: self.settings.iterations,
            gravity: self.settings.gravity,
            overlap_speed: self.settings.overlap_speed,
            workers,
        }
    }

    /// The substep in progress, of those that all cloths take together.
    pub(crate) fn in_progress(&self) -> Substep<'static> {
        self.nth_of(self.substep, self.substeps, Workers::ALONE)
    }
}

/// Run condition: each cloth goes through the step by itself, as nobody has anything to do between its stages.
pub(crate) fn step_is_whole(step: Res<ClothStep>) -> bool {
    step.whole
}

/// Run condition: this tick simulates.
pub fn step_runs(step: Res<ClothStep>) -> bool {
    step.running
}

/// Additional substeps of a cloth that a storm stretches, as a multiple of their number at rest [-]. The classic solver takes none.
fn more_substeps(solver: ClothSolver, particles: &ClothParticles) -> f32 {
    match solver {
        ClothSolver::Chains => particles.0.state.effort.more_substeps(),
        ClothSolver::GaussSeidel => 0.0,
    }
}
