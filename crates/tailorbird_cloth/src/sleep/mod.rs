//! Cloth at rest settles and then sleeps: it costs nothing until something happens to it.
//!
#![doc = include_str!("README.md")]

mod unseen;

use std::hash::{DefaultHasher, Hash, Hasher};

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_reflect::prelude::*;

pub use unseen::{ClothSeen, carry_unseen, rest_unseen};

use crate::{
    attachment::AttachedParticles,
    bounds::ClothBounds,
    cloth::Cloth,
    collider::{ClothColliders, ClothLayers},
    error::{ClothErrorKind, ClothStatus, ErrorSource},
    forces::ClothForces,
    frame::ClothFrame,
    grab::ClothGrab,
    material::ClothMaterial,
    motion::MotionState,
    normals::ClothShading,
    pins::ClothPins,
    solver::ClothSolver,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
    topology::ClothTopology,
    wind::BlowingWind,
};
use unseen::Unseen;

/// Conditions for a cloth to fall asleep: it has been at rest for some time. A cloth is at rest if the mean positions of blocks of 16
/// particles side by side differ from their averages over the last quarter of a second by no more than [`speed`](Self::speed) times that
/// (root mean square), and none by five times as much: a drifting or swinging cloth is not at rest, one that trembles on the spot is.
///
/// A cloth that has been at rest for half a second settles: friction within the fabric takes the rest of its motion, within half a second
/// more, as long as nothing happens that would wake it.
///
/// A sleeping cloth stays as it is and costs nothing. It wakes when a pin, the grab, the material, the solver, its shape, its transform,
/// its shading, its sleep settings, gravity, the substeps or the wind change, when a force is added, when a collider moves, appears or
/// disappears where the cloth lies, and when the target of an attachment or of a motion constraint has moved by 0.1 mm. [`ClothRest::wake`]
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
        let not_negative = |v: f32| v >= 0.0 && v.is_finite();
        let check = |field, value, allowed| {
            ClothErrorKind::number(field, value, not_negative, allowed).into_iter()
        };
        check(
            "ClothSleep.speed",
            self.speed,
            "at least 0 and finite [m/s]",
        )
        .chain(check(
            "ClothSleep.seconds",
            self.seconds,
            "at least 0 and finite [s]",
        ))
        .collect()
    }
}

/// State of rest and sleep of a cloth. Written by [`rest_unseen`], [`wake_cloths`], [`settle_cloths`] and [`rest_cloths`] alone, and by
/// [`ClothRest::wake`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothRest {
    unseen: Unseen,
    seconds: f32,
    /// Step since which it sleeps.
    asleep: Option<u64>,
    /// Surroundings in which it settles or sleeps.
    #[reflect(ignore)]
    around: Option<Surroundings>,
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

impl ClothRest {
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
            ..Self::default()
        };
    }

    fn awake(&self) -> Self {
        Self {
            unseen: self.unseen,
            ..Self::default()
        }
    }
}

/// After this time at rest a cloth begins to settle \[s\].
const CALM: f32 = 0.5;

/// After this time at rest it has settled \[s\].
const SETTLED: f32 = 1.0;

/// The part of its motion in a step that a settled cloth keeps: the rest is friction within the fabric.
const KEPT: f32 = 0.02;

/// A cloth wakes that is put elsewhere and turned by more \[rad\].
const TURN: f32 = 1e-3;

/// Room around a cloth in which a collider wakes it \[m\].
const ROOM: f32 = 0.02;

fn around(
    step: &ClothStep,
    wind: &BlowingWind,
    colliders: &ClothColliders,
    (frame, bounds): (&ClothFrame, &ClothBounds),
    layers: Option<&ClothLayers>,
    material: &ClothMaterial,
) -> Surroundings {
    let mut hasher = DefaultHasher::new();
    let room = ROOM + material.margin().max(0.0);
    for collider in colliders.list.near(
        frame,
        bounds.bounds(),
        layers.copied().unwrap_or_default().layers(),
        room,
    ) {
        collider.hash(&mut hasher);
    }
    Surroundings {
        gravity: step.gravity(),
        substeps: step.fixed_substeps,
        iterations: step.iterations(),
        air: wind.kind(frame, bounds),
        colliders: hasher.finish(),
    }
}

/// Wakes the cloths to which something happened since they fell asleep.
pub fn wake_cloths(
    step: Res<ClothStep>,
    wind: Res<BlowingWind>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<
        (
            Entity,
            &mut ClothRest,
            (
                Ref<ClothSleep>,
                Ref<ClothPins>,
                Ref<ClothMaterial>,
                Ref<ClothSolver>,
                Ref<ClothTopology>,
                Ref<ClothShading>,
            ),
            (
                &ClothGrab,
                &ClothForces,
                &AttachedParticles,
                Option<&MotionState>,
            ),
            (&ClothFrame, &ClothBounds, Option<&ClothLayers>),
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (entity, mut rest, settings, acting, (frame, bounds, layers), mut status) in &mut cloths {
        let (grab, forces, attached, motion) = acting;
        let (sleep, pins, material, solver, topology, shading) = settings;
        if sleep.is_changed() {
            let errors = sleep.errors();
            ClothStatus::update(&mut status, entity, &commands, ErrorSource::Sleep, errors);
        }
        if rest.is_unseen() {
            continue;
        }
        let changed = sleep.is_changed()
            || pins.is_changed()
            || material.is_changed()
            || solver.is_changed()
            || topology.is_changed()
            || shading.is_changed();
        // What hangs straight does not, turned; what is put elsewhere as it is sleeps on.
        let turned = |turn: Quat| turn.angle_between(Quat::IDENTITY) > TURN;
        let pulled = grab.particle().is_some()
            || !forces.is_empty()
            || frame.is_moving()
            || frame.jump_turn().is_some_and(turned)
            || attached.is_disturbed()
            || motion.is_some_and(MotionState::is_disturbed);
        let other = |known: Surroundings| {
            known != around(&step, &wind, &colliders, (frame, bounds), layers, &material)
        };
        let disturbed = changed || pulled || rest.around.is_some_and(other);
        if disturbed {
            let awake = rest.awake();
            rest.set_if_neq(awake);
        }
    }
}

/// Measures how long the cloths have been at rest, and lets them settle.
pub fn settle_cloths(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.settle(&step, &colliders);
    });
}

/// Lets the cloths fall asleep that have been at rest for long enough.
pub fn rest_cloths(
    step: Res<ClothStep>,
    wind: Res<BlowingWind>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        cloth.rest(&step, &wind, &colliders);
    });
}

impl ClothStagesItem<'_, '_> {
    /// Runs [`settle_cloths`] for one cloth.
    pub(crate) fn settle(&mut self, step: &ClothStep, colliders: &ClothColliders) {
        if self.particles.is_empty() || !self.sleep.errors().is_empty() {
            return;
        }
        let seconds = step.seconds();
        let carries = self
            .particles
            .0
            .scratch
            .cache
            .bodies
            .pushed(&colliders.list);
        let still = self.particles.0.is_at_rest(self.sleep.speed, seconds);
        let led = self.attached.is_led() || self.motion.is_some_and(MotionState::is_led);
        // What has begun to settle is left to it until something happens: knots tug at themselves all the time.
        if carries || led || !(still || self.rest.around.is_some()) {
            let awake = self.rest.awake();
            self.rest.set_if_neq(awake);
            return;
        }
        self.rest.seconds += seconds;
        self.particles.0.slow_down(part_kept(self.rest.seconds));
    }

    /// Runs [`rest_cloths`] for one cloth.
    pub(crate) fn rest(
        &mut self,
        step: &ClothStep,
        wind: &BlowingWind,
        colliders: &ClothColliders,
    ) {
        if self.rest.seconds < CALM {
            return;
        }
        let place = (&*self.frame, &*self.bounds);
        self.rest.around = Some(around(
            step,
            wind,
            colliders,
            place,
            self.layers,
            self.material,
        ));
        if self.sleep.enabled && self.rest.seconds >= self.sleep.seconds {
            self.particles.0.stop();
            self.rest.asleep = Some(step.steps());
        }
    }
}

/// The part of its motion in a step that a cloth keeps which has been at rest for so long \[s\].
fn part_kept(seconds: f32) -> f32 {
    let x = (seconds - CALM) / (SETTLED - CALM);
    1.0 - x.clamp(0.0, 1.0) * (1.0 - KEPT)
}
