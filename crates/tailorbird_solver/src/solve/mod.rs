//! Stages of a substep within the cloth: inertia, then constraints, then damping of tangles.

mod chains;
mod classic;
mod fabric;
mod give;
mod slowing;
mod tangles;

use crate::{
    cloth::ClothData,
    coefficients::Method,
    effort,
    kernels::verlet::Verlet,
    particles::{Input, Particles, State},
    substep::Substep,
};

/// Moves the particles of one cloth.
pub fn integrate(substep: &Substep, cloth: &mut ClothData) {
    let (topology, material) = (cloth.topology, cloth.coefficients);
    let particles = &mut *cloth.particles;
    let seconds = substep.seconds;
    particles.damp_strained(seconds, substep.out());
    let verlet = Verlet {
        seconds,
        seconds_before: particles.state.substep_seconds,
        damping: if material.damping >= 0.0 {
            material.damping
        } else {
            0.0
        },
        gravity: cloth.frame.vector_to_frame(substep.gravity),
    };
    let moved = match cloth.method {
        Method::Lines => chains::integrate(substep, topology, material, verlet, particles),
        Method::Springs => 0,
    };
    let Particles {
        state:
            State {
                position,
                previous_position,
                lost_displacement,
                ..
            },
        input:
            Input {
                acceleration,
                inv_mass,
                held,
                ..
            },
        ..
    } = particles;
    if moved < inv_mass.len() {
        verlet.step(
            substep.level,
            position,
            previous_position,
            lost_displacement,
            (!acceleration.is_empty()).then_some(&*acceleration),
            inv_mass,
            moved..inv_mass.len(),
        );
    }
    for (pin, place) in held.pins() {
        let i = pin.index();
        let from = position.get(i);
        position.set(i, from + (place - from) / substep.left() as f32);
    }
    particles.move_grabbed(topology, substep.left(), seconds);
    particles.state.substep_seconds = seconds;
}

/// Solves the constraints of one cloth: springs of attachments together with all others, then the motion constraints.
pub fn solve(substep: &Substep, cloth: &mut ClothData) {
    let (topology, material) = (cloth.topology, cloth.coefficients);
    if let Some(forces) = &mut cloth.forces {
        forces.begin(substep, cloth.particles);
    }
    let (holds, frame) = (&mut *cloth.holds, &*cloth.frame);
    holds.stretch(substep, frame, cloth.particles);
    match cloth.method {
        Method::Lines => {
            for k in 0..substep.iterations {
                let pass = chains::Pass::of(substep, topology, material, k);
                pass.solve(cloth.tethers, cloth.particles);
            }
            let size = chains::Pass::of(substep, topology, material, 0).size();
            (cloth.particles).limit_strained(substep.seconds, [substep.out(), size]);
        }
        Method::Springs => {
            classic::solve(substep, topology, material, cloth.particles);
        }
    }
    let springs = holds.measure(frame, cloth.particles);
    if let Some(forces) = &mut cloth.forces {
        forces.end(substep, frame, cloth.particles, springs);
    }
    if let Some(motion) = cloth.limits {
        motion.hold(substep, cloth.particles);
    }
}

/// Damps tangles, after the last substep.
pub fn damp_tangles(substep: &Substep, cloth: &mut ClothData) {
    let solves = cloth.method == Method::Lines && substep.iterations > 0;
    if solves && substep.left() == 1 {
        let pass = chains::Pass::of(substep, cloth.topology, cloth.coefficients, 0);
        let longest = pass.slack() + effort::STRAIN;
        let seconds = substep.seconds * substep.count as f32;
        let (level, particles) = (substep.level, &mut *cloth.particles);
        tangles::damp(level, cloth.topology, longest, seconds, particles);
        cloth.particles.disturb(cloth.topology);
    }
}
