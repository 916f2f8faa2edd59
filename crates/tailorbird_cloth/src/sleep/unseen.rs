//! Cloth that nobody sees can sleep whatever it does.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec3};
use bevy_reflect::prelude::*;

use super::{ClothRest, ClothSleep};
use crate::{
    attachment::AttachedParticles, bounds::ClothBounds, cloth::Cloth, frame::ClothFrame,
    motion::ClothMotionTargets, particles::ClothParticles, step::ClothStep,
};

/// Whether somebody sees the cloth: its picture, or its shadow.
///
/// Whoever draws cloth says so, here; without that, all cloths are seen. It matters where [`ClothSleep::unseen`] is set.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothSeen(pub bool);

impl Default for ClothSeen {
    fn default() -> Self {
        Self(true)
    }
}

/// Whether a cloth sleeps because nobody sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub(super) enum Unseen {
    /// It is seen, or sleeps for other reasons alone.
    #[default]
    No,
    /// After this step it was seen no more.
    Since(u64),
    /// It is seen again from this step on.
    Back,
}

/// Lets cloths sleep that nobody sees, and wakes those that somebody sees again.
pub fn rest_unseen(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothSleep,
            &ClothSeen,
            &mut ClothRest,
            &mut ClothFrame,
            Has<ClothMotionTargets>,
        ),
        With<Cloth>,
    >,
) {
    for (sleep, seen, mut rest, mut frame, has_targets) in &mut cloths {
        let sleeps = sleep.unseen && !seen.0 && !has_targets;
        let unseen = match rest.unseen {
            Unseen::No if sleeps => Unseen::Since(step.steps()),
            Unseen::Back if sleeps => Unseen::Since(step.steps()),
            Unseen::Since(_) if !sleeps => Unseen::Back,
            // The step that is over was the first one.
            Unseen::Back if step.running() => Unseen::No,
            same => same,
        };
        if unseen != rest.unseen {
            *rest = ClothRest {
                unseen,
                ..ClothRest::default()
            };
            frame.bypass_change_detection().carries = matches!(unseen, Unseen::Since(_));
        }
    }
}

/// Carries cloths that nobody sees along with what holds them, and those that are seen again on at its velocity.
pub fn carry_unseen(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothRest,
            &ClothFrame,
            &AttachedParticles,
            &mut ClothParticles,
            &mut ClothBounds,
        ),
        With<Cloth>,
    >,
) {
    for (rest, frame, attached, mut particles, mut bounds) in &mut cloths {
        match rest.unseen {
            Unseen::No => {}
            Unseen::Since(_) => {
                if attached.carry(frame, &mut particles) {
                    particles.begin_step();
                    let around = ClothBounds::around(step.level(), &particles);
                    bounds.set_if_neq(around.unwrap_or_default());
                }
            }
            Unseen::Back => {
                let by_others = attached.motion_of_all(frame, &particles);
                let motion = by_others.unwrap_or_else(|| frame.felt_motion());
                particles.go_along(motion, step.seconds());
            }
        }
    }
}

impl ClothParticles {
    /// Gives the free particles the velocity of a rigid motion that takes so long \[s\].
    fn go_along(&mut self, motion: Isometry3d, seconds: f32) {
        let part = self.substep_seconds / seconds;
        let Self {
            position,
            previous_position,
            lost_displacement,
            ..
        } = self;
        let back = Isometry3d::new(
            -part * Vec3::from(motion.translation),
            Quat::IDENTITY.slerp(motion.rotation.inverse(), part.min(1.0)),
        );
        for i in 0..position.len() {
            previous_position.set(i, back * position.get(i));
        }
        lost_displacement.fill(Vec3::ZERO);
    }
}
