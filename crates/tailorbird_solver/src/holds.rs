//! Particles held by attachments during a step.

use bevy_math::Vec3;

use crate::{
    fingerprint,
    frame::Frame,
    held::{Held, HeldBy, HolderKind},
    kernels::spring::{self, alpha_tilde},
    memory::heap,
    particles::Particles,
    pose::{Map, Pose},
    substep::Substep,
    topology::order::{ParticleOrder, Stored},
};

/// Particles of a cloth that attachments hold, and their points.
#[derive(Clone, Debug, Default)]
pub struct Holds {
    pub bodies: Vec<Holder>,
    /// Rigid holds by body and particle, one of each particle.
    pub rigid: Vec<Hold>,
    pub springs: Vec<Spring>,
    pub order: ParticleOrder,
    /// True if a change wakes the cloth.
    pub disturbed: bool,
    /// Largest displacement of a point in this step \[m\].
    pub furthest: f32,
    /// Fingerprint of who holds which particles where.
    pub revision: u64,
}

/// Body that holds particles, during a step.
#[derive(Clone, Copy, Debug)]
pub struct Holder {
    /// Identity of the attachment and of its target, as bits.
    pub attachment: u64,
    pub target: u64,
    /// Pose at the start of the step.
    pub start: Pose,
    /// Pose at the end of the step.
    pub end: Pose,
    /// Pose before a jump that put it to `start`.
    pub jumped: Option<Pose>,
    /// Part of its displacement in this step that is too sudden for the cloth to feel \[m\].
    pub excess: Vec3,
    /// True if it was teleported on request, and is otherwise still in this step: its velocity is not known.
    pub told: bool,
    /// Force of its springs, summed over the substeps, in world axes \[N\].
    pub pulled: Vec3,
    /// Number of those substeps.
    pub substeps: u32,
}

/// A particle at a point of an attachment.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    pub particle: Stored,
    /// Index in the list of bodies.
    pub body: u32,
    /// Point in the entity's own space \[m\].
    pub point: Vec3,
    /// Offset from the point to the particle, at the start and at the end of the step, in the cloth's frame \[m\].
    pub gap: [Vec3; 2],
}

#[derive(Clone, Copy, Debug)]
pub struct Spring {
    pub hold: Hold,
    /// Compliance for this particle alone [m/N].
    pub compliance: f32,
    /// Position of its other end in this substep \[m\].
    anchor: Vec3,
    /// Inverse mass of the particle without the spring [1/kg].
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

/// Displacement of an attachment target by which it wakes a sleeping cloth \[m\].
const WAKES: f32 = 1e-4;

/// Largest speed at which a particle goes to the point that holds it [m/s].
const CATCHES_UP: f32 = 30.0;

/// Largest displacement in a step of a point that counts as still \[m\].
pub const STANDS: f32 = 1e-5;

impl Holds {
    /// Returns whether nothing is attached.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// All particles that are held.
    pub fn particles(&self) -> impl Iterator<Item = Stored> + '_ {
        let springs = self.springs.iter().map(|spring| &spring.hold);
        self.rigid.iter().chain(springs).map(|hold| hold.particle)
    }

    /// Computes [`Self::revision`] anew, where holds changed.
    pub fn renew_revision(&mut self) {
        let holds = self
            .rigid
            .iter()
            .chain(self.springs.iter().map(|spring| &spring.hold));
        let holds = holds.flat_map(|hold| {
            let [x, y, z] = hold.point.to_array().map(f32::to_bits);
            [hold.particle.0, hold.body, x, y, z]
        });
        let ids = self
            .bodies
            .iter()
            .flat_map(|body| [body.attachment, body.target]);
        let ids = ids.flat_map(|id| [id as u32, (id >> 32) as u32]);
        self.revision = fingerprint::of(
            [self.rigid.len() as u32]
                .into_iter()
                .chain(ids)
                .chain(holds),
        );
    }

    /// Different whenever other particles are held, or at other points.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.bodies) + heap(&self.rigid) + heap(&self.springs)
    }

    /// Returns whether a body that holds it moves, however slowly.
    pub fn is_led(&self) -> bool {
        self.furthest > STANDS
    }

    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Forgets all attachments.
    pub fn clear(&mut self) {
        self.bodies.clear();
        self.rigid.clear();
        self.springs.clear();
    }

    /// Adds an attachment; without compliance, later ones take particles from earlier ones.
    pub fn add(
        &mut self,
        body: Holder,
        points: impl Iterator<Item = (Stored, Vec3)>,
        compliances: Option<&[f32]>,
    ) {
        let hold = |(particle, point)| Hold {
            particle,
            body: self.bodies.len() as u32,
            point,
            gap: [Vec3::ZERO; 2],
        };
        match compliances {
            None => self.rigid.extend(points.map(hold)),
            Some(compliances) => {
                let springs = points.zip(compliances);
                self.springs
                    .extend(springs.map(|(at, c)| Spring::new(hold(at), *c)));
            }
        }
        self.bodies.push(body);
    }

    /// Completes the list after the last attachment: makes rigidly held particles kinematic, and notes their start. Returns whether other
    /// particles are held than before.
    pub fn finish(&mut self, frame: &Frame, particles: &mut Particles, seconds: f32) -> bool {
        self.order = particles.order.clone();
        self.rigid
            .retain(|hold| !particles.is_pinned(self.order.given(hold.particle).index()));
        self.rigid
            .sort_unstable_by_key(|hold| (hold.particle, u32::MAX - hold.body));
        self.rigid.dedup_by_key(|hold| hold.particle);
        self.rigid
            .sort_unstable_by_key(|hold| (hold.body, hold.particle));
        let attached = self.rigid.iter().map(|hold| Held {
            particle: hold.particle,
            by: HeldBy::Attachment,
        });
        let changed = particles.hold(HolderKind::Attachment, attached);
        let at = |hold: &Hold| particles.state.position.get(hold.particle.index());
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

    /// Map from a body's own space to the cloth's frame, at the end of a substep.
    fn map(&self, body: u32, fraction: f32, frame: &Frame) -> Map {
        let body = &self.bodies[body as usize];
        body.start
            .towards(&body.end, fraction)
            .seen_from(frame.isometry())
    }

    /// Moves rigidly held particles to their points at the end of a substep. The frame is there already.
    pub fn advance(&mut self, substep: &Substep, frame: &Frame, particles: &mut Particles) {
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
            let i = hold.particle.index();
            if i >= particles.len() {
                continue;
            }
            let [gap, left] = hold.gap;
            let to = map.apply(hold.point) + gap * (1.0 - fraction) + left * fraction;
            particles.state.position.set(i, to);
        }
    }

    /// Takes the springs into account before the constraints are solved: see [`spring`].
    pub fn stretch(&mut self, substep: &Substep, frame: &Frame, particles: &mut Particles) {
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
            let i = hold.particle.index();
            let Some(&inv_mass) = particles.input.inv_mass.get(i) else {
                continue;
            };
            let anchor = map.apply(hold.point);
            (self.springs[k].anchor, self.springs[k].inv_mass) = (anchor, inv_mass);
            if inv_mass > 0.0 {
                let alpha_tilde = alpha_tilde(compliance, substep.seconds);
                let left = spring::left(inv_mass, alpha_tilde);
                let place = anchor + (particles.state.position.get(i) - anchor) * left;
                particles.state.position.set(i, place);
                particles.input.inv_mass[i] = inv_mass * left;
            }
        }
    }

    /// Measures the springs after the constraints are solved, and restores the inverse masses of the particles. Returns the sum of their
    /// forces on the bodies, in the cloth's frame \[N\].
    pub fn measure(&mut self, frame: &Frame, particles: &mut Particles) -> Vec3 {
        let mut all = Vec3::ZERO;
        for spring in self.springs.iter().rev() {
            let i = spring.hold.particle.index();
            if i < particles.len() && spring.inv_mass > 0.0 {
                let force = (particles.state.position.get(i) - spring.anchor) / spring.compliance;
                self.bodies[spring.hold.body as usize].pulled += frame.vector_to_world(force);
                particles.input.inv_mass[i] = spring.inv_mass;
                all += force;
            }
        }
        for body in &mut self.bodies {
            body.substeps += 1;
        }
        all
    }
}
