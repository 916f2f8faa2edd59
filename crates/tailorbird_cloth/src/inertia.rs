//! Inertia of a cloth: the part of its entity's motion that it feels.
//!
//! ![A cape on somebody who runs and jumps](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/cape.gif)
//!
//! Pins move with the entity, and free particles keep their place in the world: that is physics, and the default. A cape on
//! a character that sprints, snaps round and is moved by its game as no body moves looks better with less of it. What a cloth
//! does not feel carries it along, as if it and its entity stood still:
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::prelude::*;
//! # use tailorbird_cloth::prelude::*;
//! # fn spawn(mut commands: Commands) {
//! commands.spawn((
//!     Cloth::grid(Vec2::new(0.8, 1.2), UVec2::new(32, 48)),
//!     ClothPins::edges([ClothEdge::Top]),
//!     ClothInertia {
//!         // Half of the displacement and of the turns, and nothing beyond a fast run.
//!         linear: 0.5,
//!         angular: 0.5,
//!         max_speed: 8.0,
//!         ..ClothInertia::default()
//!     },
//! ));
//! # }
//! ```
//!
//! An entity that is put elsewhere takes its cloth along: where it [hops](crate::sampling#hops), or where the game says so.
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::prelude::*;
//! # use bevy_transform::prelude::*;
//! # use tailorbird_cloth::prelude::*;
//! fn respawn(mut capes: Query<(&mut Transform, &mut ClothFrame)>) {
//!     for (mut transform, mut frame) in &mut capes {
//!         transform.translation = Vec3::ZERO;
//!         frame.teleport(ClothTeleportMode::Reset);
//!     }
//! }
//! ```

mod reset;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use tailorbird_solver::frame::{Felt, shortest};

pub use reset::reset_teleported;

use crate::error::ClothErrorKind;

/// The part of its entity's motion that a cloth feels, and the bounds of a teleport. Change it at any time.
///
/// The motion of the cloth's own entity counts, and of its parents; that of an entity to which the cloth is merely attached does not.
///
/// Motion that is not felt carries the cloth along without giving it velocity; wind and colliders then act on it as they would if the
/// entity stood still.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothInertia {
    /// Part of the entity's displacement that is felt, 0 to 1 [-]. 0 is a cloth that does not notice that its entity moves.
    pub linear: f32,
    /// Part of the entity's turning that is felt, 0 to 1 [-].
    pub angular: f32,
    /// Part of the centrifugal acceleration of the turning that is *not* felt that acts all the same [-], so that a skirt
    /// rises in a turn that carries it along. At least 0; 1 is physics.
    pub centrifugal: f32,
    /// Largest speed of the entity that the cloth feels [m/s]; the excess is not felt.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub max_speed: f32,
    /// Largest angular speed of the entity that the cloth feels [rad/s]; the excess is not felt.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub max_angular_speed: f32,
    /// An entity that moves faster than this [m/s] within one step is taken to be put elsewhere, however fast it moved before; beside what
    /// [`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed) sees. Infinite by default.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub teleport_speed: f32,
    /// An entity that turns by more than this in one step \[rad\] is taken to be put elsewhere. No turn is larger than π.
    #[cfg_attr(
        feature = "serialize",
        serde(deserialize_with = "crate::unbounded::number")
    )]
    pub teleport_angle: f32,
    /// Treatment of the cloth on a teleport.
    pub teleport: ClothTeleportMode,
}

/// Treatment of a cloth whose entity is put elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothTeleportMode {
    /// The cloth is carried along as it is, and its velocity turns with it.
    #[default]
    KeepShape,
    /// The cloth is put into its rest shape, without velocity; pins hold where they hold.
    Reset,
}

/// A cloth was put elsewhere, with its entity or what holds it: because its [`ClothInertia`] says so of a motion like that, by a hop
/// ([`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed)), or by
/// [`ClothFrame::teleport`](crate::frame::ClothFrame::teleport).
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothTeleported {
    /// The cloth.
    pub entity: Entity,
    /// Treatment of the cloth.
    pub mode: ClothTeleportMode,
}

impl Default for ClothInertia {
    /// Feels all of the motion, without limits but that of [`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed).
    fn default() -> Self {
        Self {
            linear: 1.0,
            angular: 1.0,
            centrifugal: 1.0,
            max_speed: f32::INFINITY,
            max_angular_speed: f32::INFINITY,
            teleport_speed: f32::INFINITY,
            teleport_angle: f32::INFINITY,
            teleport: ClothTeleportMode::KeepShape,
        }
    }
}

impl ClothInertia {
    /// A cloth that does not notice that its entity moves.
    pub fn none() -> Self {
        Self {
            linear: 0.0,
            angular: 0.0,
            centrifugal: 0.0,
            ..Self::default()
        }
    }

    /// Errors in these values.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let part = |field: &str, value| {
            let field = format!("ClothInertia.{field}");
            ClothErrorKind::number(&field, value, |v| (0.0..=1.0).contains(&v), "0 to 1 [-]")
        };
        let limit = |field: &str, value, unit| {
            let field = format!("ClothInertia.{field}");
            // Infinity is no limit.
            ClothErrorKind::number(&field, value, |v| v >= 0.0, unit)
        };
        [
            part("linear", self.linear),
            part("angular", self.angular),
            ClothErrorKind::number(
                "ClothInertia.centrifugal",
                self.centrifugal,
                |v| v >= 0.0 && v.is_finite(),
                "at least 0 and finite [-]",
            ),
            limit("max_speed", self.max_speed, "at least 0 [m/s]"),
            limit(
                "max_angular_speed",
                self.max_angular_speed,
                "at least 0 [rad/s]",
            ),
            limit("teleport_speed", self.teleport_speed, "at least 0 [m/s]"),
            limit("teleport_angle", self.teleport_angle, "at least 0 [rad]"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Returns whether an entity that goes from one place to another in a step of this length \[s\] is put elsewhere.
    pub(crate) fn is_teleport(&self, from: Isometry3d, to: Isometry3d, seconds: f32) -> bool {
        let distance = from.translation.distance(to.translation);
        distance > self.teleport_speed * seconds
            || from.rotation.angle_between(to.rotation) > self.teleport_angle
    }

    /// Part of a motion that is felt, in a step of this length \[s\] for the world and for the cloth.
    pub(crate) fn felt(
        &self,
        from: Isometry3d,
        to: Isometry3d,
        world_seconds: f32,
        seconds: f32,
    ) -> Felt {
        let part = |felt: f32, moved: f32, most: f32| {
            if moved * felt > most * world_seconds {
                most * world_seconds / moved
            } else {
                felt
            }
        };
        let distance = from.translation.distance(to.translation);
        let axis = shortest(to.rotation * from.rotation.inverse()).to_scaled_axis();
        let angular = part(self.angular, axis.length(), self.max_angular_speed);
        let carried = if seconds > 0.0 {
            (1.0 - angular) / seconds * axis
        } else {
            Vec3::ZERO
        };
        Felt {
            linear: part(self.linear, distance, self.max_speed),
            angular,
            spin: self.centrifugal.sqrt() * carried,
        }
    }
}
