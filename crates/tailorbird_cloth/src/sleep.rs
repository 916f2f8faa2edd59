//! Cloth at rest sleeps: it costs nothing until something happens to it.

use std::hash::{DefaultHasher, Hash, Hasher};

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

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
    particles::ClothParticles,
    pins::ClothPins,
    solver::ClothSolver,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
    topology::ClothTopology,
    wind::{BlowingWind, WindModel},
};

/// When a cloth falls asleep: after it has been at rest for some time. It is at rest when no more than 1 % of it is
/// faster than [`speed`](Self::speed), and nothing ten times as fast, in the mean of 16 particles side by side.
///
/// A cloth that sleeps stays as it is and costs nothing. It wakes when a pin, the grab, the material, the solver, its shape, its
/// transform, its shading, its sleep settings, gravity, the substeps or the wind change, when a force is added, when a collider
/// moves, appears or disappears where it lies, and when what holds an attachment or a target of a motion constraint has moved by
/// 0.1 mm. [`ClothRest::wake`] wakes it by hand.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothSleep {
    /// Whether the cloth falls asleep at all.
    pub enabled: bool,
    /// What is slower rests [m/s].
    pub speed: f32,
    /// How long the cloth has to be at rest \[s\].
    pub seconds: f32,
}

impl Default for ClothSleep {
    fn default() -> Self {
        Self {
            enabled: true,
            speed: 0.01,
            seconds: 1.0,
        }
    }
}

impl ClothSleep {
    /// A cloth that is always awake.
    pub fn never() -> Self {
        Self {
            enabled: false,
            ..Self::default()
        }
    }

    /// What is wrong with these settings.
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

/// Whether a cloth is at rest or asleep. Written by [`wake_cloths`] and [`rest_cloths`] alone.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothRest {
    seconds: f32,
    #[reflect(ignore)]
    asleep: Option<Asleep>,
}

/// What a cloth fell asleep in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Asleep {
    /// The step.
    step: u64,
    around: Around,
}

/// What acts on a cloth from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Around {
    gravity: Vec3,
    substeps: Option<u32>,
    iterations: u32,
    air: (Vec3, WindModel, f32),
    /// Of the colliders that touch the cloth's box.
    colliders: u64,
}

impl ClothRest {
    /// How long the cloth has been at rest \[s\].
    pub fn seconds(&self) -> f32 {
        self.seconds
    }

    /// Whether the cloth sleeps.
    pub fn is_asleep(&self) -> bool {
        self.asleep.is_some()
    }

    /// The step after which the cloth fell asleep, where it sleeps.
    pub fn asleep_since(&self) -> Option<u64> {
        self.asleep.map(|asleep| asleep.step)
    }

    /// Wakes the cloth, and makes it wait again before it falls asleep.
    pub fn wake(&mut self) {
        *self = Self::default();
    }
}

/// How many particles that lie side by side are looked at together.
const RUN: usize = 16;

/// Room around a cloth in which a collider wakes it \[m\].
const ROOM: f32 = 0.02;

fn around(
    step: &ClothStep,
    wind: &BlowingWind,
    colliders: &ClothColliders,
    (frame, bounds): (&ClothFrame, &ClothBounds),
    layers: Option<&ClothLayers>,
    material: &ClothMaterial,
) -> Around {
    let mut hasher = DefaultHasher::new();
    let room = ROOM + material.margin().max(0.0);
    for collider in colliders.near(frame, bounds, layers.copied().unwrap_or_default(), room) {
        collider.hash(&mut hasher);
    }
    Around {
        gravity: step.gravity(),
        substeps: step.fixed_substeps,
        iterations: step.iterations(),
        air: wind.kind(),
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
        let changed = sleep.is_changed()
            || pins.is_changed()
            || material.is_changed()
            || solver.is_changed()
            || topology.is_changed()
            || shading.is_changed();
        let pulled = grab.particle().is_some()
            || !forces.is_empty()
            || frame.is_moving()
            || attached.is_disturbed()
            || motion.is_some_and(MotionState::is_disturbed);
        let other = |asleep: Asleep| {
            asleep.around != around(&step, &wind, &colliders, (frame, bounds), layers, &material)
        };
        let disturbed = changed || pulled || rest.asleep.is_some_and(other);
        if disturbed && *rest != ClothRest::default() {
            rest.wake();
        }
    }
}

/// Measures how long the cloths have been at rest, and lets them fall asleep.
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
    /// What [`rest_cloths`] does for one cloth.
    pub(crate) fn rest(
        &mut self,
        step: &ClothStep,
        wind: &BlowingWind,
        colliders: &ClothColliders,
    ) {
        let sleep = self.sleep;
        if !sleep.enabled || self.particles.is_empty() || !sleep.errors().is_empty() {
            return;
        }
        let seconds = step.seconds();
        if !self.particles.is_at_rest(sleep.speed * seconds) {
            self.rest.set_if_neq(ClothRest::default());
            return;
        }
        self.rest.seconds += seconds;
        if self.rest.seconds >= sleep.seconds {
            self.particles.stop();
            let around = around(
                step,
                wind,
                colliders,
                (&self.frame, &self.bounds),
                self.layers,
                self.material,
            );
            self.rest.asleep = Some(Asleep {
                step: step.steps(),
                around,
            });
        }
    }
}

impl ClothParticles {
    /// Whether at most one in a hundred runs of particles moved further in this step than `distance` \[m\], and none ten times
    /// as far, in the mean of each run: single particles that tremble in a crease keep nobody awake.
    fn is_at_rest(&self, distance: f32) -> bool {
        let (slow, fast) = (distance * distance, 100.0 * distance * distance);
        let runs = self.len().div_ceil(RUN);
        let moved = |run: usize| {
            let run = run * RUN..((run + 1) * RUN).min(self.len());
            let mean = |now: &[f32], before: &[f32]| {
                let ways = now[run.clone()].iter().zip(&before[run.clone()]);
                ways.map(|(to, from)| to - from).sum::<f32>() / run.len() as f32
            };
            let (now, before) = (&self.position, &self.step_position);
            Vec3::new(
                mean(&now.x, &before.x),
                mean(&now.y, &before.y),
                mean(&now.z, &before.z),
            )
        };
        let most = runs / 100;
        let mut count = 0;
        for run in 0..runs {
            let q = moved(run).length_squared();
            if q > slow {
                count += 1;
                if count > most || q > fast {
                    return false;
                }
            }
        }
        true
    }

    /// Takes all velocity away, also for interpolation.
    fn stop(&mut self) {
        self.step_position.copy_from(&self.position);
        self.previous_position.copy_from(&self.position);
        self.lost_displacement.fill(Vec3::ZERO);
    }
}
