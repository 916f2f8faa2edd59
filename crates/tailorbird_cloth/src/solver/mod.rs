//! The systems of a substep; their arithmetic is in [`kernels`].

mod calm;
pub(crate) mod chains;
mod classic;
mod fabric;
mod give;
pub mod kernels;
#[cfg(test)]
mod mesh_tests;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;

use crate::{
    cloth::Cloth,
    effort,
    particles::ClothParticles,
    stages::{ClothStages, ClothStagesItem, Substep, for_each_awake},
    step::ClothStep,
    topology::Topology,
};
use kernels::verlet::Verlet;

/// How the constraints of a cloth are solved.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
pub enum ClothSolver {
    /// Whole lines of edges at once, exactly; tethers to the pins. Particles at edges that are squeezed to less than 0.7 of their
    /// length at the end of a step get the motion of the whole.
    #[default]
    Chains,
    /// Spring by spring: Jakobsen's relaxation, and XPBD where there is compliance.
    GaussSeidel,
}

impl ClothSolver {
    /// How many substeps a cloth needs in a step of 1/60 s.
    ///
    /// [`Chains`](Self::Chains): a 24th of the particles along the longer side, n, and no less than n²/4096, 8 to 16, and 6 where that has
    /// 36 or less; even.
    /// Fewer do for a sheet that hangs, and not for one that is pulled or blown about. Of a mesh that is no grid a 12th of
    /// the square root of its particles, 8 to 16. Both take up to 40, a quarter of the longer side, while a hand holds the cloth.
    /// [`GaussSeidel`](Self::GaussSeidel): 16.
    pub fn substeps(self, topology: &Topology) -> u32 {
        match self {
            Self::Chains => {
                let needed = if let Some(lattice) = topology.lattice {
                    let side = lattice.columns.max(lattice.rows);
                    let least = if side <= 36 { 6 } else { 8 };
                    side.div_ceil(24).max(least).max(side * side / 4096)
                } else {
                    // The chains of a mesh are shorter and bent, and more of them meet at a particle.
                    let side = (topology.particles() as f32).sqrt().ceil() as u32;
                    side.div_ceil(12).max(8)
                };
                needed.next_multiple_of(2).min(16)
            }
            Self::GaussSeidel => 16,
        }
    }

    /// How many a cloth needs at least while a hand holds it: what a hand can lift in a substep is what a stretch of a tenth of an edge
    /// pulls, and the weight of the sheet has to follow. A quarter of the particles along the longer side, at most 40; even.
    pub(crate) fn substeps_in_hand(self, topology: &Topology) -> u32 {
        let side = match (self, topology.lattice) {
            (Self::GaussSeidel, _) => 0,
            (Self::Chains, Some(lattice)) => lattice.columns.max(lattice.rows),
            (Self::Chains, None) => (topology.particles() as f32).sqrt().ceil() as u32,
        };
        side.div_ceil(4).next_multiple_of(2).min(40)
    }
}

/// Moves particles by inertia, gravity, wind and forces; pins and the grabbed particle towards their targets.
pub fn verlet_step(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        integrate(&substep, &mut cloth);
    });
}

/// Holds the constraints, as the cloth's [`ClothSolver`] says, [`ClothStep::iterations`] times.
///
/// [`ClothSolver::GaussSeidel`] goes over batches that share no particle; those of compliance 0 are solved as Jakobsen's
/// relaxation, the others as XPBD.
pub fn solve_constraints(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        solve(&substep, &mut cloth);
    });
}

/// Moves the particles of one cloth.
pub(crate) fn integrate(substep: &Substep, cloth: &mut ClothStagesItem) {
    let (topology, material) = (cloth.topology, cloth.material);
    let particles = &mut *cloth.particles;
    let seconds = substep.seconds;
    particles.calm_strained(seconds);
    let verlet = Verlet {
        seconds,
        seconds_before: particles.substep_seconds,
        damping: if material.damping >= 0.0 {
            material.damping
        } else {
            0.0
        },
        gravity: cloth.frame.vector_to_frame(substep.gravity),
    };
    let moved = *cloth.solver == ClothSolver::Chains
        && chains::integrate(substep, topology, material, verlet, particles);
    let ClothParticles {
        position,
        previous_position,
        lost_displacement,
        acceleration,
        inv_mass,
        pins,
        ..
    } = particles;
    if !moved {
        verlet.step(
            substep.level,
            position,
            previous_position,
            lost_displacement,
            (!acceleration.is_empty()).then_some(&*acceleration),
            inv_mass,
        );
    }
    for pin in pins.iter() {
        let i = pin.particle as usize;
        let from = position.get(i);
        position.set(i, from + (pin.target - from) / substep.left() as f32);
    }
    particles.move_grabbed(topology, substep.left(), seconds);
    particles.substep_seconds = seconds;
}

/// Calms what is wound up in itself, after the last substep: see [`ClothSolver::Chains`].
pub fn calm_knots(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        calm(&substep, &mut cloth);
    });
}

/// What [`calm_knots`] does for one cloth.
pub(crate) fn calm(substep: &Substep, cloth: &mut ClothStagesItem) {
    let solves = *cloth.solver == ClothSolver::Chains && substep.iterations > 0;
    if solves && substep.left() == 1 {
        let pass = chains::Pass::of(substep, cloth.topology, cloth.material, 0);
        let longest = pass.slack() + effort::STRAIN;
        calm::calm(substep.level, cloth.topology, longest, &mut cloth.particles);
        cloth.particles.disturb(cloth.topology);
    }
}

/// Holds the constraints of one cloth: springs of attachments together with all others, then the motion constraints.
pub(crate) fn solve(substep: &Substep, cloth: &mut ClothStagesItem) {
    let (topology, material) = (cloth.topology, cloth.material);
    if let Some(forces) = &mut cloth.pin_forces {
        forces.begin(substep, &cloth.particles);
    }
    let (attached, frame) = (&mut *cloth.attached, &*cloth.frame);
    attached.stretch(substep, frame, &mut cloth.particles);
    match cloth.solver {
        ClothSolver::Chains => {
            for k in 0..substep.iterations {
                let pass = chains::Pass::of(substep, topology, material, k);
                pass.solve(cloth.tethers, &mut cloth.particles);
            }
        }
        ClothSolver::GaussSeidel => {
            classic::solve(substep, topology, material, &mut cloth.particles);
        }
    }
    let springs = attached.measure(frame, &mut cloth.particles);
    if let Some(forces) = &mut cloth.pin_forces {
        forces.end(substep, frame, &cloth.particles, springs);
    }
    if let Some(motion) = cloth.motion {
        motion.hold(substep, &mut cloth.particles);
    }
}

/// α̃ = α/h² [1/kg] of a compliance [m/N].
pub(crate) fn alpha_tilde(compliance: f32, seconds: f32) -> f32 {
    // What is not finite would turn into NaN in the product with a multiplier of 0.
    (compliance.max(0.0) / (seconds * seconds)).min(f32::MAX)
}
