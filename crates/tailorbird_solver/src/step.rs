//! A step: a loop over substeps, and the table of the stages of each.

use bevy_math::{Isometry3d, Mat3, Quat, Vec3};
use fearless_simd::Level;

use crate::{
    cloth::ClothData,
    contact::colliders::Colliders,
    frame::{Frame, Taken},
    kernels::{range::are_finite, rigid},
    particles::{Input, Particles, State},
    solve,
    substep::Substep,
    topology::order::Stored,
};

/// A stage of a substep: a change of a cloth.
pub type Stage = fn(&Substep, &Colliders, &mut ClothData);

/// The stages of a substep, in their order.
pub const STAGES: [Stage; 6] = [ADVANCE, INTEGRATE, APPROACH, SOLVE, COLLIDE, DAMP];

/// Moves the frame, and with it the particles that others hold.
pub const ADVANCE: Stage = |substep, _, cloth| advance(substep, cloth);

/// Moves particles by inertia, gravity, wind and forces.
pub const INTEGRATE: Stage = |substep, _, cloth| solve::integrate(substep, cloth);

/// Pushes particles out of colliders, and notes contacts.
pub const APPROACH: Stage = |substep, colliders, cloth| colliders.approach(substep, cloth);

/// Holds the constraints.
pub const SOLVE: Stage = |substep, _, cloth| solve::solve(substep, cloth);

/// Keeps particles out of colliders, with friction.
pub const COLLIDE: Stage = |substep, colliders, cloth| colliders.collide_all(substep, cloth);

/// Damps tangles at the end of the last substep, and measures strain.
pub const DAMP: Stage = |substep, _, cloth| solve::damp_tangles(substep, cloth);

/// Takes a group of cloths through all substeps of a step, side by side: all are in the same stage of the same substep. `nth` gives the
/// parameters of the substep of an index. A cloth that meets no other is a group of one.
pub fn step<'a>(
    count: u32,
    nth: impl Fn(u32) -> Substep<'a>,
    colliders: &Colliders,
    group: &mut [ClothData],
) {
    for index in 0..count {
        let substep = nth(index);
        for stage in STAGES {
            for cloth in &mut *group {
                stage(&substep, colliders, cloth);
            }
        }
    }
}

/// Result of a step for a cloth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// The part of the edges that is longer than the fabric lets them be, because more is asked of it than it has [-].
    pub strained: f32,
    /// The part of the edges that is longer than the fabric lets them be [-].
    pub stretched: f32,
    /// The first particle, in storage order, whose position or velocity is not finite.
    pub non_finite: Option<Stored>,
}

impl Report {
    /// The report of the particles of a cloth, after a step.
    pub fn of(level: Level, particles: &Particles) -> Self {
        let State {
            position,
            previous_position,
            effort,
            ..
        } = &particles.state;
        let all = [position, previous_position];
        let finite = all.iter().all(|points| are_finite(level, points));
        let is_wrong = |i: &usize| !all.iter().all(|points| points.get(*i).is_finite());
        let wrong = || (0..particles.len()).find(is_wrong);
        Self {
            strained: effort.unmet(),
            stretched: effort.stretched(),
            non_finite: if finite {
                None
            } else {
                wrong().map(|i| Stored(i as u32))
            },
        }
    }
}

fn advance(substep: &Substep, cloth: &mut ClothData) {
    advance_frame(cloth.frame, substep, cloth.particles);
    if let Some(limits) = cloth.limits {
        limits.advance(substep, cloth.particles);
    }
    cloth.holds.advance(substep, cloth.frame, cloth.particles);
}

/// Moves a frame on by one substep, and expresses the free particles in the moved frame.
fn advance_frame(frame: &mut Frame, substep: &Substep, particles: &mut Particles) {
    if !frame.is_moving() {
        frame.taken = None;
        particles.hold_still();
        return;
    }
    let (_, fraction) = substep.fractions();
    let displacement = Vec3::from(frame.end.translation - frame.start.translation);
    if substep.index == 0 {
        let seconds = substep.seconds * substep.count as f32;
        (particles.state.effort).carried([frame.start, frame.end], seconds);
    }
    let (offset, to) = if substep.left() == 1 {
        (displacement, frame.end)
    } else {
        let offset = fraction * displacement;
        let place = Vec3::from(frame.start.translation) + offset;
        let rotation = frame.start.rotation.slerp(frame.end.rotation, fraction);
        (offset, Isometry3d::new(place, rotation))
    };
    let Particles {
        state:
            State {
                position,
                previous_position,
                lost_displacement,
                ..
            },
        input: Input {
            acceleration,
            inv_mass,
            ..
        },
        ..
    } = particles;
    let from = (frame.current.rotation, frame.offset);
    (frame.current, frame.offset) = (to, offset);
    let inverse: Quat = to.rotation.inverse();
    let shift = inverse * (from.1 - offset);
    let turn = inverse * from.0;
    let rotation = Mat3::from_quat(turn);
    rigid::rotate(rotation, acceleration);
    let (rotation, shift) = if frame.felt.is_all() {
        (rotation, shift)
    } else {
        let turn = Quat::IDENTITY.slerp(turn, frame.felt.angular);
        let shift = frame.felt.linear * shift;
        let motion = Isometry3d::new(shift, turn);
        frame.taken = Some(Taken { from, motion });
        (Mat3::from_quat(turn), shift)
    };
    rigid::change_frame(rotation, shift, inv_mass, position, previous_position);
    rigid::rotate(rotation, lost_displacement);
    if frame.felt.spin != Vec3::ZERO {
        let turned = inverse * frame.felt.spin * substep.seconds;
        rigid::add_centrifugal(turned, inv_mass, position);
    }
}

#[cfg(test)]
mod tests;
