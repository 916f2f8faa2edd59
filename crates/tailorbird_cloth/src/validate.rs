//! Checks the state after each step.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tailorbird_solver::step::Report;
use tracing::warn;

use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
};

/// A cloth was put back to an earlier state.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothReset {
    /// The cloth.
    pub entity: Entity,
    /// Why.
    pub reason: ClothResetReason,
}

/// Why a cloth was put back to an earlier state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[non_exhaustive]
pub enum ClothResetReason {
    /// A position became infinite or NaN; the cloth is back at the start of the step, without velocity.
    NonFinite,
}

/// Puts a cloth whose state is not finite back to the start of the step.
pub fn guard_finite(
    step: Res<ClothStep>,
    mut cloths: Query<ClothStages, With<Cloth>>,
    commands: ParallelCommands,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.guard(step.level(), &commands);
    });
}

impl ClothStagesItem<'_, '_> {
    /// Runs [`guard_finite`] for one cloth.
    pub(crate) fn guard(&mut self, level: Level, commands: &ParallelCommands) {
        let Report {
            strained,
            stretched,
            non_finite,
        } = Report::of(level, &self.particles);
        let entity = self.entity;
        let known = [self.status.strained(), self.status.stretched()];
        // It changes in each step, and counts as changed when it begins and ends.
        if known.map(|part| part > 0.0) != [strained, stretched].map(|part| part > 0.0) {
            self.status.set_changed();
        }
        let status = self.status.bypass_change_detection();
        status.note_stretched(stretched);
        if strained != status.strained() && status.note_strained(strained) {
            let percent = strained * 100.0;
            warn!(
                "{entity}: {percent:.0} % of the edges are longer than the fabric lets them be: holds or colliders ask for more"
            );
        }
        let Some(particle) = non_finite else {
            return;
        };
        let particle = self.particles.order.given(particle).index();
        self.particles.0.reset_to_step_start();
        let (entity, status) = (self.entity, &mut self.status);
        let error = ClothErrorKind::NonFiniteState { particle };
        if status.is_ok_for(ClothErrorSource::State) {
            ClothStatus::update(status, entity, commands, ClothErrorSource::State, [error]);
        }
        commands.command_scope(|mut commands| {
            commands.trigger(ClothReset {
                entity,
                reason: ClothResetReason::NonFinite,
            });
        });
    }
}
