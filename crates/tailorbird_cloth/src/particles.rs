//! The state of all particles of one cloth.

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::{particles::Particles, topology::Topology};

use crate::frame::ClothFrame;

/// The state of all particles of one cloth, in the cloth's frame: see [`Particles`].
///
/// Particles have the numbers of [`Cloth::rest_positions`](crate::cloth::Cloth::rest_positions), but where *storage order* is
/// written: see [`ParticleOrder`](tailorbird_solver::topology::order::ParticleOrder).
///
/// Read it freely. It is written by the cloth systems alone: pins, grabs and [`ClothForces`](crate::forces::ClothForces)
/// are the ways to move it.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct ClothParticles(#[reflect(ignore)] pub(crate) Particles);

impl Deref for ClothParticles {
    type Target = Particles;

    fn deref(&self) -> &Particles {
        &self.0
    }
}

impl ClothParticles {
    /// Particles at rest, without mass yet.
    pub(crate) fn at_rest(topology: &Topology) -> Self {
        Self(Particles::at_rest(topology))
    }

    /// Position of a particle in the world \[m\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn world_position(&self, i: usize, frame: &ClothFrame) -> Vec3 {
        frame.to_world(self.position(i))
    }
}
