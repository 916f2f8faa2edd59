//! The step in progress.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use bevy_time::Time;
use fearless_simd::Level;
use tailorbird_solver::{substep::Substep, topology::Topology, workers::Workers};
use tracing::error;

use crate::{
    cloth::Cloth, particles::ClothParticles, runner::OwnStages, settings::ClothSettings,
    sleep::ClothRest, solver::ClothSolver, topology::ClothTopology,
};

/// The step in progress, for systems in [`ClothSubstep`](crate::schedule::ClothSubstep).
///
/// Written by [`begin_step`], [`plan_substeps`] and [`run_substeps`](crate::schedule::run_substeps) alone.
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothStep {
    pub(crate) seconds: f32,
    pub(crate) world_seconds: f32,
    pub(crate) time_scale: f32,
    pub(crate) substeps: u32,
    pub(crate) fixed_substeps: Option<u32>,
    pub(crate) substep: u32,
    pub(crate) iterations: u32,
    pub(crate) gravity: Vec3,
    pub(crate) overlap_speed: f32,
    pub(crate) most_substeps: u32,
    pub(crate) substep_budget: u32,
    /// The part that cloths get of the substeps that they want in a storm.
    pub(crate) granted_substeps: f32,
    pub(crate) elapsed: f64,
    pub(crate) steps: u64,
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

/// Number of particles of a sheet that take as much time as a particle of a mesh.
const MESH: f32 = 8.0;

/// Number of particles (over all cloths) from which on cloths are shared out to threads.
///
/// Sharing out costs 15 to 30 µs for each system, about what 4,000 particles cost in the cheapest one.
const PARALLEL_FROM: usize = 16_384;

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
        self.iterations
    }

    /// Acceleration of every particle [m/s²], in world axes.
    pub fn gravity(&self) -> Vec3 {
        self.gravity
    }

    /// Simulated time at the start of the step \[s\].
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// Number of steps that have begun.
    pub fn steps(&self) -> u64 {
        self.steps
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

    /// Number of substeps of this cloth if it need not keep step with others.
    pub(crate) fn substeps_of(
        &self,
        solver: ClothSolver,
        topology: &Topology,
        particles: &ClothParticles,
    ) -> u32 {
        let automatic = || {
            let unloaded = solver.substeps(topology) * self.time_scale.ceil().max(1.0) as u32;
            let stretched = 1.0 + more_substeps(solver, particles) * self.granted_substeps;
            let times = self.loaded(particles).max(stretched);
            let loaded = (unloaded as f32 * times).ceil() as u32;
            let held = if particles.input.held.in_hand().is_some() {
                loaded.max(solver.substeps_in_hand(topology))
            } else {
                loaded
            };
            held.min(self.most_substeps)
        };
        self.fixed_substeps.unwrap_or_else(automatic).max(1)
    }

    /// Factor of the substeps of a cloth for the bodies that it carries: the tension grows with their weight, and raises the speed of
    /// transverse waves, which a substep must resolve.
    fn loaded(&self, particles: &ClothParticles) -> f32 {
        let load = particles.0.state.load;
        if load == 0.0 || !particles.0.input.inv_mass.contains(&0.0) {
            return 1.0;
        }
        let mass: f32 = particles.0.input.mass.iter().sum();
        let weight = mass * self.gravity.length().max(LEAST_GRAVITY);
        (1.0 + 1.5 * load / weight).min(MOST_LOADED)
    }

    /// The substep `index` of `count`.
    pub(crate) fn nth_of<'a>(&self, index: u32, count: u32, workers: Workers<'a>) -> Substep<'a> {
        Substep {
            level: self.level.0,
            seconds: self.seconds / count.max(1) as f32,
            index,
            count: count.max(1),
            iterations: self.iterations,
            gravity: self.gravity,
            overlap_speed: self.overlap_speed,
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

/// Prepares the step from the settings and the clock of the schedule.
///
/// Invalid settings are logged once, and the last valid ones stay in force.
pub fn begin_step(
    mut step: ResMut<ClothStep>,
    mut settings: ResMut<ClothSettings>,
    mut valid: Local<ClothSettings>,
    time: Res<Time>,
    (schedules, own): (Res<Schedules>, Res<OwnStages>),
    cloths: Query<(&ClothRest, &ClothParticles), With<Cloth>>,
) {
    if settings.is_changed() {
        let errors = settings.errors();
        for kind in &errors {
            error!("{kind}; the last valid settings stay in force");
        }
        if errors.is_empty() {
            valid.clone_from(&settings);
        } else {
            valid.paused = settings.paused;
        }
    }

    let single_step = settings.paused && settings.pending_steps > 0;
    if single_step {
        settings.bypass_change_detection().pending_steps -= 1;
    }

    if step.running {
        step.elapsed += f64::from(step.seconds);
    }
    step.world_seconds = time.delta_secs();
    step.time_scale = valid.time_scale;
    step.seconds = valid.time_scale * step.world_seconds;
    step.substep = 0;
    step.fixed_substeps = valid.substeps;
    step.level = SimdLevel(valid.instruction_set.level());
    step.iterations = valid.iterations;
    step.gravity = valid.gravity;
    step.overlap_speed = valid.overlap_speed;
    step.most_substeps = valid.most_substeps;
    step.substep_budget = valid.substep_budget;
    step.running = step.seconds > 0.0 && (!settings.paused || single_step);
    step.steps += u64::from(step.running);
    step.whole = step.running && own.are_all(&schedules);

    let (mut count, mut particles) = (0, 0);
    for (rest, cloth) in &cloths {
        if !rest.is_asleep() {
            count += 1;
            particles += cloth.len();
        }
    }
    step.parallel = count > 1 && particles >= PARALLEL_FROM;
}

/// Notes where the step starts, of all cloths that are awake, those that have just woken included; also while paused: then both ends of the
/// interpolation agree.
pub(crate) fn begin_cloths(mut cloths: Query<(&ClothRest, &mut ClothParticles), With<Cloth>>) {
    for (rest, mut cloth) in &mut cloths {
        if !rest.is_asleep() {
            cloth.0.begin_step();
        }
    }
}

/// Additional substeps of a cloth that a storm stretches, as a multiple of their number at rest [-]. The classic solver takes none.
fn more_substeps(solver: ClothSolver, particles: &ClothParticles) -> f32 {
    match solver {
        ClothSolver::Chains => particles.0.state.effort.more_substeps(),
        ClothSolver::GaussSeidel => 0.0,
    }
}

/// Chooses the number of substeps: the one that is set, or as many as the cloth needs that needs most. Shares out the budget for
/// storms.
pub fn plan_substeps(
    mut step: ResMut<ClothStep>,
    cloths: Query<(&ClothSolver, &ClothTopology, &ClothParticles, &ClothRest), With<Cloth>>,
) {
    let awake = cloths.iter().filter(|(.., rest)| !rest.is_asleep());
    let wanted = awake.map(|(solver, topology, particles, _)| {
        let weight = if topology.fabric.is_some() { MESH } else { 1.0 };
        let unstretched = solver.substeps(topology) as f32;
        weight * particles.len() as f32 * unstretched * more_substeps(*solver, particles)
    });
    let wanted: f32 = wanted.sum();
    step.granted_substeps = (step.substep_budget as f32 / wanted.max(1.0)).min(1.0);
    step.substeps = step.fixed_substeps.unwrap_or_else(|| {
        let needed = cloths
            .iter()
            .map(|(solver, topology, particles, _)| step.substeps_of(*solver, topology, particles));
        needed.max().unwrap_or(1)
    });
}
