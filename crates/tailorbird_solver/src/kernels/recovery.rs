//! How what is too far away comes back.

use fearless_simd::{Simd, prelude::*};

use super::lanes::SharedPoints;

/// What is too far away at the start of a substep comes back by so much in it, beyond what it does by its own motion.
#[derive(Clone, Copy)]
pub struct Recovery<'a> {
    /// Where the particles were at the start of the substep.
    pub start: SharedPoints<'a>,
    /// At least this part of the square of how far they get [-].
    pub least: f32,
    /// This part of what the squares differ by [-].
    pub part: f32,
}

impl Recovery<'_> {
    /// What the square of a distance that was q₀ at the start of the substep is to be at its end.
    #[inline(always)]
    pub fn target<S: Simd>(self, q0: S::f32s, l2: S::f32s) -> S::f32s {
        l2.max(q0 - (l2 * self.least + (q0 - l2) * self.part))
    }
}
