//! Sampled targets: positions at the times of steps, as [`sampling`](crate::sampling) has poses of entities.

use bevy_ecs::{change_detection::Tick, prelude::*};
use bevy_math::Vec3;
use tailorbird_solver::{
    held::HolderKind,
    memory::heap,
    particles::{Input, Particles, State},
};

use super::{ClothMotionState, ClothMotionTargets, ClothTargetSamples, KEPT, SeenTargets};
use crate::{
    particles::ClothParticles,
    sampling::{ClothFrameClock, FrameKind, LAPSE},
    settings::ClothSettings,
};

/// Targets at a moment: a part of the time between two frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetsAt<'a> {
    pub positions: [&'a [Vec3]; 2],
    pub normals: [&'a [Vec3]; 2],
    pub part: f32,
    /// Identity of the targets.
    pub key: [u64; 3],
}

impl TargetsAt<'_> {
    pub fn position(&self, i: usize) -> Vec3 {
        self.lerp(self.positions, i)
    }

    pub fn normal(&self, i: usize) -> Vec3 {
        self.lerp(self.normals, i)
    }

    fn lerp(&self, [from, to]: [&[Vec3]; 2], i: usize) -> Vec3 {
        if self.part <= 0.0 {
            from[i]
        } else {
            from[i].lerp(to[i], self.part)
        }
    }
}

impl ClothTargetSamples {
    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let lists = self
            .seen
            .iter()
            .flat_map(|seen| [&seen.positions, &seen.normals]);
        lists.map(heap).sum()
    }

    /// Returns whether the targets were put elsewhere since the last call.
    pub(super) fn take_jump(&mut self) -> bool {
        std::mem::take(&mut self.jumped)
    }

    /// Returns whether the fixed loop moves the targets.
    pub(super) fn are_fixed(&self) -> bool {
        self.fixed > 0
    }

    /// Notes at a step whether the fixed loop moved them.
    pub(super) fn begin_step(
        &mut self,
        targets: &Ref<ClothMotionTargets>,
        clock: &ClothFrameClock,
    ) {
        if clock.is_looping() {
            self.fixed = self.fixed.saturating_sub(1);
            self.note_moves(targets.last_changed());
        } else {
            self.fixed = LAPSE;
        }
    }

    fn note_moves(&mut self, changed: Tick) {
        if self.began.is_some_and(|began| began != changed) {
            self.fixed = LAPSE;
        }
    }

    /// The targets of this step, for a cloth of so many particles.
    pub(super) fn at<'a>(
        &'a self,
        targets: &'a Ref<ClothMotionTargets>,
        clock: &ClothFrameClock,
        particles: usize,
    ) -> TargetsAt<'a> {
        let moment = clock.moment();
        let known = &self.seen[..self.known];
        let ago = |frames: usize| {
            let number = clock.seen().saturating_sub(frames as u64);
            let found = known.iter().find(|seen| seen.number <= number);
            found.or(known.last())
        };
        let usable = |seen: &SeenTargets| {
            let normals = [0, particles].contains(&seen.normals.len());
            seen.positions.len() == particles && normals
        };
        if !self.are_fixed()
            && let (Some(older), Some(newer)) = (ago(moment.frames[2]), ago(moment.frames[3]))
            && usable(newer)
        {
            let alike = usable(older) && older.normals.len() == newer.normals.len();
            let older = if alike { older } else { newer };
            let same = older.number == newer.number;
            let part = if same { 0.0 } else { moment.part };
            return TargetsAt {
                positions: [&older.positions, &newer.positions],
                normals: [&older.normals, &newer.normals],
                part,
                key: [older.version, newer.version, u64::from(part.to_bits())],
            };
        }
        TargetsAt {
            positions: [&targets.positions; 2],
            normals: [&targets.normals; 2],
            part: 0.0,
            key: [u64::MAX, u64::from(targets.last_changed().get()), 0],
        }
    }

    /// Takes the targets for those of this frame; with nothing before them where they were put elsewhere.
    fn see(&mut self, targets: &ClothMotionTargets, number: u64, elsewhere: bool) {
        self.versions += 1;
        if elsewhere {
            self.known = 0;
        }
        if self.known == 0 || self.seen[0].number != number {
            self.seen.rotate_right(1);
            self.known = (self.known + 1).min(KEPT);
        }
        let seen = &mut self.seen[0];
        seen.number = number;
        seen.version = self.versions;
        seen.positions.clone_from(&targets.positions);
        seen.normals.clone_from(&targets.normals);
    }

    /// Largest displacement of a target \[m\].
    fn furthest(&self, targets: &ClothMotionTargets) -> f32 {
        let pairs = self.seen[0].positions.iter().zip(&targets.positions);
        pairs
            .map(|(from, to)| from.distance_squared(*to))
            .fold(0.0, f32::max)
            .sqrt()
    }
}

impl ClothMotionState {
    /// Takes each particle along with its target, where that was put elsewhere.
    pub(super) fn take_along(&self, particles: &mut ClothParticles) {
        let [start, end] = &self.limits.targets;
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    step_position,
                    ..
                },
            input: Input { inv_mass, held, .. },
            ..
        } = &mut particles.0;
        let free = (0..position.len()).filter(|&i| inv_mass[i] > 0.0);
        let limited = held.of(HolderKind::Limit).iter();
        for i in free.chain(limited.map(|held| held.particle.index())) {
            let displacement = end.get(i) - start.get(i);
            for points in [&mut *position, &mut *previous_position, &mut *step_position] {
                points.add(i, displacement);
            }
        }
    }
}

/// Notes where the targets are at the start of a frame.
pub(crate) fn see_targets(
    clock: Res<ClothFrameClock>,
    settings: Res<ClothSettings>,
    mut cloths: Query<(Ref<ClothMotionTargets>, &mut ClothTargetSamples)>,
) {
    let speed = settings.valid_teleport_speed();
    for (targets, mut samples) in &mut cloths {
        let samples = &mut *samples;
        let missed = samples.frame + 1 != clock.frame();
        samples.frame = clock.frame();
        let changed = samples.changed.replace(targets.last_changed());
        let changed = changed != Some(targets.last_changed());
        let finite = |points: &[Vec3]| points.iter().all(|p| p.is_finite());
        if targets.positions.is_empty()
            || changed && !(finite(&targets.positions) && finite(&targets.normals))
        {
            continue;
        }
        let alike = samples.seen[0].positions.len() == targets.positions.len();
        let elsewhere = match clock.kind() {
            _ if missed || samples.known == 0 || !alike => true,
            _ if !changed && samples.hops.velocity() == Vec3::ZERO => continue,
            FrameKind::First => true,
            FrameKind::Start => false,
            FrameKind::Still => true,
            FrameKind::Hitch => !samples.are_fixed(),
            FrameKind::Passed(seconds) => {
                let displacement = Vec3::X * samples.furthest(&targets);
                samples.hops.is_hop(displacement, seconds, speed) && !samples.are_fixed()
            }
        };
        if changed || elsewhere {
            samples.see(&targets, clock.seen(), elsewhere);
            samples.jumped |= elsewhere;
        }
    }
}

/// Notes the targets before the fixed loop moves them.
pub(crate) fn begin_fixed_targets(
    mut cloths: Query<(Ref<ClothMotionTargets>, &mut ClothTargetSamples)>,
) {
    for (targets, mut samples) in &mut cloths {
        samples.began = Some(targets.last_changed());
    }
}

/// Notes which targets the fixed loop moved after cloth had stepped.
pub(crate) fn end_fixed_targets(
    mut cloths: Query<(Ref<ClothMotionTargets>, &mut ClothTargetSamples)>,
) {
    for (targets, mut samples) in &mut cloths {
        samples.note_moves(targets.last_changed());
    }
}
