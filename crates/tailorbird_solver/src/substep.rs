//! What a substep is told.

use bevy_math::Vec3;
use fearless_simd::Level;

use crate::workers::Workers;

/// A substep of one cloth: what its stages are told.
#[derive(Clone, Copy)]
pub struct Substep<'a> {
    /// The instruction set that the kernels use.
    pub level: Level,
    /// Its length \[s\].
    pub seconds: f32,
    /// Which it is, from 0.
    pub index: u32,
    /// How many there are.
    pub count: u32,
    /// Passes over the constraints.
    pub iterations: u32,
    /// Acceleration of every particle [m/s²], in world axes.
    pub gravity: Vec3,
    /// How fast what is inside a collider is pushed out of it [m/s].
    pub overlap_speed: f32,
    /// Who works on it.
    pub workers: Workers<'a>,
}

impl Substep<'_> {
    /// How far what is inside a collider is pushed out of it, each of the two times in a substep \[m\].
    pub fn out(&self) -> f32 {
        0.5 * self.overlap_speed * self.seconds
    }

    /// How many are left, this one included.
    pub fn left(&self) -> u32 {
        self.count - self.index
    }

    /// The parts of the step that have passed at its start and at its end, 0 to 1.
    pub fn fractions(&self) -> (f32, f32) {
        let to = (self.index + 1) as f32 / self.count as f32;
        (to - 1.0 / self.count as f32, to)
    }
}
