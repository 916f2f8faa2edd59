//! Present errors of an entity.

use bevy_ecs::{prelude::*, query::QueryData};
use bevy_reflect::prelude::*;
use tracing::error;

use super::{ClothError, ClothErrorKind};

/// Check that an error came from; a check replaces its own errors alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub enum ClothErrorSource {
    /// The mesh that a cloth is to be made of.
    Mesh,
    /// The rest shape.
    Shape,
    /// [`ClothMaterial`](crate::material::ClothMaterial).
    Material,
    /// [`ClothPins`](crate::pins::ClothPins).
    Pins,
    /// [`ClothGrab`](crate::grab::ClothGrab).
    Grab,
    /// [`ClothAttachment`](crate::attachment::ClothAttachment).
    Attachment,
    /// [`ClothMotionConstraints`](crate::motion::ClothMotionConstraints).
    Motion,
    /// [`ClothMotionTargets`](crate::motion::ClothMotionTargets).
    MotionTargets,
    /// The entity's place in the world.
    Transform,
    /// [`ClothCollider`](crate::collider::ClothCollider).
    Collider,
    /// [`ClothWindZone`](crate::wind::ClothWindZone).
    ClothWind,
    /// [`ClothForces`](crate::forces::ClothForces).
    Forces,
    /// [`ClothInertia`](crate::inertia::ClothInertia).
    Inertia,
    /// [`ClothSleep`](crate::sleep::ClothSleep).
    Sleep,
    /// [`ClothParticles`](crate::particles::ClothParticles).
    State,
}

/// Present errors of this cloth, collider or zone; empty when all is well. Beside them, and no error: the part of a cloth's edges that is
/// too long ([`strained`](Self::strained), [`stretched`](Self::stretched)), as of its last step awake; `Changed` sees each begin and end.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothStatus {
    entries: Vec<(ClothErrorSource, ClothErrorKind)>,
    strained: f32,
    stretched: f32,
}

impl ClothStatus {
    /// The errors that hold.
    pub fn errors(&self) -> impl Iterator<Item = &ClothErrorKind> {
        self.entries.iter().map(|(_, kind)| kind)
    }

    /// Returns whether there are no errors.
    pub fn is_ok(&self) -> bool {
        self.entries.is_empty()
    }

    /// Part of a cloth's edges that is longer than its fabric allows [-], while it is asked for more than the fabric has: posts that stand
    /// too far apart, a body within it. 0 otherwise, and for the first moment. It is logged when it begins.
    ///
    /// It begins when 5 % of the edges are longer by 3 %, or one is twice as long as at rest, for half a second if something touches the
    /// cloth and for a second if nothing does; it ends when fewer than 1 % are (3 % of a sheet that is strained in one place alone). Air,
    /// forces and motion of more than 5 m/s count as loads, not as demands: see [`stretched`](Self::stretched). If it lasts, look for the
    /// holders or bodies that cause it: [`ClothAttachmentForce`](crate::attachment::ClothAttachmentForce) and
    /// [`ClothPinForces`](crate::reaction::ClothPinForces) tell who pulls. The cloth is whole again when [`stretched`](Self::stretched) is
    /// 0 as well.
    pub fn strained(&self) -> f32 {
        self.strained
    }

    /// Part of a cloth's edges that is longer by 3 % than its fabric allows [-], while it is asked for no more than the fabric has: a
    /// storm, a snatch, more weight than its substeps bear, the rest of a demand. 0 below 0.5 %. In a storm it takes more substeps then,
    /// within [`most_substeps`](crate::settings::ClothSettings::most_substeps) and
    /// [`substep_budget`](crate::settings::ClothSettings::substep_budget): if it stays above, these are too few.
    pub fn stretched(&self) -> f32 {
        self.stretched
    }

    pub(crate) fn note_stretched(&mut self, stretched: f32) {
        self.stretched = stretched;
    }

    /// Notes which part is strained; whether it was not before.
    pub(crate) fn note_strained(&mut self, strained: f32) -> bool {
        let began = self.strained == 0.0 && strained > 0.0;
        self.strained = strained;
        began
    }

    /// Returns whether this check has found nothing.
    pub(crate) fn is_ok_for(&self, source: ClothErrorSource) -> bool {
        self.entries.iter().all(|(s, _)| *s != source)
    }

    /// Replaces what `source` found before by `found`; what is new is logged and triggered.
    ///
    /// Does not touch (and so does not mark as changed) a status that stays as it is.
    pub fn update(
        status: &mut Mut<Self>,
        entity: Entity,
        commands: &ParallelCommands,
        source: ClothErrorSource,
        found: impl IntoIterator<Item = ClothErrorKind>,
    ) {
        let mut found = found.into_iter().peekable();
        if found.peek().is_none() && status.is_ok_for(source) {
            return;
        }
        let found: Vec<_> = found.collect();
        // Compared as text, since NaN does not equal itself.
        let before: Vec<String> = status
            .entries
            .iter()
            .filter(|(s, _)| *s == source)
            .map(|(_, kind)| kind.to_string())
            .collect();
        let after: Vec<String> = found.iter().map(ToString::to_string).collect();
        if before == after {
            return;
        }
        status.entries.retain(|(s, _)| *s != source);
        for (kind, text) in found.into_iter().zip(after) {
            if !before.contains(&text) {
                error!("{entity}: {text}");
                let event = ClothError {
                    entity,
                    kind: kind.clone(),
                };
                commands.command_scope(|mut commands| commands.trigger(event));
            }
            status.entries.push((source, kind));
        }
    }
}

/// Status of an entity, in a query of what checks it.
#[derive(QueryData)]
#[query_data(mutable)]
pub struct ClothStatusOf {
    pub(crate) entity: Entity,
    pub(crate) list: &'static mut ClothStatus,
}

impl ClothStatusOfItem<'_, '_> {
    /// See [`ClothStatus::update`].
    pub(crate) fn update(
        &mut self,
        commands: &ParallelCommands,
        source: ClothErrorSource,
        found: impl IntoIterator<Item = ClothErrorKind>,
    ) {
        ClothStatus::update(&mut self.list, self.entity, commands, source, found);
    }
}
