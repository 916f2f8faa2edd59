//! Motion of the holders that a cloth does not feel: it carries the cloth along.

use bevy_math::{Isometry3d, Quat, Vec3, Vec3A};
use tailorbird_solver::{
    holds::{Holder, STANDS},
    particles::{Particles, State},
    pose::{Pose, motion},
};

use super::ClothAttachedParticles;
use crate::{frame::ClothFrame, particles::ClothParticles};

/// The motion of a body, as seen from the frame at the start of the step. With the cloth's entity it may have been put elsewhere already.
fn motion_in(frame: &ClothFrame, from: &Pose, to: &Pose) -> Isometry3d {
    let from = from.at(frame.start_for(from.place(), to.place()));
    if from == *to {
        return Isometry3d::IDENTITY;
    }
    motion(&from, to, frame.isometry())
}

impl ClothAttachedParticles {
    /// The motion of the first body in this step, as seen from the frame at its start, where nothing else holds the cloth.
    pub(crate) fn motion_of_all(
        &self,
        frame: &ClothFrame,
        particles: &ClothParticles,
    ) -> Option<Isometry3d> {
        let body = self.leader(particles)?;
        Some(motion_in(frame, &body.start, &body.end))
    }

    /// The part of the first body's motion that is not felt, as seen from the frame at the start of the step, if nothing else holds
    /// the cloth.
    fn unfelt(&self, frame: &ClothFrame, particles: &ClothParticles) -> Option<Isometry3d> {
        let body = self.leader(particles)?;
        Some(motion_in(frame, body.jumped.as_ref()?, &body.start))
    }

    /// The body that leads a cloth which nothing else holds.
    fn leader(&self, particles: &ClothParticles) -> Option<&Holder> {
        let held_elsewhere = particles.input.held.any_in_frame();
        self.bodies.first().filter(|_| !held_elsewhere)
    }

    /// Returns whether a holder of the cloth was put elsewhere before this step.
    pub(crate) fn has_jumped(&self) -> bool {
        self.bodies.iter().any(|body| body.jumped.is_some())
    }

    /// Lets the holders of the cloth carry it along by the part of their displacement that is too sudden, if all holders have one.
    pub(super) fn soften(&mut self, particles: &ClothParticles) {
        let sudden = |body: &Holder| body.excess != Vec3::ZERO;
        if self.leader(particles).is_none() || !self.bodies.iter().all(sudden) {
            return;
        }
        let count = self.bodies.len() as f32;
        let displacement = self.bodies.iter().map(|body| body.excess).sum::<Vec3>() / count;
        for body in &mut self.0.bodies {
            let place = body.start.place();
            body.jumped.get_or_insert(body.start);
            let from = Isometry3d::new(
                place.translation + Vec3A::from(displacement),
                place.rotation,
            );
            body.start = body.start.at(from);
        }
    }

    /// Takes the whole cloth along, with its motion, if all its holders were put elsewhere. Returns whether they were.
    pub(super) fn take_along(&self, frame: &ClothFrame, particles: &mut ClothParticles) -> bool {
        self.bodies.iter().all(|body| body.jumped.is_some())
            && self.carry(frame, particles).is_some()
    }

    /// Moves the cloth and its motion along with its holders. Returns its rotation, if it moved.
    pub(crate) fn carry(&self, frame: &ClothFrame, particles: &mut ClothParticles) -> Option<Quat> {
        let motion = self.unfelt(frame, particles)?;
        let (distance, turn) = (motion.translation.length(), motion.rotation.xyz().length());
        if distance.max(turn) < STANDS {
            return None;
        }
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    step_position,
                    lost_displacement,
                    ..
                },
            ..
        } = &mut particles.0;
        for points in [position, previous_position, step_position] {
            for i in 0..points.len() {
                points.set(i, motion * points.get(i));
            }
        }
        for i in 0..lost_displacement.len() {
            lost_displacement.set(i, motion.rotation * lost_displacement.get(i));
        }
        Some(motion.rotation)
    }
}
