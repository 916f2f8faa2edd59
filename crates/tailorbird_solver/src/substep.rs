//! Parameters of a substep.

use bevy_math::Vec3;
use fearless_simd::Level;

use crate::workers::Workers;

/// A substep of one cloth: the parameters of its stages.
#[derive(Clone, Copy)]
pub struct Substep<'a> {
    /// The instruction set that the kernels use.
    pub level: Level,
    /// Length of the substep \[s\].
    pub seconds: f32,
    /// Index of the substep, from 0.
    pub index: u32,
    /// Number of substeps in the step.
    pub count: u32,
    /// Passes over the constraints.
    pub iterations: u32,
    /// Acceleration of every particle [m/s²], in world axes.
    pub gravity: Vec3,
    /// Speed at which particles inside a collider are pushed out of it [m/s].
    pub overlap_speed: f32,
    /// Threads that work on it.
    pub workers: Workers<'a>,
}

impl Substep<'_> {
    /// Distance by which particles inside a collider are pushed out of it, each of the two times in a substep \[m\].
    pub fn out(&self) -> f32 {
        0.5 * self.overlap_speed * self.seconds
    }

    /// Number of substeps left, this one included.
    pub fn left(&self) -> u32 {
        self.count - self.index
    }

    /// The parts of the step that have passed at its start and at its end, 0 to 1.
    pub fn fractions(&self) -> (f32, f32) {
        let to = (self.index + 1) as f32 / self.count as f32;
        (to - 1.0 / self.count as f32, to)
    }
}
