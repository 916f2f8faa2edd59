//! How what is asked for more than the fabric has comes back to its length.

#![expect(clippy::doc_markdown, reason = "formulas")]

use fearless_simd::{Simd, prelude::*};

use super::lanes::SharedPoints;

/// How fast what is stretched or squeezed comes back to its length, beyond what it does by its own motion.
#[derive(Clone, Copy)]
pub(crate) struct Recovery<'a> {
    /// Where the particles were at the start of the substep.
    pub start: SharedPoints<'a>,
    /// In a substep, at least this part of L² [-].
    pub least: f32,
    /// In a substep, this part of what q differs from L² by [-].
    pub part: f32,
    /// The least α̃ L², as a part of (w_k + w_{k+1}) L² [-].
    pub compliance: f32,
}

impl Recovery<'_> {
    /// What q of edges is to be at the end of the substep that was q₀ at its start.
    #[inline(always)]
    pub fn target<S: Simd>(self, q0: S::f32s, l2: S::f32s) -> S::f32s {
        let back = l2 * self.least + (q0 - l2).abs() * self.part;
        l2.max(q0 - back).min(q0 + back)
    }
}
