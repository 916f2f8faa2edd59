//! The state of all particles of one cloth.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::{
    effort::Effort,
    grant::Grant,
    kernels::contact::Contacts,
    memory::heap,
    numbers::Numbers,
    points::Points,
    topology::{Topology, order::ParticleOrder},
};

use crate::{collider::near::Around, frame::ClothFrame};

/// The state of all particles of one cloth, as parallel arrays, in the cloth's frame.
///
/// Particles have the numbers of [`Cloth::rest_positions`](crate::cloth::Cloth::rest_positions), but where *storage order* is
/// written: see [`ParticleOrder`].
///
/// Read it freely. It is written by the cloth systems alone: pins, grabs and [`ClothForces`](crate::forces::ClothForces)
/// are the ways to move it.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct ClothParticles {
    /// The order in which all that follows is stored.
    #[reflect(ignore)]
    pub(crate) order: ParticleOrder,
    /// Position \[m\].
    #[reflect(ignore)]
    pub(crate) position: Points,
    /// Position at the start of the substep \[m\]; with `position` and `substep_seconds` it gives the velocity.
    #[reflect(ignore)]
    pub(crate) previous_position: Points,
    /// What rounding took from the displacement of the substep \[m\]; part of the velocity.
    #[reflect(ignore)]
    pub(crate) lost_displacement: Points,
    /// Position at the start of the step \[m\], to interpolate from, and to fall back to.
    #[reflect(ignore)]
    pub(crate) step_position: Points,
    /// `previous_position` moved along with air that differs from place to place \[m\]; scratch of a step.
    #[reflect(ignore)]
    pub(crate) previous_with_air: Points,
    /// Acceleration by wind and forces during this step [m/s²]; empty where there is none.
    #[reflect(ignore)]
    pub(crate) acceleration: Points,
    /// Mass, pinned or not \[kg\].
    #[reflect(ignore)]
    pub(crate) mass: Vec<f32>,
    /// What the masses were made of [kg/m²].
    pub(crate) areal_density: f32,
    /// 1/mass [1/kg]; 0 is kinematic.
    #[reflect(ignore)]
    pub(crate) inv_mass: Numbers,
    /// Contacts in this substep, noted before the constraints are solved.
    #[reflect(ignore)]
    pub(crate) contacts: Contacts,
    /// What is known of the colliders around.
    #[reflect(ignore)]
    pub(crate) around: Around,
    /// How it stands with what the cloth is asked for.
    pub(crate) effort: Effort,
    /// How much longer than at rest the threads of a strained mesh may be.
    #[reflect(ignore)]
    pub(crate) grant: Grant,
    /// Mean places of runs of particles in the last while \[m\], in the cloth's frame.
    #[reflect(ignore)]
    pub(crate) calm: Vec<Vec3>,
    /// Multipliers of the constraints; scratch of a substep.
    #[reflect(ignore)]
    pub(crate) lambda: Vec<f32>,
    /// Pinned particles, by the number that was given to them.
    #[reflect(ignore)]
    pub(crate) pins: Vec<Held>,
    /// Particles that attachments hold rigidly, in storage order.
    #[reflect(ignore)]
    pub(crate) attached: Vec<u32>,
    /// Particles that motion constraints hold at their targets, in storage order.
    #[reflect(ignore)]
    pub(crate) limited: Vec<u32>,
    /// The particle that is moved by a grab, and where to \[m\].
    #[reflect(ignore)]
    pub(crate) grabbed: Option<Held>,
    /// Particles that are pulled along with the grabbed one.
    #[reflect(ignore)]
    pub(crate) pulled: Vec<Pulled>,
    /// The point that stayed where it was when the scale changed last, in the cloth's frame \[m\].
    pub(crate) grown_about: Vec3,
    /// The time that `position` − `previous_position` took \[s\].
    pub(crate) substep_seconds: f32,
}

/// A particle that is held at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Held {
    /// In storage order.
    pub particle: u32,
    /// In the cloth's frame \[m\].
    pub target: Vec3,
}

/// A particle that is pulled along with the grabbed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulled {
    /// In storage order.
    pub particle: u32,
    /// From the grabbed particle to where this one is pulled, in the cloth's frame \[m\].
    pub offset: Vec3,
    /// Part of the way there that is gone in a sixtieth of a second, 0 to 1.
    pub weight: f32,
}

impl ClothParticles {
    /// Particles at rest, without mass yet.
    pub(crate) fn at_rest(topology: &Topology) -> Self {
        Self {
            order: topology.order.clone(),
            ..Self::with_positions(topology.rest_positions.iter().copied().collect())
        }
    }

    pub(crate) fn with_positions(position: Points) -> Self {
        let len = position.len();
        Self {
            previous_position: position.clone(),
            step_position: position.clone(),
            lost_displacement: Points::zeroed(len),
            mass: vec![0.0; len],
            inv_mass: Numbers::zeroed(len),
            position,
            ..Self::default()
        }
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// What the state takes on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let points = [
            &self.position,
            &self.previous_position,
            &self.lost_displacement,
            &self.step_position,
            &self.acceleration,
            &self.previous_with_air,
            &self.contacts.normal,
        ];
        let lists = [&self.mass, &self.lambda];
        let numbers = [&self.inv_mass, &self.contacts.depth];
        points.map(Points::memory_bytes).iter().sum::<usize>()
            + lists.map(heap).iter().sum::<usize>()
            + numbers.map(Numbers::memory_bytes).iter().sum::<usize>()
            + heap(&self.pins)
            + heap(&self.pulled)
            + heap(&self.calm)
            + self.around.memory_bytes()
            + self.grant.memory_bytes()
            + heap(&self.attached)
            + heap(&self.limited)
    }

    /// Whether there are none: the cloth is not built yet, or its shape is invalid.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Where a particle is, in the cloth's frame \[m\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn position(&self, i: usize) -> Vec3 {
        self.position.get(self.stored(i))
    }

    /// Where all particles are, in the cloth's frame \[m\].
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.position(i))
    }

    /// How the particles are numbered where they are stored.
    pub fn order(&self) -> &ParticleOrder {
        &self.order
    }

    fn stored(&self, i: usize) -> usize {
        self.order.stored(i as u32) as usize
    }

    /// The coordinates as three arrays in storage order, in the cloth's frame \[m\].
    pub fn points(&self) -> &Points {
        &self.position
    }

    /// The coordinates a step before [`Self::points`], in storage order, in the cloth's frame \[m\].
    pub fn previous_points(&self) -> &Points {
        &self.step_position
    }

    /// Where a particle is between the last two steps: `fraction` 0 is the one before, 1 the last one. In the cloth's
    /// frame \[m\]. `i` is in storage order, as in
    /// [`Topology::particle_of_vertex`](tailorbird_solver::topology::Topology::particle_of_vertex()).
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn interpolated(&self, i: usize, fraction: f32) -> Vec3 {
        let (from, to) = (self.step_position.get(i), self.position.get(i));
        // This form gives both ends exactly.
        from * (1.0 - fraction) + to * fraction
    }

    /// Where a particle is in the world \[m\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn world_position(&self, i: usize, frame: &ClothFrame) -> Vec3 {
        frame.to_world(self.position(i))
    }

    /// How fast a particle moves through the world, in the axes of the cloth's frame [m/s].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn velocity(&self, i: usize) -> Vec3 {
        self.stored_velocity(self.stored(i))
    }

    /// The velocity of a particle in storage order [m/s].
    pub(crate) fn stored_velocity(&self, i: usize) -> Vec3 {
        if self.substep_seconds > 0.0 {
            let moved = self.position.get(i) - self.previous_position.get(i);
            (moved + self.lost_displacement.get(i)) / self.substep_seconds
        } else {
            Vec3::ZERO
        }
    }

    /// A particle's mass \[kg\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn mass(&self, i: usize) -> f32 {
        self.mass[self.stored(i)]
    }

    /// Whether a particle is held by a pin.
    pub fn is_pinned(&self, i: usize) -> bool {
        self.pins
            .binary_search_by_key(&(i as u32), |pin| self.order.given(pin.particle))
            .is_ok()
    }

    /// Whether a pin, a rigid attachment or a motion constraint of distance 0 holds a particle.
    pub fn is_held(&self, i: usize) -> bool {
        self.is_pinned(i) || {
            let stored = self.order.stored(i as u32);
            self.attached.contains(&stored) || self.limited.contains(&stored)
        }
    }

    /// The pinned particles, in order.
    pub fn pinned(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        let given = |pin: &Held| self.order.given(pin.particle) as usize;
        self.pins.iter().map(given)
    }

    /// The particle that a grab holds.
    pub fn grabbed(&self) -> Option<usize> {
        let given = |held: Held| self.order.given(held.particle) as usize;
        self.grabbed.map(given)
    }

    /// Gives every particle its share of the mass; those that are held become kinematic.
    pub(crate) fn set_masses(&mut self, areas: impl Iterator<Item = f32>, areal_density: f32) {
        self.areal_density = areal_density;
        for (mass, area) in self.mass.iter_mut().zip(areas) {
            *mass = areal_density * area;
        }
        self.update_inv_masses();
    }

    pub(crate) fn update_inv_masses(&mut self) {
        for (inv_mass, mass) in self.inv_mass.iter_mut().zip(&self.mass) {
            // A vertex that no triangle uses has no mass and stays where it is.
            *inv_mass = if *mass > 0.0 { 1.0 / mass } else { 0.0 };
        }
        let Self {
            inv_mass,
            pins,
            grabbed,
            attached,
            limited,
            ..
        } = self;
        let held = pins.iter().chain(&*grabbed).map(|held| held.particle);
        for i in held.chain(attached.iter().chain(&*limited).copied()) {
            if let Some(inv_mass) = inv_mass.get_mut(i as usize) {
                *inv_mass = 0.0;
            }
        }
    }

    /// Replaces the particles that attachments hold rigidly. Returns whether they are others.
    pub(crate) fn attach(&mut self, held: impl Iterator<Item = u32> + Clone) -> bool {
        let changed = !held.clone().eq(self.attached.iter().copied());
        if changed {
            self.attached.clear();
            self.attached.extend(held);
            self.update_inv_masses();
        }
        changed
    }

    /// Particles that are kinematic wherever they go, in storage order: what the others are tethered to.
    pub(crate) fn anchors(&self) -> impl Iterator<Item = u32> + '_ {
        let pins = self.pins.iter().map(|pin| pin.particle);
        pins.chain(self.attached.iter().chain(&self.limited).copied())
    }

    /// The accelerations of this step, one for each particle, to add to.
    pub(crate) fn accelerations(&mut self) -> &mut Points {
        let len = self.position.len();
        if self.acceleration.len() != len {
            self.acceleration.clear();
            self.acceleration.resize(len, 0.0);
        }
        &mut self.acceleration
    }

    /// Kinematic particles that do not move have no velocity.
    pub(crate) fn hold_still(&mut self) {
        let Self {
            position,
            previous_position,
            pins,
            grabbed,
            attached,
            limited,
            ..
        } = self;
        let held = pins.iter().chain(&*grabbed).map(|held| held.particle);
        for i in held.chain(attached.iter().chain(&*limited).copied()) {
            previous_position.set(i as usize, position.get(i as usize));
        }
    }

    /// Notes where the step starts.
    pub(crate) fn begin_step(&mut self) {
        self.step_position.copy_from(&self.position);
        self.contacts.overlaps = false;
        self.around.begin_step();
    }

    /// Puts the particles back to where the step started, without velocity.
    pub(crate) fn reset_to_step_start(&mut self) {
        self.position.copy_from(&self.step_position);
        self.previous_position.copy_from(&self.step_position);
        self.lost_displacement.fill(Vec3::ZERO);
        self.acceleration.clear();
        self.grant.clear();
    }

    /// Puts the particles where they are at rest, pinned ones where they are held, without velocity.
    pub(crate) fn reset_to_rest(&mut self, topology: &Topology) {
        if self.len() != topology.particles() {
            return;
        }
        for (i, place) in topology.rest_positions.iter().enumerate() {
            self.position.set(i, *place);
        }
        for held in &self.pins {
            self.position.set(held.particle as usize, held.target);
        }
        self.begin_step();
        self.reset_to_step_start();
    }
}
