//! Lets cloth settle and sleep, and wakes it.

use std::{
    fmt::{self, Write},
    hash::{DefaultHasher, Hash, Hasher},
};

use bevy_ecs::prelude::*;
use bevy_math::Quat;

use super::{ClothSleep, ClothSleepState, Surroundings};
use crate::{
    attachment::ClothAttachedParticles,
    bounds::ClothBounds,
    cloth::Cloth,
    collider::{ClothColliders, ClothLayers},
    error::{ClothErrorSource, ClothStatus},
    forces::ClothForces,
    frame::ClothFrame,
    grab::ClothGrab,
    material::ClothMaterial,
    motion::ClothMotionState,
    normals::ClothShading,
    pins::ClothPins,
    solver::{ClothSolver, ClothSubsteps},
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
    topology::ClothTopology,
    wind::ClothWindState,
};

/// After this time at rest a cloth begins to settle \[s\].
const SETTLES: f32 = 0.5;

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
    wind: &ClothWindState,
    colliders: &ClothColliders,
    (frame, bounds): (&ClothFrame, &ClothBounds),
    (layers, substeps): (Option<&ClothLayers>, Option<&ClothSubsteps>),
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
        substeps: step.fixed_substeps(substeps),
        iterations: step.iterations(),
        air: wind.kind(frame, bounds),
        colliders: hasher.finish(),
    }
}

/// The fingerprint of values, by what they print.
fn fingerprint(values: &dyn fmt::Debug) -> u64 {
    struct Printed(DefaultHasher);
    impl Write for Printed {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.write(text.as_bytes());
            Ok(())
        }
    }
    let mut printed = Printed(DefaultHasher::new());
    match write!(printed, "{values:?}") {
        Ok(()) => printed.0.finish(),
        // Taken for another one.
        Err(fmt::Error) => 0,
    }
}

/// Wakes the cloths to which something happened since they fell asleep.
pub fn wake_cloths(
    step: Res<ClothStep>,
    wind: Res<ClothWindState>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<
        (
            Entity,
            &mut ClothSleepState,
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
                &ClothAttachedParticles,
                Option<&ClothMotionState>,
            ),
            (&ClothFrame, &ClothBounds),
            (Option<&ClothLayers>, Option<&ClothSubsteps>),
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (entity, mut rest, settings, acting, place, optional, mut status) in &mut cloths {
        let (grab, forces, attached, motion) = acting;
        let (sleep, pins, material, solver, topology, shading) = settings;
        if sleep.is_changed() {
            let errors = sleep.errors();
            ClothStatus::update(
                &mut status,
                entity,
                &commands,
                ClothErrorSource::Sleep,
                errors,
            );
        }
        if rest.is_unseen() {
            continue;
        }
        let written = sleep.is_changed()
            || pins.is_changed()
            || material.is_changed()
            || solver.is_changed()
            || topology.is_changed()
            || shading.is_changed();
        let mut changed = false;
        if written {
            let settings = (*sleep, &*pins, *material, *solver, *shading);
            let settings = fingerprint(&(settings, topology.revision));
            changed = settings != rest.settings;
            if changed {
                rest.settings = settings;
            }
        }
        // What hangs straight does not, turned; what is put elsewhere as it is sleeps on.
        let turned = |turn: Quat| turn.angle_between(Quat::IDENTITY) > TURN;
        let pulled = grab.particle().is_some()
            || !forces.is_empty()
            || place.0.is_moving()
            || place.0.jump_turn().is_some_and(turned)
            || attached.is_disturbed()
            || motion.is_some_and(ClothMotionState::is_disturbed);
        let other = |known: Surroundings| {
            known != around(&step, &wind, &colliders, place, optional, &material)
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
    wind: Res<ClothWindState>,
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
        let led = self.attached.is_led() || self.motion.is_some_and(ClothMotionState::is_led);
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
        wind: &ClothWindState,
        colliders: &ClothColliders,
    ) {
        if self.rest.seconds < SETTLES {
            return;
        }
        let place = (&*self.frame, &*self.bounds);
        self.rest.around = Some(around(
            step,
            wind,
            colliders,
            place,
            (self.layers, self.substeps),
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
    let x = (seconds - SETTLES) / (SETTLED - SETTLES);
    1.0 - x.clamp(0.0, 1.0) * (1.0 - KEPT)
}
