//! Systems of a game within a substep: reading and moving particles.
//!
//! A system in [`ClothSubstep`](crate::schedule::ClothSubstep) gets [`SubstepCloths`]. Here is a solid that the crate does not have, a
//! ball that is hollow:
//!
//! ```
//! # use bevy_app::App;
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{Mat3, Vec3};
//! # use tailorbird_cloth::{collider::find_contacts, prelude::*, substep::{SubstepCloths, SubstepContact}};
//! const RADIUS: f32 = 2.0;
//!
//! /// Contact of a point outside of the hollow: its depth, and the direction inwards.
//! fn contact(point: Vec3) -> Option<SubstepContact> {
//!     let depth = point.length() - RADIUS;
//!     (depth > 0.0).then(|| SubstepContact::new(-point.normalize(), depth).with_friction(0.5))
//! }
//!
//! fn approach(mut cloths: SubstepCloths) {
//!     for mut cloth in cloths.iter_mut() {
//!         cloth.approach(contact);
//!     }
//! }
//!
//! fn collide(mut cloths: SubstepCloths) {
//!     for mut cloth in cloths.iter_mut() {
//!         cloth.collide(contact);
//!     }
//! }
//!
//! fn plugin(app: &mut App) {
//!     app.add_systems(
//!         ClothSubstep,
//!         (
//!             approach
//!                 .in_set(ClothSubstepSystems::Approach)
//!                 .after(find_contacts),
//!             collide.in_set(ClothSubstepSystems::Collide),
//!         ),
//!     );
//! }
//! ```
//!
//! `approach` comes before the constraints: what touches then moves along the surface alone while they are solved. `collide` comes after
//! them, with friction. A solid with `collide` alone works too; cloth that is pulled taut over it then sinks in a little in each substep and is
//! pushed out again.
//!
//! # What it costs
//!
//! With any system of a game in the schedule all cloths take the same number of substeps, that of the one which needs most, and go through each
//! stage together: they no longer stay in the cache from stage to stage. That is 2 to 5 % of a step for one sheet, and 13 % for a hundred of
//! 32² (one thread, AVX-512, `cargo run --release -p tailorbird_cloth --example bench -- substep`). What the system itself does comes on top: reading
//! all positions of 128² took 0.5 ms a step of 1.0, a solid that looks at each particle twice in a substep 1.3 ms, 5 ns a look. One pass on one
//! thread: leave out cloths that are far away, by their [`ClothBounds`](crate::bounds::ClothBounds), say.

use bevy_ecs::{prelude::*, query::QueryData, system::SystemParam};
use bevy_math::{Mat3, Vec3};
use tailorbird_solver::{
    contact::colliders::combined_friction,
    kernels::contact::Path,
    particles::{Input, Particles, Scratch, State},
    topology::order::Given,
};

use crate::{
    cloth::Cloth, frame::ClothFrame, material::ClothMaterial, particles::ClothParticles,
    sleep::ClothSleepState, step::ClothStep,
};

/// The cloths that are simulated in this substep; those that sleep are left out: see [`ClothSleepState::wake`].
#[derive(SystemParam)]
pub struct SubstepCloths<'w, 's> {
    step: Res<'w, ClothStep>,
    cloths: Query<'w, 's, SubstepQuery, With<Cloth>>,
}

/// Components of a cloth that are read and written.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct SubstepQuery {
    entity: Entity,
    frame: &'static ClothFrame,
    material: &'static ClothMaterial,
    rest: &'static ClothSleepState,
    particles: &'static mut ClothParticles,
}

impl SubstepCloths<'_, '_> {
    /// The step in progress.
    pub fn step(&self) -> &ClothStep {
        &self.step
    }

    /// All cloths that are awake, in no particular order.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = SubstepCloth<'_>> {
        let seconds = self.step.substep_seconds();
        self.cloths
            .iter_mut()
            .filter(|cloth| !cloth.rest.is_asleep())
            .map(move |cloth| SubstepCloth::new(cloth, seconds))
    }

    /// One cloth, where it is awake.
    pub fn get_mut(&mut self, entity: Entity) -> Option<SubstepCloth<'_>> {
        let seconds = self.step.substep_seconds();
        let cloth = self.cloths.get_mut(entity).ok()?;
        (!cloth.rest.is_asleep()).then(|| SubstepCloth::new(cloth, seconds))
    }
}

/// A cloth in a substep. Particles have the numbers of [`Cloth::rest_positions`]; places are in the world \[m\], but where *frame* is
/// written.
///
/// The velocity of a particle is its position less its previous one, by the length of the substep: to move a particle without changing its
/// velocity, move both.
pub struct SubstepCloth<'w> {
    entity: Entity,
    frame: &'w ClothFrame,
    /// Rotation from the frame's axes to the world's.
    axes: Mat3,
    material: &'w ClothMaterial,
    particles: &'w mut Particles,
    seconds: f32,
}

/// A particle and the surface that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubstepContact {
    /// Unit normal of the surface, in world axes, towards where particles are to be.
    pub normal: Vec3,
    /// Depth of the particle behind the surface \[m\]; negative above it.
    pub depth: f32,
    /// Coulomb friction of the surface [-]; the geometric mean with the material's counts.
    pub friction: f32,
    /// Displacement of the surface at the particle in this substep, in world axes \[m\].
    pub surface: Vec3,
}

impl SubstepContact {
    /// A surface at rest without friction.
    pub fn new(normal: Vec3, depth: f32) -> Self {
        Self {
            normal,
            depth,
            friction: 0.0,
            surface: Vec3::ZERO,
        }
    }

    /// Sets the Coulomb friction [-].
    pub fn with_friction(self, friction: f32) -> Self {
        Self { friction, ..self }
    }

    /// On a surface that moves so far in this substep, in world axes \[m\].
    pub fn moving(self, surface: Vec3) -> Self {
        Self { surface, ..self }
    }

    /// Returns whether all its numbers are usable.
    fn is_valid(&self) -> bool {
        self.depth.is_finite()
            && self.normal.is_normalized()
            && self.friction >= 0.0
            && self.surface.is_finite()
    }
}

impl<'w> SubstepCloth<'w> {
    fn new(cloth: SubstepQueryItem<'w, '_>, seconds: f32) -> Self {
        Self {
            entity: cloth.entity,
            axes: Mat3::from_quat(cloth.frame.isometry().rotation),
            frame: cloth.frame,
            material: cloth.material,
            particles: &mut cloth.particles.into_inner().0,
            seconds,
        }
    }

    /// The cloth's entity.
    pub fn entity(&self) -> Entity {
        self.entity
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// The length of the substep \[s\].
    pub fn seconds(&self) -> f32 {
        self.seconds
    }

    /// The frame that positions *in the frame* refer to.
    pub fn frame(&self) -> &ClothFrame {
        self.frame
    }

    #[inline]
    fn to_world(&self, point: Vec3) -> Vec3 {
        self.axes * point + Vec3::from(self.frame.isometry().translation)
    }

    fn stored(&self, i: usize) -> usize {
        self.particles.order.stored(Given(i as u32)).index()
    }

    /// 1/mass of a particle [1/kg]; 0 where it is held.
    ///
    /// # Panics
    /// When `i` is out of range, as all methods that name a particle.
    #[inline]
    pub fn inverse_mass(&self, i: usize) -> f32 {
        self.particles.input.inv_mass[self.stored(i)]
    }

    /// Returns whether a pin, an attachment, a motion constraint or a hand holds a particle, and so moves it.
    pub fn is_held(&self, i: usize) -> bool {
        self.inverse_mass(i) == 0.0
    }

    /// Position of a particle.
    #[inline]
    pub fn position(&self, i: usize) -> Vec3 {
        self.to_world(self.position_in_frame(i))
    }

    /// Position of a particle at the start of the substep, as seen from the frame as it is now.
    pub fn previous_position(&self, i: usize) -> Vec3 {
        self.to_world(self.previous_position_in_frame(i))
    }

    /// Position of a particle, in the frame \[m\].
    #[inline]
    pub fn position_in_frame(&self, i: usize) -> Vec3 {
        self.particles.state.position.get(self.stored(i))
    }

    /// Position of a particle at the start of the substep, in the frame \[m\].
    pub fn previous_position_in_frame(&self, i: usize) -> Vec3 {
        self.particles.state.previous_position.get(self.stored(i))
    }

    /// Puts a particle elsewhere; its velocity changes by as much, unless its previous position is moved as well. Returns whether it did: one
    /// that is held stays, and a place that is not finite is none.
    pub fn set_position(&mut self, i: usize, position: Vec3) -> bool {
        self.set_position_in_frame(i, self.frame.to_frame(position))
    }

    /// Puts where a particle was elsewhere: see [`Self::set_position`].
    pub fn set_previous_position(&mut self, i: usize, position: Vec3) -> bool {
        self.set_previous_position_in_frame(i, self.frame.to_frame(position))
    }

    /// [`Self::set_position`], in the frame \[m\].
    pub fn set_position_in_frame(&mut self, i: usize, position: Vec3) -> bool {
        let free = !self.is_held(i) && position.is_finite();
        if free {
            let i = self.stored(i);
            self.particles.state.position.set(i, position);
        }
        free
    }

    /// [`Self::set_previous_position`], in the frame \[m\].
    pub fn set_previous_position_in_frame(&mut self, i: usize, position: Vec3) -> bool {
        let free = !self.is_held(i) && position.is_finite();
        if free {
            let i = self.stored(i);
            self.particles.state.previous_position.set(i, position);
        }
        free
    }

    /// Before the constraints are solved, in [`ClothSubstepSystems::Approach`](crate::schedule::ClothSubstepSystems::Approach) and after
    /// [`find_contacts`](crate::collider::find_contacts), which forgets what was noted before: pushes free particles out of surfaces, without
    /// friction, and notes what they touch. `contact` gets a particle's place.
    ///
    /// A particle that touches something already keeps to that.
    pub fn approach(&mut self, contact: impl Fn(Vec3) -> Option<SubstepContact>) {
        let len = self.particles.len();
        for i in 0..len {
            let Some((contact, normal)) = self.touches(i, &contact).filter(|(c, _)| c.depth > 0.0)
            else {
                continue;
            };
            let Particles {
                state: State { touch, .. },
                scratch: Scratch { contacts, .. },
                ..
            } = &mut *self.particles;
            if contacts.depth.len() != len {
                contacts.reset(len);
            }
            if contacts.depth[i] == 0.0 {
                contacts.normal.set(i, normal);
                contacts.depth[i] = contact.depth;
            }
            (contacts.any, touch.any) = (true, true);
            touch.swept = touch.swept.max(contact.surface.length());
            self.resolve(i, normal, contact, 0.0);
        }
    }

    /// After the constraints are solved: pushes free particles out of surfaces, with friction for the whole push, that of
    /// [`Self::approach`] included.
    pub fn collide(&mut self, contact: impl Fn(Vec3) -> Option<SubstepContact>) {
        for i in 0..self.particles.len() {
            let Some((contact, normal)) = self.touches(i, &contact) else {
                continue;
            };
            let contacts = &self.particles.scratch.contacts;
            let before = if contacts.any && contacts.normal.get(i).dot(normal) > 0.7 {
                contacts.depth[i]
            } else {
                0.0
            };
            // What the constraints have lifted by less than it was pushed out is still pressed on.
            if contact.depth + before <= 0.0 {
                continue;
            }
            let friction = combined_friction(contact.friction, self.material.friction);
            let most = friction * (contact.depth + before);
            self.resolve(i, normal, contact, most);
        }
    }

    /// The contact of a free particle in storage order, and its normal in the frame's axes.
    #[inline]
    fn touches(
        &self,
        i: usize,
        contact: &impl Fn(Vec3) -> Option<SubstepContact>,
    ) -> Option<(SubstepContact, Vec3)> {
        let Particles {
            state: State { position, .. },
            input: Input { inv_mass, .. },
            ..
        } = &*self.particles;
        if inv_mass[i] == 0.0 {
            return None;
        }
        let contact = contact(self.to_world(position.get(i)))?;
        let normal = self.frame.vector_to_frame(contact.normal);
        contact.is_valid().then_some((contact, normal))
    }

    /// Pushes a particle out of a surface, and takes back its sliding by at most `most` \[m\].
    fn resolve(&mut self, i: usize, normal: Vec3, contact: SubstepContact, most: f32) {
        let surface = self.frame.vector_to_frame(contact.surface);
        let state = &mut self.particles.state;
        let path = Path {
            from: state.previous_position.get(i),
            to: state.position.get(i),
        };
        let depth = contact.depth.max(0.0);
        let Path { from, to } = path.resolve(normal, depth, most, surface);
        state.previous_position.set(i, from);
        state.position.set(i, to);
    }
}
