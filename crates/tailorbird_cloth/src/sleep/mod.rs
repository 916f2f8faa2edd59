//! Cloth at rest settles and then sleeps: it costs nothing until something happens to it.
//!
#![doc = include_str!("README.md")]

mod rest;
mod unseen;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

pub use rest::{rest_cloths, settle_cloths, wake_cloths};
pub use unseen::{carry_unseen, rest_unseen};

use crate::error::ClothErrorKind;

/// Conditions for a cloth to fall asleep: it has been at rest for some time. A cloth is at rest if the mean positions of blocks of 16
/// particles side by side differ from their averages over the last quarter of a second by no more than [`speed`](Self::speed) times that
/// (root mean square), and none by five times as much: a drifting or swinging cloth is not at rest, one that trembles on the spot is.
///
/// A cloth that has been at rest for half a second settles: friction within the fabric takes the rest of its motion, within half a second
/// more, as long as nothing happens that would wake it.
///
/// A sleeping cloth stays as it is and costs nothing. It wakes when a pin, the grab, the material, the solver, its shape, its transform,
/// its shading, its sleep settings, gravity, the substeps or the wind change, when a force is added, when a collider moves, appears or
/// disappears where the cloth lies, and when the target of an attachment or of a motion constraint has moved by 0.1 mm. [`ClothSleepState::wake`]
/// wakes it by hand.
///
/// With [`unseen`](Self::unseen) it also sleeps while nobody sees it, whatever happens to it: see there.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothSleep {
    /// True if the cloth falls asleep when it is at rest.
    pub enabled: bool,
    /// Speed below which a cloth is at rest [m/s]; with 0, nothing settles either.
    pub speed: f32,
    /// Time that the cloth has to be at rest \[s\]; at least half a second.
    pub seconds: f32,
    /// True if the cloth sleeps while [`ClothSeen`] says that nobody sees it or its shadow; not by default.
    ///
    /// It then moves rigidly with its entity, or with the first of its attachments if those alone hold it. Holders, bodies, colliders, wind
    /// and forces are ignored, and bodies are not pushed. Seen again, it goes on in the shape that it had, at the velocity of its carrier.
    /// It costs nothing if its holders do not move, and next to nothing otherwise. A cloth with
    /// [`ClothMotionTargets`](crate::motion::ClothMotionTargets) stays awake.
    pub unseen: bool,
}

impl Default for ClothSleep {
    fn default() -> Self {
        Self {
            enabled: true,
            speed: 0.01,
            seconds: 1.0,
            unseen: false,
        }
    }
}

impl ClothSleep {
    /// A cloth that is always awake, seen or not. It settles all the same.
    pub fn never() -> Self {
        Self {
            enabled: false,
            ..Self::default()
        }
    }

    /// Errors in these settings.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let checks = [
            ClothErrorKind::not_negative("ClothSleep.speed", self.speed, "m/s"),
            ClothErrorKind::not_negative("ClothSleep.seconds", self.seconds, "s"),
        ];
        checks.into_iter().flatten().collect()
    }
}

/// True if somebody sees the cloth: its picture, or its shadow.
///
/// The code that draws cloth sets it: `tailorbird` does if Bevy draws it; without that, all cloths are seen. It has an effect if
/// [`ClothSleep::unseen`] is set.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothSeen(pub bool);

impl Default for ClothSeen {
    fn default() -> Self {
        Self(true)
    }
}

/// Sleep of a cloth that nobody sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
enum Unseen {
    /// The cloth is seen, or sleeps for other reasons alone.
    #[default]
    No,
    /// After this step it was seen no more.
    Since(u64),
    /// It sleeps unseen, but is to take one step.
    Touched(u64),
    /// The cloth is seen again in this step, or takes one.
    Back,
}

impl Unseen {
    /// State after something happened to the cloth.
    fn touched(self) -> Self {
        match self {
            Self::Since(step) => Self::Touched(step),
            same => same,
        }
    }
}

/// State of rest or sleep of a cloth. Written by [`rest_unseen`], [`wake_cloths`], [`settle_cloths`] and
/// [`rest_cloths`] alone, and by [`ClothSleepState::wake`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothSleepState {
    unseen: Unseen,
    seconds: f32,
    /// Step since which it sleeps.
    asleep: Option<u64>,
    /// Surroundings in which it settles or sleeps.
    #[reflect(ignore)]
    around: Option<Surroundings>,
    /// The fingerprint of its settings.
    settings: u64,
}

/// Influences on a cloth from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Surroundings {
    gravity: Vec3,
    substeps: Option<u32>,
    iterations: u32,
    air: u64,
    /// Hash of the colliders that touch the cloth's box.
    colliders: u64,
}

impl ClothSleepState {
    /// Time for which the cloth has been at rest \[s\].
    pub fn seconds(&self) -> f32 {
        self.seconds
    }

    /// Returns whether the cloth sleeps.
    pub fn is_asleep(&self) -> bool {
        self.asleep.is_some() || self.is_unseen()
    }

    /// Returns whether the cloth sleeps because nobody sees it.
    pub fn is_unseen(&self) -> bool {
        matches!(self.unseen, Unseen::Since(_) | Unseen::Touched(_))
    }

    /// The step after which the cloth fell asleep, where it sleeps.
    pub fn asleep_since(&self) -> Option<u64> {
        match self.unseen {
            Unseen::Since(step) | Unseen::Touched(step) => Some(step),
            _ => self.asleep,
        }
    }

    /// Wakes the cloth, and makes it wait again before it falls asleep. One that nobody sees takes one step and
    /// sleeps on.
    pub fn wake(&mut self) {
        *self = Self {
            unseen: self.unseen.touched(),
            settings: self.settings,
            ..Self::default()
        };
    }

    fn awake(&self) -> Self {
        Self {
            unseen: self.unseen,
            settings: self.settings,
            ..Self::default()
        }
    }
}
