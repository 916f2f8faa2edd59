//! Bending of whole lines: one implicit step of the linear bending energy of each.
//!
//! A line of particles x_k, k = 0 … m−1, at the distance L from each other that stands for a strip of the width b has the energy
//! ½ Σ_j |D_j|²/α, with D_j = x_j − 2 x_{j+1} + x_{j+2} and the compliance α = L³/(B b), B being the bending rigidity: for an inextensible strip
//! this is ½ B b ∫ κ² ds, however far it is bent (Bergou et al. 2006). Its matrix G = Σ_j ∂D_jᵀ ∂D_j is constant, the same for each
//! coordinate, and has five diagonals: (…, 1, −4, 6, −4, 1, …) within the line. A step of backward Euler from the predicted positions y,
//! with α̃ = α/h² and x = y + Δ, is
//!
//! ```text
//! (diag(α̃/w_k) + G) Δ = −G y
//! ```
//!
//! solved by elimination in two sweeps. So a bending moment travels along the whole line in one pass, and a strip is as stiff at any
//! resolution and with any number of substeps. A held particle has α̃/w = ∞: its row has the pivot ∞, whose inverse is 0, and it stays.
//!
//! Δ is solved for, and not x, as its right side is made of differences of neighbours: the rounding is that of the displacement, and nothing that lies
//! straight moves, whichever way it lies.

#![expect(clippy::doc_markdown, reason = "formulas")]

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    edges::Whole,
    lanes::{Factor, Shared, V3},
    lines::Lines,
};

/// Pivots and multipliers of the elimination of the lines side by side. They depend on the masses alone, and mostly are those of the lines before.
pub struct Factors<'a> {
    /// Inverse masses for which the factors hold; those of lines at the border halved.
    weights: Shared<'a>,
    /// 1/pivot_k and l_k, one after the other.
    values: Shared<'a>,
    known: bool,
}

impl<'a> Factors<'a> {
    /// Size of their scratch, for each particle and lane.
    pub const SIZE: usize = 3;

    /// Creates factors that are not known yet, of lines of this length.
    #[inline(always)]
    pub fn new(scratch: &'a mut [f32], len: usize, lanes: usize) -> Self {
        let (weights, values) = scratch.split_at_mut(len * lanes);
        Self {
            weights: Shared::new(weights),
            values: Shared::new(values),
            known: false,
        }
    }

    #[inline(always)]
    fn are_of<S: Simd>(&self, simd: S, lines: Lines, part: S::f32s) -> bool {
        self.known
            && (0..lines.len).all(|k| {
                let known = self.weights.load(simd, k * S::f32s::LEN);
                known.simd_eq(lines.weight(simd, k) * part).all_true()
            })
    }

    /// Factors the matrix α̃/w + G.
    #[inline(always)]
    fn renew<S: Simd>(&mut self, simd: S, lines: Lines, whole: Whole<S>) {
        let (m, lanes) = (lines.len, S::f32s::LEN);
        let alpha_tilde = whole.bend;
        let zero = S::f32s::splat(simd, 0.0);
        // l_{k−1}, l_{k−1} pivot_{k−1}, 1/pivot_{k−1}, 1/pivot_{k−2}.
        let (mut l, mut c, mut inv_pivot, mut inv_before) = (zero, zero, zero, zero);
        for k in 0..m {
            // The diagonals of G: 1, 4 and 1 for the triple of which k is the first, the middle, the last particle.
            let triple = |first: Option<usize>| f32::from(first.is_some_and(|j| j + 2 < m));
            let [first, middle, last] = [Some(k), k.checked_sub(1), k.checked_sub(2)].map(triple);
            let (diagonal, beside) = (first + 4.0 * middle + last, -2.0 * (first + middle));

            let w = lines.weight(simd, k);
            let pivot = alpha_tilde / w + diagonal - c * l - inv_before;
            (inv_before, inv_pivot) = (inv_pivot, S::f32s::splat(simd, 1.0) / pivot);
            c = S::f32s::splat(simd, beside) - l;
            l = c * inv_pivot;
            self.weights.store::<S>(k * lanes, w * whole.part);
            self.values.store::<S>(2 * k * lanes, inv_pivot);
            self.values.store::<S>((2 * k + 1) * lanes, l);
        }
        self.known = true;
    }

    /// 1/pivot and l of row k.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, k: usize) -> [Factor<S>; 2] {
        [2 * k, 2 * k + 1].map(|slot| Factor(self.values.load(simd, slot * S::f32s::LEN)))
    }
}

/// Bends as many lines as a vector has lanes.
#[inline(always)]
pub fn solve<S: Simd>(simd: S, lines: Lines, whole: Whole<S>, factors: &mut Factors) {
    let (m, lanes) = (lines.len, S::f32s::LEN);
    if m < 3 {
        return;
    }
    if !factors.are_of(simd, lines, whole.part) {
        factors.renew(simd, lines, whole);
    }
    let nothing = V3::splat(simd, Vec3::ZERO);
    let none = Factor(S::f32s::splat(simd, 0.0));
    // D_{k−1}, D_{k−2}, and z, 1/pivot and l of the rows before.
    let (mut bow, mut bow_before) = (nothing, nothing);
    let (mut z, mut z_before) = (nothing, nothing);
    let (mut inv_pivot, mut inv_before, mut l) = (none, none, none);
    let mut next = lines.particle(simd, 1);
    let mut edge = lines.particle(simd, 0) - next;
    for k in 0..m {
        // −(D_k − 2 D_{k−1} + D_{k−2}).
        let mut right = bow + bow - bow_before;
        bow_before = bow;
        bow = nothing;
        if k + 2 < m {
            let after = lines.particle(simd, k + 2);
            let following = next - after;
            bow = edge - following;
            (next, edge) = (after, following);
        }
        right = right - bow;
        let eliminated = right - l * z - inv_before * z_before;
        (z_before, z) = (z, eliminated);
        inv_before = inv_pivot;
        [inv_pivot, l] = factors.at(simd, k);
        lines.shared.store(k * lanes, z);
    }
    let (mut moved_next, mut moved_after) = (nothing, nothing);
    for k in (0..m).rev() {
        // Δ_k = (z_k − Δ_{k+2})/pivot_k − l_k Δ_{k+1}.
        let [inv_pivot, l] = factors.at(simd, k);
        let z: V3<S> = lines.shared.load(simd, k * lanes);
        let moved = inv_pivot * (z - moved_after) - l * moved_next;
        let i = lines.at(k);
        lines.position.store(i, lines.particle(simd, k) + moved);
        (moved_after, moved_next) = (moved_next, moved);
    }
}
