//! Force of a cloth on its holders.

use bevy_math::{DVec3, Vec3};

use crate::{frame::Frame, particles::Particles, substep::Substep};

/// Force of a cloth on everything that holds it rigidly.
#[derive(Clone, Copy, Debug, Default)]
pub struct PinForces {
    sum: Vec3,
    substeps: u32,
    /// Σ m x of the free particles before the constraints were solved [kg m].
    before: DVec3,
}

impl PinForces {
    /// Sum over all held particles, mean over the last step, in world axes \[N\].
    pub fn force(&self) -> Vec3 {
        self.sum / self.substeps.max(1) as f32
    }

    /// Notes Σ m x before the constraints are solved.
    pub fn begin(&mut self, substep: &Substep, particles: &Particles) {
        if substep.index == 0 {
            *self = Self::default();
        }
        self.before = first_moment(particles);
    }

    /// Adds up the force after the constraints were solved. `springs` is the force on the springs of attachments, in the cloth's frame
    /// \[N\].
    pub fn end(&mut self, substep: &Substep, frame: &Frame, particles: &Particles, springs: Vec3) {
        let moved = first_moment(particles) - self.before;
        let h2 = f64::from(substep.seconds) * f64::from(substep.seconds);
        let pulled = -(moved / h2).as_vec3() - springs;
        let weight = substep.gravity * held_mass(particles);
        self.sum += frame.vector_to_world(pulled) + weight;
        self.substeps += 1;
    }
}

/// Σ m x of the free particles [kg m]. In `f64`, as differences of it count.
fn first_moment(particles: &Particles) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (i, (m, w)) in particles
        .input
        .mass
        .iter()
        .zip(&particles.input.inv_mass)
        .enumerate()
    {
        if *w > 0.0 {
            sum += particles.state.position.get(i).as_dvec3() * f64::from(*m);
        }
    }
    sum
}

/// Mass of the held particles \[kg\].
fn held_mass(particles: &Particles) -> f32 {
    let masses = particles.input.mass.iter().zip(&particles.input.inv_mass);
    masses.filter(|(_, w)| **w == 0.0).map(|(m, _)| m).sum()
}
