//! Bounded return of particles that are too far away.

use fearless_simd::{Simd, prelude::*};

use super::lanes::SharedPoints;

/// Bound of the return: a particle that is too far away at the start of a substep comes back in it by this amount, beyond its own motion.
#[derive(Clone, Copy)]
pub struct Recovery<'a> {
    /// Positions of the particles at the start of the substep.
    pub start: SharedPoints<'a>,
    /// Least decrease of the squared distance, as a part of the square of the allowed distance [-].
    pub least: f32,
    /// Decrease as a part of the difference of the two squares [-].
    pub part: f32,
}

impl Recovery<'_> {
    /// Square of the distance at the end of the substep, for a squared distance q₀ at its start and an allowed one of `l2`.
    #[inline(always)]
    pub fn target<S: Simd>(self, q0: S::f32s, l2: S::f32s) -> S::f32s {
        l2.max(q0 - (l2 * self.least + (q0 - l2) * self.part))
    }
}
