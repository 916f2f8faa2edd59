//! All distance constraints along a chain of particles at once: one Newton step of a tridiagonal system.
//!
//! For the edges k = 0 … m−2 between particles k and k+1 of a chain, with d_k = x_{k+1} − x_k, q_k = |d_k|² and rest length
//! L_k, the constraints are C_k = (q_k − L_k²)/(2 L_k) = 0, whose gradients d_k/L_k need no square root. The multipliers
//! λ_k = L_k μ_k of all edges follow from
//!
//! - diagonal: (w_k + w_{k+1}) q_k + α̃_k L_k²
//! - off-diagonal: −w_{k+1} d_k · d_{k+1}
//! - right side: −(q_k − L_k²)/2
//!
//! by elimination forward and substitution back (Thomas), and Δx_k = w_k (μ_{k−1} d_{k−1} − μ_k d_k). So a correction travels
//! the whole chain in one pass, where relaxation carries it one edge (Goldenthal et al. 2007, Han & Harada 2012).
//!
//! Chains lie side by side, one in each lane: particle k of the chain in lane l is at `offset + k · stride + l`. The columns of a sheet lie
//! in memory like this; rows are transposed and the chains of a mesh gathered into the same form.
//!
//! Guards: q on the diagonal is at least L²/4, and the right side at most L²/4, as the quadratic form overshoots in strong
//! compression; compliance has a relative floor, as a straight chain that is held at both ends is singular.
//!
//! A particle in contact moves along the surface alone: its inverse mass is w (I − n nᵀ), n being the contact's unit normal, or 0 without
//! contact. A particle that carries a part of a body has a normal shorter than 1, and moves the less along it.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    edges::Edges,
    lanes::{Factor, Shared, V3},
    lines::{FREE, Lines, PRESSED, apply},
    row::{beside, own},
    share::{TensionBounds, share},
};

/// State of the sweep forward: the first particle of the edge e, and the last row of the elimination.
struct Sweep<'a, S: Simd, E> {
    simd: S,
    lines: Lines<'a>,
    edges: E,
    factors: Shared<'a>,
    a: V3<S>,
    w_a: S::f32s,
    n_a: V3<S>,
    /// The edge e − 1: d, 1/pivot, solution.
    d: V3<S>,
    inv_pivot: S::f32s,
    g: S::f32s,
}

/// Solves as many chains as a vector has lanes. `factors` is scratch of at least 2 · len · lanes.
///
/// One vector at a time: with two vectors, the divisions of one could fill the gaps of the other, but the state no longer fits the
/// registers, and a quarter of the speed is lost (AVX-512).
#[inline(always)]
pub fn solve<S: Simd, E: Edges<S>, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    edges: E,
    bears: S::f32s,
    factors: Shared,
) {
    if lines.len < 2 {
        return;
    }
    // Elimination forward, edge by edge.
    let mut sweep = Sweep::start::<CONTACT>(simd, lines, edges, factors);
    for e in 0..lines.len - 1 {
        sweep.advance::<CONTACT>(e);
    }
    // Substitution back; `taut` are edges whose tension is shared (README: "Tension along edges as they will lie").
    let bounds = TensionBounds::new(bears, lines.give);
    let taut = if bounds.gives() {
        substitute::<S, E, CONTACT, true>(simd, lines, edges, factors, bounds)
    } else {
        substitute::<S, E, CONTACT, false>(simd, lines, edges, factors, bounds)
    };
    if CONTACT != PRESSED && !taut.is_empty() {
        // A function of its own, so that the registers are those of the lines.
        simd.vectorize(
            #[inline(always)]
            || share::<S, CONTACT>(simd, lines, factors, taut),
        );
    }
}

impl<'a, S: Simd, E: Edges<S>> Sweep<'a, S, E> {
    #[inline(always)]
    fn start<const CONTACT: u8>(simd: S, lines: Lines<'a>, edges: E, factors: Shared<'a>) -> Self {
        let (nothing, zero) = (V3::splat(simd, Vec3::ZERO), S::f32s::splat(simd, 0.0));
        Self {
            simd,
            lines,
            edges,
            factors,
            a: lines.particle(simd, 0),
            w_a: lines.weight(simd, 0),
            n_a: if CONTACT == FREE {
                nothing
            } else {
                lines.normal(simd, 0)
            },
            d: nothing,
            inv_pivot: zero,
            g: zero,
        }
    }

    /// Eliminates the edge e.
    #[inline(always)]
    fn advance<const CONTACT: u8>(&mut self, e: usize) {
        let s = self;
        let (simd, lines) = (s.simd, s.lines);
        let (b, w_b) = (lines.particle(simd, e + 1), lines.weight(simd, e + 1));
        // Row e of the system: (w_e + w_{e+1}) |d_e|² + α̃ L² on the diagonal, (L² − |d_e|²)/2 on the right side.
        let d = b - s.a;
        let n_b = if CONTACT == FREE {
            s.n_a
        } else {
            lines.normal(simd, e + 1)
        };
        let (edge, w, n) = (s.edges.at(simd, e), [s.w_a, w_b], [s.n_a, n_b]);
        let [diagonal, rhs] = own::<S, CONTACT>(simd, lines.give, edge, d, w, n);
        // w_e d_{e−1} · d_e, the off-diagonal of the edges e − 1 and e with its sign changed.
        let beside = beside::<S, CONTACT>(s.w_a, s.d, d, s.n_a);
        s.n_a = n_b;
        // pivot_e = diagonal_e − beside²/pivot_{e−1}, g_e = (right side_e + beside g_{e−1})/pivot_e. As few operations as possible wait for the
        // division of the edge before.
        let pivot = diagonal - beside * beside * s.inv_pivot;
        let inv_pivot = S::f32s::splat(simd, 1.0) / pivot;
        let g = (rhs + beside * s.g) * inv_pivot;
        // For the substitution: factor_e = beside / pivot_{e−1}, and g_e.
        let slot = 2 * e * S::f32s::LEN;
        s.factors.store::<S>(slot, beside * s.inv_pivot);
        s.factors.store::<S>(slot + S::f32s::LEN, g);

        (s.d, s.inv_pivot, s.g) = (d, inv_pivot, g);
        (s.a, s.w_a) = (b, w_b);
    }
}

/// Substitutes back: μ_e = g_e + factor_{e+1} μ_{e+1}; particle e + 1 moves by w (μ_e d_e − μ_{e+1} d_{e+1}).
///
/// Returns the range of edges that have tension beyond the stable limit of a substep; [`share`] needs it in place of the multipliers.
#[inline(always)]
fn substitute<S: Simd, E: Edges<S>, const CONTACT: u8, const GIVES: bool>(
    simd: S,
    lines: Lines,
    edges: E,
    factors: Shared,
    bounds: TensionBounds<S>,
) -> Range<usize> {
    let (m, lanes) = (lines.len, S::f32s::LEN);
    let (nothing, zero) = (V3::splat(simd, Vec3::ZERO), S::f32s::splat(simd, 0.0));
    let mut far = lines.particle(simd, m - 1);
    let (mut pull, mut mu_far, mut factor) = (nothing, zero, zero);
    let mut taut = 0..0;
    for e in (0..m - 1).rev() {
        let near = lines.particle(simd, e);
        let slot = 2 * e * lanes;
        // μ_e = g_e + factor_{e+1} μ_{e+1}.
        let mut mu = factors.load(simd, slot + lanes) + factor * mu_far;
        factor = factors.load(simd, slot);
        let d = far - near;
        // Bounds of pull and push (README: "More than the fabric has"), then the stable limit, κ = 1.3.
        mu = bounds.given::<GIVES>(mu);
        mu_far = mu;
        mu = bounds.borne::<E, CONTACT>(simd, edges, factors, &mut taut, e, mu, d);
        // Δx_{e+1} = w_{e+1} (μ_e d_e − μ_{e+1} d_{e+1}).
        let push = Factor(mu) * d;
        apply::<S, CONTACT>(simd, lines, lines.at(e + 1), far, push - pull);
        (far, pull) = (near, push);
    }
    // Δx_0 = −w_0 μ_0 d_0.
    apply::<S, CONTACT>(simd, lines, lines.at(0), far, nothing - pull);
    taut
}
