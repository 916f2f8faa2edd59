//! With which force a cloth pulls at what holds it.

use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Vec3};
use bevy_reflect::prelude::*;

use crate::{frame::ClothFrame, particles::ClothParticles, stages::Substep};

/// With which force a cloth pulls at everything that holds it rigidly: pins, rigid attachments, motion constraints of distance
/// 0, the player's hand. Measured where a cloth has this component; a hanging sheet of 1 kg pulls with 9.81 N.
///
/// It is what the constraints do to the momentum of the free particles, and the weight of those that are held; the inertia of
/// these, wind on them and the springs of [attachments](crate::attachment::AttachmentForce) are not part of it. Where the cloth lies on a
/// collider, so is what the lines press against that.
///
/// ```
/// # use bevy_ecs::prelude::*;
/// # use tailorbird_cloth::prelude::*;
/// fn tell(cloths: Query<&ClothPinForces>) {
///     for carried in &cloths {
///         println!("{} N", carried.force().length());
///     }
/// }
/// ```
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothPinForces {
    sum: Vec3,
    substeps: u32,
    /// Σ m x of the free particles before the constraints were solved [kg m].
    #[reflect(ignore)]
    before: DVec3,
}

impl ClothPinForces {
    /// The sum over all that is held, mean over the last step, in world axes \[N\].
    pub fn force(&self) -> Vec3 {
        self.sum / self.substeps.max(1) as f32
    }

    /// Before the constraints are solved.
    pub(crate) fn begin(&mut self, substep: &Substep, particles: &ClothParticles) {
        if substep.index == 0 {
            *self = Self::default();
        }
        self.before = first_moment(particles);
    }

    /// After the constraints were solved. `springs` is what the springs of attachments were pulled with, in the cloth's frame
    /// \[N\].
    pub(crate) fn end(
        &mut self,
        substep: &Substep,
        frame: &ClothFrame,
        particles: &ClothParticles,
        springs: Vec3,
    ) {
        let moved = first_moment(particles) - self.before;
        let h2 = f64::from(substep.seconds) * f64::from(substep.seconds);
        let pulled = -(moved / h2).as_vec3() - springs;
        let weight = substep.gravity * held_mass(particles);
        self.sum += frame.vector_to_world(pulled) + weight;
        self.substeps += 1;
    }
}

/// Σ m x of the free particles [kg m]. In `f64`, as differences of it count.
fn first_moment(particles: &ClothParticles) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (i, (m, w)) in particles.mass.iter().zip(&particles.inv_mass).enumerate() {
        if *w > 0.0 {
            sum += particles.position.get(i).as_dvec3() * f64::from(*m);
        }
    }
    sum
}

/// \[kg\].
fn held_mass(particles: &ClothParticles) -> f32 {
    let masses = particles.mass.iter().zip(&particles.inv_mass);
    masses.filter(|(_, w)| **w == 0.0).map(|(m, _)| m).sum()
}
