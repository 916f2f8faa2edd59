//! The stages of a step, for one cloth at a time.

use bevy_ecs::{prelude::*, query::QueryData};
use tailorbird_solver::{self as solver, step::Stage};

use crate::{
    attachment::ClothAttachedParticles,
    bounds::ClothBounds,
    cloth::Cloth,
    collider::{ClothColliders, ClothLayers},
    error::ClothStatus,
    frame::ClothFrame,
    material::ClothMaterial,
    motion::ClothMotionState,
    normals::{ClothNormals, ClothShading},
    particles::ClothParticles,
    reaction::ClothPinForces,
    sleep::{ClothSleep, ClothSleepState},
    solver::{ClothSolver, ClothSubsteps},
    step::ClothStep,
    tethers::ClothTethers,
    topology::ClothTopology,
};

/// Components of a cloth that the stages need. Opaque: read the cloth's components instead.
#[derive(QueryData)]
#[query_data(mutable)]
pub struct ClothStages {
    pub(crate) entity: Entity,
    pub(crate) topology: &'static ClothTopology,
    pub(crate) material: &'static ClothMaterial,
    pub(crate) solver: &'static ClothSolver,
    pub(crate) substeps: Option<&'static ClothSubsteps>,
    pub(crate) shading: &'static ClothShading,
    pub(crate) sleep: &'static ClothSleep,
    pub(crate) tethers: &'static ClothTethers,
    pub(crate) layers: Option<&'static ClothLayers>,
    pub(crate) attached: &'static mut ClothAttachedParticles,
    pub(crate) motion: Option<&'static ClothMotionState>,
    pub(crate) pin_forces: Option<&'static mut ClothPinForces>,
    pub(crate) frame: &'static mut ClothFrame,
    pub(crate) particles: &'static mut ClothParticles,
    pub(crate) normals: &'static mut ClothNormals,
    pub(crate) bounds: &'static mut ClothBounds,
    pub(crate) rest: &'static mut ClothSleepState,
    pub(crate) status: &'static mut ClothStatus,
}

impl ClothStagesItem<'_, '_> {
    /// Calls `f` with the cloth as the solver has it.
    pub(crate) fn with_cloth<R>(
        &mut self,
        f: impl FnOnce(&mut solver::cloth::ClothData) -> R,
    ) -> R {
        let coefficients = self.material.coefficients();
        f(&mut solver::cloth::ClothData {
            topology: self.topology,
            coefficients: &coefficients,
            method: self.solver.method(),
            layers: self.layers.copied().unwrap_or_default().layers(),
            tethers: &self.tethers.0,
            holds: &mut self.attached.0,
            limits: self.motion.map(|motion| &motion.limits),
            forces: self.pin_forces.as_deref_mut().map(|forces| &mut forces.0),
            frame: &mut self.frame.frame,
            particles: &mut self.particles.0,
        })
    }
}

/// Runs a stage of the substep in progress for all cloths that are awake.
pub(crate) fn run_stage(
    stage: Stage,
    step: &ClothStep,
    colliders: &ClothColliders,
    cloths: &mut Query<ClothStages, With<Cloth>>,
) {
    let substep = step.in_progress();
    for_each_awake(step, cloths, &|mut item| {
        item.with_cloth(|cloth| stage(&substep, &colliders.list, cloth));
    });
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
