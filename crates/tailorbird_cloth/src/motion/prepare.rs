//! Reads motion constraints and their targets at the start of a step.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use fearless_simd::Level;
use tailorbird_solver::{
    held::{Held, HeldBy, HolderKind},
    kernels::{lanes::SharedPoints, normals},
    memory::heap,
    numbers::Numbers,
    points::Points,
    topology::{
        Topology,
        order::{Given, Stored},
    },
};

use super::{
    ClothMotionConstraints, ClothMotionState, ClothMotionTargets, ClothPerParticle,
    ClothTargetSamples, ClothTargetSpace, samples::TargetsAt,
};
use crate::{
    cloth::Cloth,
    error::{ClothErrorSource, ClothStatus},
    frame::ClothFrame,
    particles::ClothParticles,
    sampling::ClothFrameClock,
    settings::ClothSettings,
    sleep::ClothSleepState,
    step::ClothStep,
    topology::ClothTopology,
};

/// A cloth that sleeps wakes where a target is this far from where it was \[m\].
const WAKES: f32 = 1e-4;

/// A target that goes no further in a step stands still \[m\].
const STANDS: f32 = 1e-5;

/// Reads the motion constraints where they changed, and the targets at the end of this step.
pub fn prepare_motion(
    step: Res<ClothStep>,
    (clock, settings): (Res<ClothFrameClock>, Res<ClothSettings>),
    mut cloths: Query<
        (
            Entity,
            Option<Ref<ClothMotionConstraints>>,
            Option<(Ref<ClothMotionTargets>, &mut ClothTargetSamples)>,
            &ClothTopology,
            &ClothFrame,
            &ClothSleepState,
            &mut ClothMotionState,
            &mut ClothParticles,
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (
        entity,
        constraints,
        targets,
        topology,
        frame,
        rest,
        mut motion,
        mut particles,
        mut status,
    ) in &mut cloths
    {
        if particles.is_empty() {
            continue;
        }
        let rebuilt = motion.revision != topology.revision;
        motion.disturbed = false;
        let Some(constraints) = constraints else {
            motion.disturbed = !motion.limits.max_distance.is_empty();
            *motion.bypass_change_detection() = ClothMotionState {
                disturbed: motion.disturbed,
                ..ClothMotionState::default()
            };
            particles.0.hold(HolderKind::Limit, []);
            for source in [ClothErrorSource::Motion, ClothErrorSource::MotionTargets] {
                ClothStatus::update(&mut status, entity, &commands, source, None);
            }
            continue;
        };
        if rebuilt || constraints.is_changed() {
            let errors = constraints.errors(topology.particles());
            if errors.is_empty() {
                motion.disturbed |= motion.read(&constraints, topology);
            } else if rebuilt {
                // Those of another shape mean nothing to this one.
                motion.limits.max_distance.clear();
                motion.held.clear();
            }
            motion.disturbed |= rebuilt;
            let source = ClothErrorSource::Motion;
            ClothStatus::update(&mut status, entity, &commands, source, errors);
        }
        if rebuilt {
            motion.rest(topology, step.level());
        }
        if let Some((targets, _)) = &targets
            && (rebuilt || targets.is_changed())
        {
            let errors = targets.errors(topology.particles());
            let source = ClothErrorSource::MotionTargets;
            ClothStatus::update(&mut status, entity, &commands, source, errors);
        }
        motion.revision = topology.revision;
        if step.running() {
            let mut elsewhere = std::mem::take(&mut motion.idle);
            let valid = targets.filter(|(targets, _)| {
                !targets.positions.is_empty() && status.is_ok_for(ClothErrorSource::MotionTargets)
            });
            // One that sleeps remembers where the targets were when it fell asleep, however slowly they creep away.
            if !rest.is_asleep() {
                motion.pass_on();
            }
            let mut fixed = true;
            if let Some((targets, mut samples)) = valid {
                samples.begin_step(&targets, &clock);
                elsewhere |= samples.take_jump();
                fixed = samples.are_fixed();
                let at = samples.at(&targets, &clock, topology.particles());
                let moves = targets.space == ClothTargetSpace::World
                    && (frame.is_moving() || frame.jump_turn().is_some());
                if rebuilt || at.key != motion.aimed || moves {
                    motion.aim(targets.space, &at, topology, frame, step.level());
                }
                if rebuilt {
                    motion.stay();
                }
            }
            let furthest = if motion.moving {
                motion.furthest()
            } else {
                0.0
            };
            let displacement = Vec3::X * furthest;
            let speed = settings.valid_teleport_speed();
            elsewhere |= motion
                .hops
                .is_hop(displacement, step.world_seconds(), speed)
                && fixed;
            if elsewhere && motion.moving {
                motion.take_along(&mut particles);
                motion.stay();
            }
            motion.disturbed |= furthest > WAKES;
            motion.furthest = furthest;
        } else {
            motion.idle = true;
        }
        let held = &motion.held;
        let order = particles.order.clone();
        let unpinned = |&i: &Stored| !particles.is_pinned(order.given(i).index());
        let wanted = held.iter().copied().filter(unpinned);
        let limited = particles.input.held.of(HolderKind::Limit);
        // No memory is needed where nothing changed.
        if !wanted.clone().eq(limited.iter().map(|held| held.particle)) {
            let by = HeldBy::Limit;
            let wanted: Vec<Held> = wanted.map(|particle| Held { particle, by }).collect();
            particles.0.hold(HolderKind::Limit, wanted);
            motion.disturbed = true;
        }
    }
}

impl ClothMotionState {
    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.limits.memory_bytes() + heap(&self.held)
    }

    /// Returns whether the targets move, however slowly.
    pub(crate) fn is_led(&self) -> bool {
        self.furthest > STANDS
    }

    pub(crate) fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Target at the end of the step, in the cloth's frame \[m\]; `i` is in storage order.
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn target(&self, i: usize) -> Vec3 {
        self.limits.targets[1].get(i)
    }

    /// Reads valid constraints. Returns whether they are others than before.
    fn read(&mut self, constraints: &ClothMotionConstraints, topology: &Topology) -> bool {
        let given = |i| topology.order.given(Stored(i as u32)).index();
        let stored = |values: &ClothPerParticle, none: f32| -> Numbers {
            let value = |i| values.get(given(i)).unwrap_or(none);
            (0..topology.particles()).map(value).collect()
        };
        let max_distance = stored(&constraints.max_distance, f32::INFINITY);
        let mut backstop = [
            stored(&constraints.backstop_distance, f32::INFINITY),
            stored(&constraints.backstop_radius, 1.0),
        ];
        if backstop[0].iter().all(|d| d.is_infinite()) {
            backstop = Default::default();
        }
        let held = max_distance.iter().enumerate();
        self.held = held
            .filter(|(_, most)| **most == 0.0)
            .map(|(i, _)| Stored(i as u32))
            .collect();
        let [distance, radius] = backstop;
        let limits = &mut self.limits;
        let known = (
            &limits.max_distance,
            &limits.backstop_distance,
            &limits.backstop_radius,
        );
        let changed = known != (&max_distance, &distance, &radius);
        limits.max_distance = max_distance;
        (limits.backstop_distance, limits.backstop_radius) = (distance, radius);
        changed
    }

    /// Puts the targets to where the particles are at rest.
    fn rest(&mut self, topology: &Topology, level: Level) {
        self.limits.targets[1] = topology.rest_positions.iter().copied().collect();
        self.limits.normals[1] = Points::zeroed(topology.particles());
        self.compute_normals(topology, level);
        self.stay();
    }

    fn compute_normals(&mut self, topology: &Topology, level: Level) {
        let (targets, normals) = (&self.limits.targets[1], &mut self.limits.normals[1]);
        match topology.grid_lattice() {
            Some(lattice) => {
                let rows = 0..lattice.rows as usize;
                normals::smooth_lattice(level, lattice, targets, SharedPoints::new(normals), rows);
            }
            None => normals::smooth(&topology.triangles, targets, normals),
        }
    }

    /// The end of the step before is the start of this one.
    fn pass_on(&mut self) {
        if self.moving {
            self.stay();
        }
    }

    /// Takes all motion out of the step.
    fn stay(&mut self) {
        let [start, end] = &mut self.limits.targets;
        start.copy_from(end);
        let [start, end] = &mut self.limits.normals;
        start.copy_from(end);
        self.moving = false;
    }

    /// Reads valid targets.
    fn aim(
        &mut self,
        space: ClothTargetSpace,
        targets: &TargetsAt,
        topology: &Topology,
        frame: &ClothFrame,
        level: Level,
    ) {
        self.aimed = targets.key;
        let (point, vector): (&dyn Fn(Vec3) -> Vec3, &dyn Fn(Vec3) -> Vec3) = match space {
            ClothTargetSpace::Frame => (&|p| p, &|v| v),
            ClothTargetSpace::World => (&|p| frame.to_frame_at_end(p), &|v| {
                frame.end.rotation.inverse() * v
            }),
        };
        for i in 0..targets.positions[0].len() {
            let stored = topology.order.stored(Given(i as u32)).index();
            self.limits.targets[1].set(stored, point(targets.position(i)));
        }
        if targets.normals[0].is_empty() {
            // For a backstop alone.
            if !self.limits.backstop_distance.is_empty() {
                self.compute_normals(topology, level);
            }
        } else {
            for i in 0..targets.normals[0].len() {
                let stored = topology.order.stored(Given(i as u32)).index();
                let normal = vector(targets.normal(i)).normalize_or_zero();
                self.limits.normals[1].set(stored, normal);
            }
        }
        self.moving = true;
    }

    /// Largest displacement of a target in this step \[m\].
    fn furthest(&self) -> f32 {
        let [start, end] = &self.limits.targets;
        let squared = start.iter().zip(end.iter());
        squared
            .map(|(from, to)| from.distance_squared(to))
            .fold(0.0, f32::max)
            .sqrt()
    }
}
