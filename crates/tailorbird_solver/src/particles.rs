//! The particles of one cloth: their state, the input of a step, and scratch.

use bevy_math::Vec3;

use crate::{
    contact::{
        bodies::Coupling,
        cache::{ContactCache, MeshPlanes},
        colliders::ColliderId,
    },
    effort::Effort,
    grant::Grant,
    held::{Held, HeldParticles, HolderKind},
    kernels::contact::{Contacts, Touch},
    memory::heap,
    numbers::Numbers,
    points::Points,
    topology::{
        Topology,
        order::{Given, ParticleOrder, Stored},
    },
};

/// The particles of one cloth, as parallel arrays in storage order, in the cloth's frame.
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// The order in which all that follows is stored.
    #[doc(hidden)]
    pub order: ParticleOrder,
    /// State that the next step depends on.
    #[doc(hidden)]
    pub state: State,
    /// Input of a step.
    #[doc(hidden)]
    pub input: Input,
    /// Intermediate results.
    #[doc(hidden)]
    pub scratch: Scratch,
}

/// State of the particles that the next step depends on.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Position \[m\].
    pub position: Points,
    /// Position at the start of the substep \[m\]; with `position` and `substep_seconds` it gives the velocity.
    pub previous_position: Points,
    /// Rounding error of the displacement of the substep \[m\]; part of the velocity.
    pub lost_displacement: Points,
    /// Position at the start of the step \[m\], to interpolate from, and to fall back to.
    pub step_position: Points,
    /// The time that `position` − `previous_position` took \[s\].
    pub substep_seconds: f32,
    /// Strain beyond what the fabric allows, and its history.
    pub effort: Effort,
    /// Additional length that the threads of a strained cloth are granted.
    pub grant: Grant,
    /// Mean positions of blocks of 16 particles over the last quarter of a second \[m\].
    pub mean_position: Vec<Vec3>,
    /// The point that stayed where it was when the scale changed last \[m\].
    pub grown_about: Vec3,
    /// Contact planes of meshes, which hold the side of an open mesh that each particle is on.
    pub planes: Vec<MeshPlanes>,
    /// Colliders that pass through the cloth, because they move faster than it can follow.
    pub passing: Vec<ColliderId>,
    /// The particles that carry parts of bodies; those of each collider side by side.
    pub couplings: Vec<Coupling>,
    /// The largest force on bodies that the cloth carries, in the last while \[N\].
    pub load: f32,
    /// Contact in the last substep.
    pub touch: Touch,
}

/// Input of a step, as far as it concerns particles.
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// Acceleration by wind and forces during this step [m/s²]; empty where there is none.
    pub acceleration: Points,
    /// Mass, pinned or not \[kg\].
    pub mass: Vec<f32>,
    /// Mass per area that the masses were computed with [kg/m²].
    pub areal_density: f32,
    /// 1/mass [1/kg]; 0 is kinematic.
    pub inv_mass: Numbers,
    /// The particles that are held, and by what.
    pub held: HeldParticles,
    /// Particles that are pulled along with the grabbed one.
    pub pulled: Vec<Pulled>,
}

/// Intermediate results; can be dropped before any step.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// `previous_position` moved along with air that differs from place to place \[m\].
    pub previous_with_air: Points,
    /// Contacts in this substep, noted before the constraints are solved.
    pub contacts: Contacts,
    /// Colliders near the cloth.
    pub cache: ContactCache,
    /// Numbers of a stage: multipliers of the classic solver, rows at seams, lengths.
    pub lambda: Vec<f32>,
}

/// A particle that is pulled along with the grabbed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulled {
    /// Particle that is pulled.
    pub particle: Stored,
    /// From the grabbed particle to where this one is pulled, in the cloth's frame \[m\].
    pub offset: Vec3,
    /// Part of the distance there that is gone in a sixtieth of a second, 0 to 1.
    pub weight: f32,
}

impl Particles {
    /// Particles at rest, without mass yet.
    pub fn at_rest(topology: &Topology) -> Self {
        Self {
            order: topology.order.clone(),
            ..Self::with_positions(topology.rest_positions.iter().copied().collect())
        }
    }

    /// Particles at these positions, without mass yet.
    pub fn with_positions(position: Points) -> Self {
        let len = position.len();
        let still = Points::zeroed(len);
        Self {
            state: State {
                previous_position: position.clone(),
                step_position: position.clone(),
                lost_displacement: still,
                position,
                ..State::default()
            },
            input: Input {
                mass: vec![0.0; len],
                inv_mass: Numbers::zeroed(len),
                ..Input::default()
            },
            ..Self::default()
        }
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.state.position.len()
    }

    /// Memory on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let points = [
            &self.state.position,
            &self.state.previous_position,
            &self.state.lost_displacement,
            &self.state.step_position,
            &self.input.acceleration,
            &self.scratch.previous_with_air,
            &self.scratch.contacts.normal,
        ];
        let lists = [&self.input.mass, &self.scratch.lambda];
        let numbers = [&self.input.inv_mass, &self.scratch.contacts.depth];
        points.map(Points::memory_bytes).iter().sum::<usize>()
            + lists.map(heap).iter().sum::<usize>()
            + numbers.map(Numbers::memory_bytes).iter().sum::<usize>()
            + self.input.held.memory_bytes()
            + heap(&self.input.pulled)
            + heap(&self.state.passing)
            + heap(&self.state.couplings)
            + self
                .state
                .planes
                .iter()
                .map(MeshPlanes::memory_bytes)
                .sum::<usize>()
            + heap(&self.state.mean_position)
            + self.scratch.cache.memory_bytes()
            + self.state.grant.memory_bytes()
    }

    /// Returns whether there are none: the cloth is not built yet, or its shape is invalid.
    pub fn is_empty(&self) -> bool {
        self.state.position.is_empty()
    }

    /// Position of a particle in the cloth's frame \[m\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn position(&self, i: usize) -> Vec3 {
        self.state.position.get(self.stored(i))
    }

    /// Positions of all particles in the cloth's frame \[m\].
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.position(i))
    }

    /// Permutation between the original order and the storage order.
    pub fn order(&self) -> &ParticleOrder {
        &self.order
    }

    fn stored(&self, i: usize) -> usize {
        self.order.stored(Given(i as u32)).index()
    }

    /// The coordinates as three arrays in storage order, in the cloth's frame \[m\].
    pub fn points(&self) -> &Points {
        &self.state.position
    }

    /// The coordinates a step before [`Self::points`], in storage order, in the cloth's frame \[m\].
    pub fn previous_points(&self) -> &Points {
        &self.state.step_position
    }

    /// Position of a particle between the last two steps: `fraction` 0 is the one before, 1 the last one. In the cloth's
    /// frame \[m\].
    ///
    /// # Panics
    /// When `particle` is out of range.
    #[inline]
    pub fn interpolated(&self, particle: Stored, fraction: f32) -> Vec3 {
        let i = particle.index();
        let (from, to) = (self.state.step_position.get(i), self.state.position.get(i));
        // This form gives both ends exactly.
        from * (1.0 - fraction) + to * fraction
    }

    /// Velocity of a particle relative to the world, in the axes of the cloth's frame [m/s].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn velocity(&self, i: usize) -> Vec3 {
        self.stored_velocity(self.stored(i))
    }

    /// The velocity of a particle in storage order [m/s].
    pub fn stored_velocity(&self, i: usize) -> Vec3 {
        if self.state.substep_seconds > 0.0 {
            let moved = self.state.position.get(i) - self.state.previous_position.get(i);
            (moved + self.state.lost_displacement.get(i)) / self.state.substep_seconds
        } else {
            Vec3::ZERO
        }
    }

    /// A particle's mass \[kg\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn mass(&self, i: usize) -> f32 {
        self.input.mass[self.stored(i)]
    }

    /// Returns whether a particle is held by a pin.
    pub fn is_pinned(&self, i: usize) -> bool {
        let pins = self.input.held.of(HolderKind::Pin);
        pins.binary_search_by_key(&Given(i as u32), |pin| self.order.given(pin.particle))
            .is_ok()
    }

    /// Returns whether a pin, a rigid attachment or a motion constraint of distance 0 holds a particle.
    pub fn is_held(&self, i: usize) -> bool {
        let stored = self.order.stored(Given(i as u32));
        self.anchors().any(|anchor| anchor == stored)
    }

    /// The pinned particles, in order.
    pub fn pinned(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        let given = |(particle, _)| self.order.given(particle).index();
        self.input.held.pins().map(given)
    }

    /// The particle that a grab holds.
    pub fn grabbed(&self) -> Option<usize> {
        let (particle, _) = self.input.held.in_hand()?;
        Some(self.order.given(particle).index())
    }

    /// Gives every particle its share of the mass; those that are held become kinematic.
    pub fn set_masses(&mut self, areas: impl Iterator<Item = f32>, areal_density: f32) {
        self.input.areal_density = areal_density;
        for (mass, area) in self.input.mass.iter_mut().zip(areas) {
            *mass = areal_density * area;
        }
        self.update_inv_masses();
    }

    /// Computes inverse masses from masses and from the list of held particles.
    pub fn update_inv_masses(&mut self) {
        for (inv_mass, mass) in self.input.inv_mass.iter_mut().zip(&self.input.mass) {
            // A vertex that no triangle uses has no mass and stays where it is.
            *inv_mass = if *mass > 0.0 { 1.0 / mass } else { 0.0 };
        }
        let Input { inv_mass, held, .. } = &mut self.input;
        for i in held.particles() {
            if let Some(inv_mass) = inv_mass.get_mut(i.index()) {
                *inv_mass = 0.0;
            }
        }
    }

    /// Replaces the particles that holders of a kind hold. Returns whether others are held than before; then updates inverse masses.
    pub fn hold(&mut self, kind: HolderKind, held: impl IntoIterator<Item = Held>) -> bool {
        let changed = self.input.held.replace(kind, held);
        if changed {
            self.update_inv_masses();
        }
        changed
    }

    /// Particles that are kinematic wherever they go: the others are tethered to them.
    pub fn anchors(&self) -> impl Iterator<Item = Stored> + Clone + '_ {
        self.input.held.anchors()
    }

    /// The accelerations of this step, one for each particle, to add to.
    pub fn accelerations(&mut self) -> &mut Points {
        let len = self.state.position.len();
        if self.input.acceleration.len() != len {
            self.input.acceleration.clear();
            self.input.acceleration.resize(len, 0.0);
        }
        &mut self.input.acceleration
    }

    /// Kinematic particles that do not move have no velocity.
    pub fn hold_still(&mut self) {
        let State {
            position,
            previous_position,
            ..
        } = &mut self.state;
        for i in self.input.held.particles() {
            previous_position.set(i.index(), position.get(i.index()));
        }
    }

    /// Notes the positions at the start of the step.
    pub fn begin_step(&mut self) {
        self.state.step_position.copy_from(&self.state.position);
        self.state.touch.overlaps = false;
        self.scratch.cache.begin_step();
    }

    /// Puts the particles back to their positions at the start of the step, without velocity.
    pub fn reset_to_step_start(&mut self) {
        self.state.position.copy_from(&self.state.step_position);
        self.state
            .previous_position
            .copy_from(&self.state.step_position);
        self.state.lost_displacement.fill(Vec3::ZERO);
        self.input.acceleration.clear();
        self.state.grant.clear();
    }

    /// Puts the particles to their rest positions, pinned ones to their pins, without velocity.
    pub fn reset_to_rest(&mut self, topology: &Topology) {
        if self.len() != topology.particles() {
            return;
        }
        for (i, place) in topology.rest_positions.iter().enumerate() {
            self.state.position.set(i, *place);
        }
        for (particle, place) in self.input.held.pins() {
            self.state.position.set(particle.index(), place);
        }
        self.begin_step();
        self.reset_to_step_start();
    }
}
