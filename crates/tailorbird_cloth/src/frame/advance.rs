//! Frames move, and with them what is expressed in them.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, Vec3};
use tailorbird_solver::kernels::rigid;

use super::{ClothFrame, Taken};
use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    stages::{ClothStages, Substep, for_each_awake},
    step::ClothStep,
};

/// Moves the frames on by one substep, and expresses the free particles in the moved frame; moves what is attached or held at a
/// target.
pub fn advance_frames(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.advance(&substep);
    });
}

impl ClothFrame {
    /// Moves on by one substep.
    pub(crate) fn advance(&mut self, substep: &Substep, particles: &mut ClothParticles) {
        if !self.is_moving() {
            self.taken = None;
            particles.hold_still();
            return;
        }
        let (_, fraction) = substep.fractions();
        let way = Vec3::from(self.end.translation - self.start.translation);
        if substep.index == 0 {
            let seconds = substep.seconds * substep.count as f32;
            (particles.effort).carried([self.start, self.end], seconds);
        }
        let (offset, to) = if substep.left() == 1 {
            (way, self.end)
        } else {
            let offset = fraction * way;
            let place = Vec3::from(self.start.translation) + offset;
            let rotation = self.start.rotation.slerp(self.end.rotation, fraction);
            (offset, Isometry3d::new(place, rotation))
        };
        let ClothParticles {
            position,
            previous_position,
            lost_displacement,
            acceleration,
            inv_mass,
            ..
        } = particles;
        let from = (self.current.rotation, self.offset);
        (self.current, self.offset) = (to, offset);
        let inverse: Quat = to.rotation.inverse();
        let shift = inverse * (from.1 - offset);
        let turn = inverse * from.0;
        let rotation = Mat3::from_quat(turn);
        rigid::rotate(rotation, acceleration);
        let (rotation, shift) = if self.felt.is_all() {
            (rotation, shift)
        } else {
            let turn = Quat::IDENTITY.slerp(turn, self.felt.angular);
            let shift = self.felt.linear * shift;
            let motion = Isometry3d::new(shift, turn);
            self.taken = Some(Taken { from, motion });
            (Mat3::from_quat(turn), shift)
        };
        rigid::change_frame(rotation, shift, inv_mass, position, previous_position);
        rigid::rotate(rotation, lost_displacement);
        if self.felt.spin != Vec3::ZERO {
            let turned = inverse * self.felt.spin * substep.seconds;
            rigid::fling(turned, inv_mass, position);
        }
    }
}
