//! What the attachments of a cloth hold during a step.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::GlobalTransform;
use tailorbird_solver::{kernels::spring, memory::heap, topology::order::ParticleOrder};

use super::pose::{Map, Pose, motion};
use crate::{frame::ClothFrame, particles::ClothParticles, solver::alpha_tilde, stages::Substep};

/// The particles of a cloth that attachments hold, and where. Written by
/// [`prepare_attachments`](super::prepare_attachments) alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct AttachedParticles {
    #[reflect(ignore)]
    pub(super) bodies: Vec<Body>,
    /// By body and particle, one of each particle.
    #[reflect(ignore)]
    rigid: Vec<Hold>,
    #[reflect(ignore)]
    springs: Vec<Spring>,
    #[reflect(ignore)]
    order: ParticleOrder,
    /// Whether something changed that wakes the cloth.
    pub(super) disturbed: bool,
    /// How far the point goes in this step that goes furthest \[m\].
    pub(super) furthest: f32,
    /// Different whenever what is held changed.
    pub(super) revision: u64,
}

/// A particle that an attachment holds rigidly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPoint {
    /// The particle.
    pub particle: u32,
    /// The attachment.
    pub attachment: Entity,
    /// The entity that holds it.
    pub target: Entity,
    /// Where, in that entity's own space \[m\].
    pub point: Vec3,
}

/// An attachment during a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub attachment: Entity,
    pub target: Entity,
    /// At the start of the step.
    pub start: Pose,
    /// At its end.
    pub end: Pose,
    /// Where it was put elsewhere from, before it moved on from `start`.
    pub jumped: Option<Pose>,
    /// What of its way in this step is too sudden for the cloth to feel \[m\].
    pub excess: Vec3,
    /// Whether it was put elsewhere by somebody who said so, and has no way in this step that tells how fast it is.
    pub told: bool,
    /// What its springs pulled with, summed over the substeps, in world axes \[N\].
    pub pulled: Vec3,
    /// Over how many substeps.
    pub substeps: u32,
}

/// A particle at a point of an attachment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// In storage order.
    pub particle: u32,
    /// Which of the bodies.
    pub body: u32,
    /// In the entity's own space \[m\].
    pub point: Vec3,
    /// From where the body has the point to where the particle is, at the start and at the end of the step, in the cloth's
    /// frame \[m\].
    pub gap: [Vec3; 2],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    pub hold: Hold,
    /// Of this particle alone [m/N].
    pub compliance: f32,
    /// Where its other end is in this substep \[m\].
    anchor: Vec3,
    /// What it was before the spring counted [1/kg].
    inv_mass: f32,
}

impl Spring {
    pub fn new(hold: Hold, compliance: f32) -> Self {
        Self {
            hold,
            compliance,
            anchor: Vec3::ZERO,
            inv_mass: 0.0,
        }
    }
}

/// A cloth that sleeps wakes where what holds it is this far from where it was \[m\].
const WAKES: f32 = 1e-4;

/// A particle that is not where it is held goes there no faster than this [m/s].
const CATCHES_UP: f32 = 30.0;

/// A point that goes no further in a step stands still \[m\].
pub(super) const STANDS: f32 = 1e-5;

impl AttachedParticles {
    /// Whether nothing is attached.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The particles that are held rigidly.
    pub fn rigid(&self) -> impl ExactSizeIterator<Item = HeldPoint> + '_ {
        self.rigid.iter().map(|hold| {
            let body = &self.bodies[hold.body as usize];
            HeldPoint {
                particle: self.order.given(hold.particle),
                attachment: body.attachment,
                target: body.target,
                point: hold.point,
            }
        })
    }

    /// The particles at springs.
    pub fn springs(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        let given = |spring: &Spring| self.order.given(spring.hold.particle);
        self.springs.iter().map(given)
    }

    /// All particles that are held, in storage order.
    pub(crate) fn particles(&self) -> impl Iterator<Item = u32> + '_ {
        let springs = self.springs.iter().map(|spring| &spring.hold);
        self.rigid.iter().chain(springs).map(|hold| hold.particle)
    }

    /// Different whenever other particles are held, or at other points.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What it takes on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.bodies) + heap(&self.rigid) + heap(&self.springs)
    }

    /// Whether what it hangs on moves on, however slowly.
    pub(crate) fn is_led(&self) -> bool {
        self.furthest > STANDS
    }

    pub(crate) fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// How a target moved from where it was at a part of the last step, 0 to 1, to where it is now, as seen from a frame that does
    /// not move; without changes of scale. None where it holds nothing.
    pub fn motion(
        &self,
        target: Entity,
        now: &GlobalTransform,
        frame: Isometry3d,
        fraction: f32,
    ) -> Option<Isometry3d> {
        let body = self.bodies.iter().find(|body| body.target == target)?;
        let was = body.start.towards(&body.end, fraction);
        Some(motion(&was, &Pose::of(now).ok()?, frame))
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.bodies.clear();
        self.rigid.clear();
        self.springs.clear();
    }

    /// Adds an attachment; where it has no compliance, later ones take particles from earlier ones.
    pub(super) fn add(&mut self, body: Body, points: &[(u32, Vec3)], compliances: Option<&[f32]>) {
        let hold = |&(particle, point): &(u32, Vec3)| Hold {
            particle,
            body: self.bodies.len() as u32,
            point,
            gap: [Vec3::ZERO; 2],
        };
        match compliances {
            None => self.rigid.extend(points.iter().map(hold)),
            Some(compliances) => {
                let springs = points.iter().zip(compliances);
                self.springs
                    .extend(springs.map(|(at, c)| Spring::new(hold(at), *c)));
            }
        }
        self.bodies.push(body);
    }

    /// When all are added: makes the rigid ones kinematic, and notes where they start. Returns whether others are held than
    /// before.
    pub(super) fn finish(
        &mut self,
        frame: &ClothFrame,
        particles: &mut ClothParticles,
        seconds: f32,
    ) -> bool {
        self.order = particles.order.clone();
        self.rigid
            .retain(|hold| !particles.is_pinned(self.order.given(hold.particle) as usize));
        self.rigid
            .sort_unstable_by_key(|hold| (hold.particle, u32::MAX - hold.body));
        self.rigid.dedup_by_key(|hold| hold.particle);
        self.rigid
            .sort_unstable_by_key(|hold| (hold.body, hold.particle));
        let changed = particles.attach(self.rigid.iter().map(|hold| hold.particle));
        let at = |hold: &Hold| particles.position.get(hold.particle as usize);
        let mut furthest = 0.0f32;
        let springs = self
            .springs
            .iter_mut()
            .map(|spring| (&mut spring.hold, true));
        for (hold, is_spring) in self
            .rigid
            .iter_mut()
            .map(|hold| (hold, false))
            .chain(springs)
        {
            let body = &self.bodies[hold.body as usize];
            if is_spring {
                let moved = body.end.seen_from(frame.end).apply(hold.point)
                    - body.start.seen_from(frame.start).apply(hold.point);
                furthest = furthest.max(moved.length());
            } else {
                let start = body.start.seen_from(frame.start).apply(hold.point);
                let gap = at(hold) - start;
                hold.gap = [gap, gap - gap.clamp_length_max(CATCHES_UP * seconds)];
                let end = body.end.seen_from(frame.end).apply(hold.point);
                furthest = furthest.max(end.distance(at(hold)));
            }
        }
        self.disturbed = changed || furthest > WAKES;
        self.furthest = furthest;
        changed
    }

    /// From a body's own space to the cloth's frame, at the end of a substep.
    fn map(&self, body: u32, fraction: f32, frame: &ClothFrame) -> Map {
        let body = &self.bodies[body as usize];
        body.start
            .towards(&body.end, fraction)
            .seen_from(frame.isometry())
    }

    /// Moves what is held rigidly to where it is at the end of a substep. The frame is there already.
    pub(crate) fn advance(
        &mut self,
        substep: &Substep,
        frame: &ClothFrame,
        particles: &mut ClothParticles,
    ) {
        let fraction = if substep.left() == 1 {
            1.0
        } else {
            substep.fractions().1
        };
        let mut map: Option<(u32, Map)> = None;
        for hold in &self.rigid {
            let map = match map {
                Some((body, map)) if body == hold.body => map,
                _ => {
                    map.insert((hold.body, self.map(hold.body, fraction, frame)))
                        .1
                }
            };
            let i = hold.particle as usize;
            if i >= particles.len() {
                continue;
            }
            let [gap, left] = hold.gap;
            let to = map.apply(hold.point) + gap * (1.0 - fraction) + left * fraction;
            particles.position.set(i, to);
        }
    }

    /// Takes the springs into account before the constraints are solved: see [`spring`].
    pub(crate) fn stretch(
        &mut self,
        substep: &Substep,
        frame: &ClothFrame,
        particles: &mut ClothParticles,
    ) {
        let (_, fraction) = substep.fractions();
        let fraction = if substep.left() == 1 { 1.0 } else { fraction };
        let mut map: Option<(u32, Map)> = None;
        for k in 0..self.springs.len() {
            let Spring {
                hold, compliance, ..
            } = self.springs[k];
            let map = match map {
                Some((body, map)) if body == hold.body => map,
                _ => {
                    map.insert((hold.body, self.map(hold.body, fraction, frame)))
                        .1
                }
            };
            let i = hold.particle as usize;
            let Some(&inv_mass) = particles.inv_mass.get(i) else {
                continue;
            };
            let anchor = map.apply(hold.point);
            (self.springs[k].anchor, self.springs[k].inv_mass) = (anchor, inv_mass);
            if inv_mass > 0.0 {
                let alpha_tilde = alpha_tilde(compliance, substep.seconds);
                let left = spring::left(inv_mass, alpha_tilde);
                let place = anchor + (particles.position.get(i) - anchor) * left;
                particles.position.set(i, place);
                particles.inv_mass[i] = inv_mass * left;
            }
        }
    }

    /// Measures the springs after the constraints are solved, and gives the particles their masses back. Returns the sum of what
    /// they pull their bodies with, in the cloth's frame \[N\].
    pub(crate) fn measure(&mut self, frame: &ClothFrame, particles: &mut ClothParticles) -> Vec3 {
        let mut all = Vec3::ZERO;
        for spring in self.springs.iter().rev() {
            let i = spring.hold.particle as usize;
            if i < particles.len() && spring.inv_mass > 0.0 {
                let force = (particles.position.get(i) - spring.anchor) / spring.compliance;
                self.bodies[spring.hold.body as usize].pulled += frame.vector_to_world(force);
                particles.inv_mass[i] = spring.inv_mass;
                all += force;
            }
        }
        for body in &mut self.bodies {
            body.substeps += 1;
        }
        all
    }
}
