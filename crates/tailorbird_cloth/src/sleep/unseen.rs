//! Cloth that nobody sees can sleep whatever it does.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec3};

use super::{ClothSeen, ClothSleep, ClothSleepState, Unseen};
use crate::{
    attachment::ClothAttachedParticles, bounds::ClothBounds, cloth::Cloth, frame::ClothFrame,
    motion::ClothMotionTargets, normals::ClothNormals, particles::ClothParticles, step::ClothStep,
};

/// Lets cloths sleep that nobody sees, and wakes those that somebody sees again.
pub fn rest_unseen(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothSleep,
            &ClothSeen,
            &mut ClothSleepState,
            &mut ClothFrame,
            Has<ClothMotionTargets>,
        ),
        With<Cloth>,
    >,
) {
    for (sleep, seen, mut rest, mut frame, has_targets) in &mut cloths {
        let sleeps = sleep.unseen && !seen.0 && !has_targets;
        let unseen = match rest.unseen {
            Unseen::No | Unseen::Back if sleeps => {
                Unseen::Since(step.steps() - u64::from(step.running()))
            }
            Unseen::Back => Unseen::No,
            Unseen::Touched(_) if step.running() => Unseen::Back,
            Unseen::Since(_) if step.running() && !sleeps => Unseen::Back,
            same => same,
        };
        if unseen != rest.unseen {
            *rest = ClothSleepState {
                unseen,
                settings: rest.settings,
                ..ClothSleepState::default()
            };
            frame.bypass_change_detection().carries = rest.is_unseen();
        }
    }
}

/// Carries cloths that nobody sees along with what holds them, also during a pause, and those that are seen again on at its velocity.
pub fn carry_unseen(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothSleepState,
            &ClothFrame,
            &ClothAttachedParticles,
            &mut ClothParticles,
            &mut ClothNormals,
            &mut ClothBounds,
        ),
        With<Cloth>,
    >,
) {
    for (rest, frame, attached, mut particles, mut normals, mut bounds) in &mut cloths {
        match rest.unseen {
            Unseen::No => {}
            Unseen::Since(_) | Unseen::Touched(_) => {
                if let Some(turn) = attached.carry(frame, &mut particles) {
                    normals.turn(turn);
                    particles.0.begin_step();
                    let around = ClothBounds::around(step.level(), &particles);
                    bounds.set_if_neq(around.unwrap_or_default());
                }
            }
            Unseen::Back => {
                particles.0.begin_step();
                let by_others = attached.motion_of_all(frame, &particles);
                let motion = by_others.unwrap_or_else(|| frame.felt_motion());
                // What was put elsewhere in this step has no velocity.
                let rests = attached.has_jumped() || step.seconds() <= 0.0;
                let motion = if rests { Isometry3d::IDENTITY } else { motion };
                particles.go_along(motion, step.seconds());
            }
        }
    }
}

impl ClothParticles {
    /// Gives the free particles the velocity of a rigid motion that takes so long \[s\].
    fn go_along(&mut self, motion: Isometry3d, seconds: f32) {
        let state = &mut self.0.state;
        if state.substep_seconds <= 0.0 {
            state.substep_seconds = seconds;
        }
        let part = if seconds > 0.0 {
            state.substep_seconds / seconds
        } else {
            0.0
        };
        let back = Isometry3d::new(
            -part * Vec3::from(motion.translation),
            Quat::IDENTITY.slerp(motion.rotation.inverse(), part.min(1.0)),
        );
        for i in 0..state.position.len() {
            (state.previous_position).set(i, back * state.position.get(i));
        }
        state.lost_displacement.fill(Vec3::ZERO);
    }
}
