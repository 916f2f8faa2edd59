//! Sharing of tension beyond the stable limit: it acts along edges as they will lie at the end, not as they are predicted to lie.
//!
//! With tension X_k \[kg\] · substep⁻² of the edges k beyond that limit, particles z_k that move along surfaces alone, P_k = I − n nᵀ, and
//! the ends of the edges at their final positions, x = z + y:
//!
//! - y_k = w_k P_k (X_k (x_{k+1} − x_k) − X_{k−1} (x_k − x_{k−1}))
//!
//! This y is the minimum of Σ |y|²/(2 w) + Σ X |x_{k+1} − x_k|²/2 along the surfaces: no wave grows whatever X is, where the same tension
//! along edges as they are predicted lets waves grow from κ = 4 w X = 4/3 on. By elimination, y_k = p_k + g_k P_k y_{k+1}, with f_k = X_k
//! (z_{k+1} − z_k) − X_{k−1} (z_k − z_{k−1}) and scalars for pivots:
//!
//! - s_k = 1 + w_k (X_k + X_{k−1} (1 − c_k g_{k−1})), g_k = w_k X_k/s_k, p_k = w_k P_k (f_k + X_{k−1} p_{k−1})/s_k
//!
//! A pivot would be a matrix where normals differ. c_k = 1 − n_{k−1}² + (n_{k−1} · n_k)² is the least factor by which P_k P_{k−1} P_k
//! shortens any vector. With it, the solved system differs from the above by a positive term on the diagonal: 0 where normals are the same,
//! and never such that a step goes too far.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    edges::Edges,
    lanes::{Factor, Shared, V3},
    lines::{FREE, Give, LARGEST_KAPPA, Lines, NO_MASS, PRESSED},
};

/// Bounds of multipliers, |μ| \[kg\].
///
/// Of μ no more than κ/(4 w) acts along the edge as it is predicted to lie, w being the largest inverse mass of a line, of its ends half
/// ([`super::edges::Whole::bears`]): with p = 1/2, and 1 at an end, |u_a − u_b|² ≤ 4 w (p_a u_a²/w_a + p_b u_b²/w_b), so that no wave
/// across the line is pulled back by more than κ of itself.
#[derive(Clone, Copy)]
pub(super) struct TensionBounds<S: Simd> {
    give: Give,
    /// Stable limit: the most that acts along edges as they are predicted to lie.
    borne: S::f32s,
    /// Largest pull and push in all.
    pulls: S::f32s,
    pushes: S::f32s,
}

impl<S: Simd> TensionBounds<S> {
    #[inline(always)]
    pub fn new(bears: S::f32s, give: Give) -> Self {
        let [borne, pulls, pushes] = [LARGEST_KAPPA, give.pull, give.push].map(|k| bears * k);
        Self {
            give,
            borne,
            pulls,
            pushes,
        }
    }

    /// Returns whether pull or push is bounded in all.
    #[inline(always)]
    pub fn gives(self) -> bool {
        self.give.pull.min(self.give.push) < f32::MAX
    }

    /// Multiplier within the bounds of pull and push.
    #[inline(always)]
    pub fn given<const GIVES: bool>(self, mu: S::f32s) -> S::f32s {
        if GIVES {
            mu.min(self.pushes).max(-self.pulls)
        } else {
            mu
        }
    }

    /// Part of the multiplier of the edge `e`, `d`, that acts along it as it is predicted to lie. The rest is noted in the second half of
    /// the edge's slots of `factors`, for [`share`], and the range `taut` is extended to `e`. Edges come in falling order.
    #[inline(always)]
    pub fn borne<E: Edges<S>, const CONTACT: u8>(
        self,
        simd: S,
        edges: E,
        factors: Shared,
        taut: &mut Range<usize>,
        e: usize,
        mu: S::f32s,
        d: V3<S>,
    ) -> S::f32s {
        let zero = S::f32s::splat(simd, 0.0);
        // A cloth that carries bodies has substeps enough for their weight.
        if CONTACT == PRESSED || !mu.simd_lt(zero - self.borne).any_true() {
            return mu;
        }
        let half = S::f32s::splat(simd, 0.5);
        let slot = |k: usize| (2 * k + 1) * S::f32s::LEN;
        let beyond = (zero - mu - self.borne).max(zero);
        // X acts on an edge that is as long as at rest: X = μ |d|/L, by the series of the root, and no more than 2 μ.
        let l2 = edges.at(simd, e).l2.max(S::f32s::splat(simd, NO_MASS));
        let longer = half + d.dot(d) * (half * (S::f32s::splat(simd, 1.0) / l2));
        // The edges between `e` and the range have none.
        for k in e + 1..taut.start {
            factors.store::<S>(slot(k), zero);
        }
        *taut = e..taut.end.max(e + 1);
        factors.store::<S>(slot(e), beyond * longer.min(half * 4.0));
        mu.max(zero - self.borne)
    }
}

/// Solves as many chains as a vector has lanes, run by run of edges that have any tension to share. X_k is in the second half of the slots
/// of `factors` for a range of edges, and 0 for all others.
#[inline(always)]
pub(super) fn share<S: Simd, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    factors: Shared,
    edges: Range<usize>,
) {
    let zero = S::f32s::splat(simd, 0.0);
    let is_taut = |k| tension(simd, factors, &edges, k).simd_gt(zero).any_true();
    let mut k = edges.start;
    while k < edges.end {
        let start = k;
        while is_taut(k) {
            k += 1;
        }
        if k > start {
            share_run::<S, CONTACT>(simd, lines, factors, start..k);
        }
        k += 1;
    }
}

/// Loads X_k; 0 beyond the range.
#[inline(always)]
fn tension<S: Simd>(simd: S, factors: Shared, edges: &Range<usize>, k: usize) -> S::f32s {
    if k < edges.end {
        factors.load(simd, (2 * k + 1) * S::f32s::LEN)
    } else {
        S::f32s::splat(simd, 0.0)
    }
}

#[inline(always)]
fn share_run<S: Simd, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    factors: Shared,
    edges: Range<usize>,
) {
    let lanes = S::f32s::LEN;
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let nothing = V3::splat(simd, Vec3::ZERO);
    let mut z = lines.particle(simd, edges.start);
    let (mut p, mut pull, mut n) = (nothing, nothing, nothing);
    let (mut before, mut gain) = (zero, zero);
    for k in edges.start..=edges.end {
        let w = lines.weight(simd, k);
        let (mut after, mut push, mut next) = (zero, nothing, z);
        if k < edges.end {
            after = factors.load(simd, (2 * k + 1) * lanes);
            next = lines.particle(simd, k + 1);
            push = Factor(after) * (next - z);
        }
        p = push - pull + Factor(before) * p;
        let mut kept = one;
        if CONTACT != FREE {
            let n_before = n;
            n = lines.normal(simd, k);
            let turned = n.dot(n_before);
            kept = one - n_before.dot(n_before) + turned * turned;
            p = p - Factor(n.dot(p)) * n;
        }
        let inv_pivot = one / (one + w * (after + before * (one - kept * gain)));
        let part = w * inv_pivot;
        p = Factor(part) * p;
        gain = after * part;
        factors.store::<S>(2 * k * lanes, gain);
        lines.shared.store(k * lanes, p);
        (z, pull, before) = (next, push, after);
    }
    let mut y = nothing;
    for k in (edges.start..=edges.end).rev() {
        if CONTACT != FREE {
            let n: V3<S> = lines.normal(simd, k);
            y = y - Factor(n.dot(y)) * n;
        }
        let gain = factors.load(simd, 2 * k * lanes);
        let p: V3<S> = lines.shared.load(simd, k * lanes);
        y = p + Factor(gain) * y;
        let place: V3<S> = lines.particle(simd, k);
        lines.position.store(lines.at(k), place + y);
    }
}
