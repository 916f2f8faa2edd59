//! A cloth as it is drawn in a frame.

use bevy_math::Vec3;
use tailorbird_cloth::{normals::ClothNormals, particles::ClothParticles};

use crate::drawn::ClothDrawnHolds;

/// State of a cloth that vertices follow.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a> {
    pub particles: &'a ClothParticles,
    pub normals: &'a ClothNormals,
    pub holds: &'a ClothDrawnHolds,
    /// The part of the time between the last two steps, 0 to 1.
    pub fraction: f32,
    /// Of the cloth's entity.
    pub scale: Vec3,
}

impl Drawn<'_> {
    /// Returns whether normals in the cloth's frame are those in its space.
    pub fn is_scaled_evenly(&self) -> bool {
        let Vec3 { x, y, z } = self.scale;
        x == y && y == z && x > 0.0
    }
}
