//! Checks: of shapes when they are built, of the state after each step.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec3};
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tracing::warn;

use crate::{
    cloth::{Cloth, ClothShape},
    error::{ClothErrorKind, ClothStatus, ErrorSource},
    solver::kernels::range::are_finite,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
};

/// A cloth was put back to an earlier state.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothReset {
    /// The cloth.
    pub entity: Entity,
    /// Why.
    pub reason: ResetReason,
}

/// Why a cloth was put back to an earlier state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[non_exhaustive]
pub enum ResetReason {
    /// A position became infinite or NaN; the cloth is back at the start of the step, without velocity.
    NonFinite,
}

/// What is wrong with a shape, without building it.
pub(crate) fn check_shape(shape: &ClothShape) -> Result<(), ClothErrorKind> {
    /// The most particles of a grid: as many as f32 counts exactly.
    const MOST_PARTICLES: u64 = 1 << 24;
    match shape {
        ClothShape::Grid {
            size,
            resolution,
            origin,
        } => {
            if !size.is_finite() || size.min_element() <= 0.0 {
                return Err(ClothErrorKind::Size { value: *size });
            }
            let particles = u64::from(resolution.x) * u64::from(resolution.y);
            if resolution.cmplt(UVec2::splat(2)).any() || particles > MOST_PARTICLES {
                return Err(ClothErrorKind::Resolution { value: *resolution });
            }
            match ClothErrorKind::vector("Cloth grid origin", origin.extend(0.0)) {
                Some(error) => Err(error),
                None => Ok(()),
            }
        }
        ClothShape::Mesh {
            positions,
            indices,
            weld_distance,
        } => {
            if let Some(error) = ClothErrorKind::number(
                "Cloth mesh weld_distance",
                *weld_distance,
                |d| d >= 0.0 && d.is_finite(),
                "at least 0 and finite [m]",
            ) {
                return Err(error);
            }
            check_positions(positions.iter().copied())?;
            if indices.len() % 3 != 0 {
                return Err(ClothErrorKind::IndexCount {
                    value: indices.len(),
                });
            }
            let vertices = positions.len();
            if let Some((at, value)) = indices
                .iter()
                .enumerate()
                .find(|(_, i)| **i as usize >= vertices)
            {
                return Err(ClothErrorKind::IndexOutOfRange {
                    at,
                    value: *value,
                    vertices,
                });
            }
            if indices.is_empty() {
                return Err(ClothErrorKind::NoTriangles {
                    vertices,
                    triangles: 0,
                });
            }
            Ok(())
        }
    }
}

/// What is wrong with the vertices of a mesh.
pub(crate) fn check_positions(positions: impl Iterator<Item = Vec3>) -> Result<(), ClothErrorKind> {
    /// The farthest from the origin \[m\] in any direction: f32 counts in steps of 6 cm there.
    const FARTHEST: f32 = 1e6;
    for (vertex, value) in positions.enumerate() {
        if !value.is_finite() {
            return Err(ClothErrorKind::NonFinitePosition { vertex, value });
        }
        if value.abs().max_element() > FARTHEST {
            return Err(ClothErrorKind::PositionTooFar { vertex, value });
        }
    }
    Ok(())
}

/// Puts a cloth whose state is not finite back to the start of the step.
pub fn guard_finite(
    step: Res<ClothStep>,
    mut cloths: Query<ClothStages, With<Cloth>>,
    commands: ParallelCommands,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.guard(&commands);
    });
}

impl ClothStagesItem<'_, '_> {
    /// What [`guard_finite`] does for one cloth.
    pub(crate) fn guard(&mut self, commands: &ParallelCommands) {
        let particles = &*self.particles;
        let strained = particles.effort.unmet();
        let entity = self.entity;
        let stretched = particles.effort.stretched();
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
        let all = [&particles.position, &particles.previous_position];
        if all
            .into_iter()
            .all(|points| are_finite(Level::new(), points))
        {
            return;
        }
        let particle = particles
            .positions()
            .position(|p| !p.is_finite())
            .unwrap_or_default();
        self.particles.reset_to_step_start();
        let (entity, status) = (self.entity, &mut self.status);
        let error = ClothErrorKind::NonFiniteState { particle };
        if status.is_ok_for(ErrorSource::State) {
            ClothStatus::update(status, entity, commands, ErrorSource::State, [error]);
        }
        commands.command_scope(|mut commands| {
            commands.trigger(ClothReset {
                entity,
                reason: ResetReason::NonFinite,
            });
        });
    }
}
