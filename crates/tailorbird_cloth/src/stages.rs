//! The stages of a step, for one cloth at a time.

use bevy_ecs::{prelude::*, query::QueryData};
use bevy_math::Vec3;
use fearless_simd::Level;
use tailorbird_solver::crew::Crew;

use crate::{
    attachment::AttachedParticles,
    bounds::ClothBounds,
    cloth::Cloth,
    collider::{ClothColliders, ClothLayers},
    error::ClothStatus,
    frame::ClothFrame,
    material::ClothMaterial,
    motion::MotionState,
    normals::{ClothNormals, ClothShading},
    particles::ClothParticles,
    reaction::ClothPinForces,
    sleep::{ClothRest, ClothSleep},
    solver::{self, ClothSolver},
    step::ClothStep,
    tethers::ClothTethers,
    topology::ClothTopology,
};

/// A substep of one cloth: what its stages are told.
#[derive(Clone, Copy)]
pub(crate) struct Substep<'a> {
    /// The instruction set that the kernels use.
    pub level: Level,
    /// Its length \[s\].
    pub seconds: f32,
    /// Which it is, from 0.
    pub index: u32,
    /// How many there are.
    pub count: u32,
    /// Passes over the constraints.
    pub iterations: u32,
    /// Acceleration of every particle [m/s²], in world axes.
    pub gravity: Vec3,
    /// How fast what is inside a collider is pushed out of it [m/s].
    pub overlap_speed: f32,
    /// Who works on it.
    pub crew: Crew<'a>,
}

impl Substep<'_> {
    /// How far what is inside a collider is pushed out of it, each of the two times in a substep \[m\].
    pub fn out(&self) -> f32 {
        0.5 * self.overlap_speed * self.seconds
    }

    /// How many are left, this one included.
    pub fn left(&self) -> u32 {
        self.count - self.index
    }

    /// The parts of the step that have passed at its start and at its end, 0 to 1.
    pub fn fractions(&self) -> (f32, f32) {
        let to = (self.index + 1) as f32 / self.count as f32;
        (to - 1.0 / self.count as f32, to)
    }
}

/// What the stages need of a cloth. Opaque: the cloth's components are what to read.
#[derive(QueryData)]
#[query_data(mutable)]
pub struct ClothStages {
    pub(crate) entity: Entity,
    pub(crate) topology: &'static ClothTopology,
    pub(crate) material: &'static ClothMaterial,
    pub(crate) solver: &'static ClothSolver,
    pub(crate) shading: &'static ClothShading,
    pub(crate) sleep: &'static ClothSleep,
    pub(crate) tethers: &'static ClothTethers,
    pub(crate) layers: Option<&'static ClothLayers>,
    pub(crate) attached: &'static mut AttachedParticles,
    pub(crate) motion: Option<&'static MotionState>,
    pub(crate) pin_forces: Option<&'static mut ClothPinForces>,
    pub(crate) frame: &'static mut ClothFrame,
    pub(crate) particles: &'static mut ClothParticles,
    pub(crate) normals: &'static mut ClothNormals,
    pub(crate) bounds: &'static mut ClothBounds,
    pub(crate) rest: &'static mut ClothRest,
    pub(crate) status: &'static mut ClothStatus,
}

impl ClothStagesItem<'_, '_> {
    /// All stages of a substep, in the order of [`ClothSubstep`](crate::schedule::ClothSubstep).
    pub(crate) fn substep(&mut self, substep: &Substep, colliders: &ClothColliders) {
        self.advance(substep);
        solver::integrate(substep, self);
        colliders.approach(substep, self);
        solver::solve(substep, self);
        colliders.collide_all(substep, self);
        solver::calm(substep, self);
    }
    /// Moves the frame on by one substep, and with it what is held by others.
    pub(crate) fn advance(&mut self, substep: &Substep) {
        let particles = &mut *self.particles;
        self.frame.advance(substep, particles);
        if let Some(motion) = self.motion {
            motion.advance(substep, particles);
        }
        self.attached.advance(substep, &self.frame, particles);
    }
}

/// Calls `f` for each cloth, on several threads where [`ClothStep::parallel`] says that it pays. Each call has the cloth for itself,
/// so that the result does not depend on the number of threads.
///
/// Not generic: what shares out to threads is compiled once.
pub(crate) fn for_each_cloth(
    step: &ClothStep,
    cloths: &mut Query<ClothStages, With<Cloth>>,
    f: &(dyn Fn(ClothStagesItem) + Sync),
) {
    if step.parallel() {
        cloths.par_iter_mut().for_each(f);
    } else {
        cloths.iter_mut().for_each(f);
    }
}

/// [`for_each_cloth`], for those that do not sleep.
pub(crate) fn for_each_awake(
    step: &ClothStep,
    cloths: &mut Query<ClothStages, With<Cloth>>,
    f: &(dyn Fn(ClothStagesItem) + Sync),
) {
    for_each_cloth(step, cloths, &|cloth| {
        if !cloth.rest.is_asleep() {
            f(cloth);
        }
    });
}
