//! Particles that are held by another entity: a hand, a flagpole, a bone of an animated skeleton.
//!
//! An attachment is an entity of its own. It belongs to a cloth ([`ClothAttachmentOf`], listed in [`ClothAttachments`]), is held by
//! any entity that has a `Transform` ([`ClothAttachedTo`], listed in [`ClothAttachmentsHeld`]), and says what it holds
//! ([`ClothAttachment`]):
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{UVec2, Vec2, Vec3};
//! # use bevy_transform::components::Transform;
//! # use tailorbird_cloth::prelude::*;
//! fn spawn_flag(mut commands: Commands) {
//!     let pole = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
//!     commands.spawn((
//!         Cloth::grid(Vec2::new(1.5, 1.0), UVec2::new(48, 32)),
//!         Transform::from_xyz(0.0, 2.0, 0.0),
//!         related!(ClothAttachments[ClothAttachment::edge(ClothEdge::Left).to(pole)]),
//!     ));
//! }
//! ```
//!
//! The particles keep the place that they have relative to the entity when they are attached, or go to given points of it:
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::Vec3;
//! # use tailorbird_cloth::prelude::*;
//! fn clip_on(mut commands: Commands, cloth: Entity, hand: Entity) {
//!     let clip = ClothAttachment::corner(ClothCorner::TopLeft)
//!         .with_points([Vec3::new(0.0, 0.05, 0.0)])
//!         .with_break_force(30.0);
//!     commands.spawn((clip.to(hand), ClothAttachmentOf(cloth)));
//! }
//!
//! fn on_break(broken: On<ClothAttachmentBroken>) {
//!     println!("{} lost its hold at {} N", broken.entity, broken.force.length());
//! }
//! ```
//!
//! An attachment holds **rigidly** unless it has a compliance or a break force: then its particles are kinematic, as those of
//! pins are. They move from their positions at the start of a step to the entity's at its end, evenly over the
//! substeps: along a straight line if it moves, along an arc if it turns. If it does not move they have no
//! velocity. If all holders of a cloth [hop](crate::sampling#hops), or moved while cloth did not simulate, the whole cloth is carried
//! along, with the motion that it has ([`ClothTeleported`](crate::inertia::ClothTeleported) tells of hops). A particle that is not at the
//! point that holds it, for example if one of two hands hops, goes there at up to 30 m/s.
//!
//! An attachment with a **compliance** α is a spring of zero length from each particle to its point: they carry F for a gap of α F
//! together, whatever the number of particles. It is solved together with the lines, so that it adds no stretch. An attachment with a
//! **break force** is a spring as stiff as it can be measured: at the break force it gives way by [`ClothAttachment::GIVE`].
//!
//! [`ClothAttachmentForce`] has the force that it carries, a mean over the step. If the force exceeds the break force, or the entity that
//! holds it is despawned, the attachment is despawned and [`ClothAttachmentBroken`] triggered for the cloth; the particles fly
//! on with the velocity that they have. A cloth takes its attachments with it when it is despawned.
//!
//! If several holders have the same particle, a pin ([`ClothPins`](crate::pins::ClothPins)) counts before an attachment, a rigid
//! attachment before a motion constraint and before the player's hand, a later attachment of [`ClothAttachments`] before an
//! earlier one. Springs add up.

mod carry;
mod held;
mod pose;
mod prepare;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::{pose::Pose, topology::order::Given};

pub use held::{ClothAttachedParticles, HeldPoint};
pub use prepare::{break_attachments, prepare_attachments};

use crate::{
    error::{ClothErrorKind, ClothStatus},
    pins::{ClothCorner, ClothEdge, ClothSelection},
    sampling::ClothSampledMotion,
};

/// Holds particles of a cloth at an entity. Needs [`ClothAttachmentOf`] and [`ClothAttachedTo`]. See the [module](self).
///
/// Change it at any time. A value that is wrong is reported in the [`ClothStatus`] of this entity, and the last valid ones
/// stay in force.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
#[require(ClothAttachmentState, ClothAttachmentForce, ClothStatus)]
pub struct ClothAttachment {
    /// Selections of particles. A wrong selection is reported and left out.
    pub selections: Vec<ClothSelection>,
    /// Points of the entity at which the particles are held.
    pub offset: ClothAttachmentOffset,
    /// Compliance of the whole attachment [m/N]; 0, the default, is rigid.
    pub compliance: f32,
    /// Largest force that it carries, as a mean over a step \[N\]. `None`, the default: any force.
    pub break_force: Option<f32>,
}

/// Points of an entity at which an attachment holds its particles.
#[derive(Clone, Debug, Default, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[non_exhaustive]
pub enum ClothAttachmentOffset {
    /// Positions of the particles, relative to the entity, when they are attached (at rest, for a new cloth).
    #[default]
    Keep,
    /// Points of the entity's own space \[m\]: one for each particle, in the order of the selections, or one for all. Particles
    /// move there within one step, evenly over the substeps; particles further away than half a metre at 30 m/s.
    Points(Vec<Vec3>),
}

/// The cloth that an attachment belongs to.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[relationship(relationship_target = ClothAttachments)]
pub struct ClothAttachmentOf(pub Entity);

/// The attachments of a cloth. They are despawned with it.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[relationship_target(relationship = ClothAttachmentOf, linked_spawn)]
pub struct ClothAttachments(Vec<Entity>);

/// The entity that holds an attachment. It needs a `Transform`; its parents and its scale count.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[relationship(relationship_target = ClothAttachmentsHeld)]
pub struct ClothAttachedTo(pub Entity);

/// The attachments that an entity holds. They break when it is despawned.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[relationship_target(relationship = ClothAttachedTo)]
#[require(ClothSampledMotion)]
pub struct ClothAttachmentsHeld(Vec<Entity>);

/// Force of the cloth on the target of an attachment that has a compliance or a break force; 0 for a rigid one, whose part in
/// [`ClothPinForces`](crate::reaction::ClothPinForces) is not told apart.
///
/// Written by [`break_attachments`] alone.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothAttachmentForce {
    /// Sum over its particles, mean over the last step, in world axes \[N\].
    pub force: Vec3,
}

/// Event for the end of an attachment: it was pulled too hard, or its target was despawned. Triggered for the cloth.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Reflect)]
pub struct ClothAttachmentBroken {
    /// The cloth.
    pub entity: Entity,
    /// The attachment; it is despawned after its observers have run.
    pub attachment: Entity,
    /// Entity that held the particles. May be despawned: see `reason`.
    pub target: Entity,
    /// Force that the attachment carried in the last step, in world axes \[N\]; 0 for a rigid one.
    pub force: Vec3,
    /// Reason.
    pub reason: ClothBreakReason,
}

/// Reason why an attachment broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[non_exhaustive]
pub enum ClothBreakReason {
    /// The attachment carried more than [`ClothAttachment::break_force`].
    Force,
    /// The entity that held it was despawned, or [`ClothAttachedTo`] was removed.
    TargetGone,
}

impl ClothAttachment {
    /// Gap of an attachment without compliance at its break force \[m\].
    pub const GIVE: f32 = 2e-5;

    /// Holds particles rigidly where they are.
    pub fn new(selection: ClothSelection) -> Self {
        Self {
            selections: vec![selection],
            ..Self::default()
        }
    }

    /// Holds a corner of a grid.
    pub fn corner(corner: ClothCorner) -> Self {
        Self::new(ClothSelection::Corner(corner))
    }

    /// Holds an edge of a grid.
    pub fn edge(edge: ClothEdge) -> Self {
        Self::new(ClothSelection::Edge(edge))
    }

    /// Holds particles by index.
    pub fn particles(particles: impl IntoIterator<Item = u32>) -> Self {
        Self {
            selections: particles
                .into_iter()
                .map(ClothSelection::Particle)
                .collect(),
            ..Self::default()
        }
    }

    /// Holds every particle that lies within a ball (in the cloth's frame \[m\]) at rest.
    pub fn within(center: Vec3, radius: f32) -> Self {
        Self::new(ClothSelection::Within { center, radius })
    }

    /// Sets points of the entity's own space \[m\]: one for each particle, or one for all.
    pub fn with_points(self, points: impl IntoIterator<Item = Vec3>) -> Self {
        let offset = ClothAttachmentOffset::Points(points.into_iter().collect());
        Self { offset, ..self }
    }

    /// Sets the compliance [m/N].
    pub fn with_compliance(self, compliance: f32) -> Self {
        Self { compliance, ..self }
    }

    /// Breaks above this force \[N\].
    pub fn with_break_force(self, newtons: f32) -> Self {
        Self {
            break_force: Some(newtons),
            ..self
        }
    }

    /// Bundle of the attachment and the entity that holds it.
    pub fn to(self, target: Entity) -> (Self, ClothAttachedTo) {
        (self, ClothAttachedTo(target))
    }

    /// Errors in the values. Errors in the selections depend on the cloth.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let compliance = ClothErrorKind::number(
            "ClothAttachment.compliance",
            self.compliance,
            |c| c >= 0.0 && c.is_finite(),
            "at least 0 and finite [m/N]",
        );
        let break_force = self.break_force.and_then(|force| {
            ClothErrorKind::number(
                "ClothAttachment.break_force",
                force,
                |f| f > 0.0 && f.is_finite(),
                "above 0 and finite [N]",
            )
        });
        let points = match &self.offset {
            ClothAttachmentOffset::Keep => None,
            ClothAttachmentOffset::Points(points) => points
                .iter()
                .find_map(|p| ClothErrorKind::vector("ClothAttachment.offset", *p)),
        };
        [compliance, break_force, points]
            .into_iter()
            .flatten()
            .collect()
    }

    /// The compliance of the whole, that of [`Self::GIVE`] included [m/N].
    fn give(&self) -> f32 {
        let least = self.break_force.map_or(0.0, |force| Self::GIVE / force);
        self.compliance.max(least)
    }
}

/// Particles and target of an attachment, found when it or the cloth changes. Written by [`prepare_attachments`] alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothAttachmentState {
    /// The last values that were valid.
    valid: Option<ClothAttachment>,
    /// Particles, and their points in the target's own space \[m\]. A cloth that grows may be stored in another order.
    #[reflect(ignore)]
    points: Vec<(Given, Vec3)>,
    /// Compliance of each particle [m/N]; `None` for a rigid attachment.
    compliances: Option<Vec<f32>>,
    target: Option<Entity>,
    /// Pose of the target at the end of the step before; of a sleeping cloth, when it fell asleep.
    #[reflect(ignore)]
    pose: Option<Pose>,
    /// Pose of the target when it was last seen.
    #[reflect(ignore)]
    seen: Option<Pose>,
    /// Velocity of the target in the last step, as far as it was felt [m/s].
    velocity: Vec3,
    /// The scale of the cloth that the points were found for.
    scale: Vec3,
    /// Number of particles of that topology.
    particles: usize,
    /// Revision of the topology.
    #[reflect(ignore)]
    revision: u64,
    /// True if the particles are still to be found.
    stale: bool,
    /// Errors in the selections and points.
    #[reflect(ignore)]
    wrong: Vec<ClothErrorKind>,
}
