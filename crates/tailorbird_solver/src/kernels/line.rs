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
//!
//! With `BEND`, the triples k, k+1, k+2 resist bending in the same sweep: D = x_k − 2 x_{k+1} + x_{k+2} is pulled towards 0, by
//! Δx = ∓w D/max(α̃ + W/2, W) with W = w_k + 4 w_{k+1} + w_{k+2}. The sum α̃ + W of position-based dynamics would be too soft at
//! rest: multipliers start at 0 in each substep, and half of the change of D by the other triples comes later in the pass.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    edges::{Edges, Whole},
    lanes::{Factor, Shared, V3},
    lines::{FREE, Lines, NO_MASS, PRESSED, apply},
    row::{beside, own},
    share::{TensionBounds, share},
};

/// State of the sweep forward: the particles a, b, c = e, e+1, e+2 around the edge e, and the last row of the elimination.
struct Sweep<'a, S: Simd, E> {
    simd: S,
    lines: Lines<'a>,
    edges: E,
    /// α̃ of the triples [1/kg].
    bend: S::f32s,
    factors: Shared<'a>,
    a: V3<S>,
    b: V3<S>,
    c: V3<S>,
    w_a: S::f32s,
    w_b: S::f32s,
    w_c: S::f32s,
    n_a: V3<S>,
    weights: Weights<S>,
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
pub fn solve<S: Simd, E: Edges<S>, const BEND: bool, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    edges: E,
    Whole { bend, bears }: Whole<S>,
    factors: Shared,
) {
    if lines.len < 2 {
        return;
    }
    // Elimination forward, edge by edge.
    let mut sweep = Sweep::start::<BEND, CONTACT>(simd, lines, edges, bend, factors);
    // First the edges that have a triple beyond them, then the last ones.
    let inner = if BEND { lines.len.saturating_sub(3) } else { 0 };
    for e in 0..inner {
        sweep.advance::<BEND, CONTACT, true>(e);
    }
    for e in inner..lines.len - 1 {
        sweep.advance::<BEND, CONTACT, false>(e);
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
    fn start<const BEND: bool, const CONTACT: u8>(
        simd: S,
        lines: Lines<'a>,
        edges: E,
        bend: S::f32s,
        factors: Shared<'a>,
    ) -> Self {
        let (nothing, zero) = (V3::splat(simd, Vec3::ZERO), S::f32s::splat(simd, 0.0));
        let mut s = Self {
            simd,
            lines,
            edges,
            bend,
            factors,
            a: lines.particle(simd, 0),
            b: lines.particle(simd, 1),
            c: nothing,
            w_a: lines.weight(simd, 0),
            w_b: lines.weight(simd, 1),
            w_c: zero,
            n_a: nothing,
            weights: Weights {
                parts: [zero; 3],
                run: 0,
            },
            d: nothing,
            inv_pivot: zero,
            g: zero,
        };
        if CONTACT != FREE {
            s.n_a = lines.normal(simd, 0);
        }
        if BEND && lines.len > 2 {
            (s.c, s.w_c) = (lines.particle(simd, 2), lines.weight(simd, 2));
            s.weights.of_triple(simd, [s.w_a, s.w_b, s.w_c], bend);
            (s.a, s.b, s.c) = bend_triple([s.a, s.b, s.c], s.weights.parts);
        }
        if BEND {
            lines.bent.store(0, s.a);
        }
        s
    }

    /// Bends the triple e + 1, e + 2, e + 3, if there is one (`TRIPLE`), and eliminates the edge e.
    #[inline(always)]
    fn advance<const BEND: bool, const CONTACT: u8, const TRIPLE: bool>(&mut self, e: usize) {
        let s = self;
        let (simd, lines) = (s.simd, s.lines);
        let (mut next, mut w_next) = (s.c, s.w_c);
        // Bending: Δx = ∓w D/max(α̃ + W/2, W) for the triple e + 1, e + 2, e + 3.
        if TRIPLE {
            (next, w_next) = (lines.particle(simd, e + 3), lines.weight(simd, e + 3));
            s.weights.of_triple(simd, [s.w_b, s.w_c, w_next], s.bend);
            (s.b, s.c, next) = bend_triple([s.b, s.c, next], s.weights.parts);
        }
        if BEND {
            lines.bent.store((e + 1) * S::f32s::LEN, s.b);
        } else if e + 2 < lines.len {
            (s.c, s.w_c) = (lines.particle(simd, e + 2), lines.weight(simd, e + 2));
        }

        // Row e of the system: (w_e + w_{e+1}) |d_e|² + α̃ L² on the diagonal, (L² − |d_e|²)/2 on the right side.
        let d = s.b - s.a;
        let n_b = if CONTACT == FREE {
            s.n_a
        } else {
            lines.normal(simd, e + 1)
        };
        let (edge, w, n) = (s.edges.at(simd, e), [s.w_a, s.w_b], [s.n_a, n_b]);
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
        (s.a, s.b, s.c) = (s.b, s.c, next);
        (s.w_a, s.w_b, s.w_c) = (s.w_b, s.w_c, w_next);
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
    let mut far: V3<S> = lines.bent.load(simd, (m - 1) * lanes);
    let (mut pull, mut mu_far, mut factor) = (nothing, zero, zero);
    let mut taut = 0..0;
    for e in (0..m - 1).rev() {
        let near = lines.bent.load(simd, e * lanes);
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

/// Displacements of the first end, the middle and the last end of a triple, for D = 1.
struct Weights<S: Simd> {
    parts: [S::f32s; 3],
    /// Number of successive particles whose inverse mass equals that of the particle before, in all lanes.
    run: usize,
}

impl<S: Simd> Weights<S> {
    /// Computes the weights of the next triple. They depend on the masses alone: where four masses in a row are equal, those of the triple
    /// before are kept, which saves a division.
    #[inline(always)]
    fn of_triple(&mut self, simd: S, [w_a, w_b, w_c]: [S::f32s; 3], alpha_tilde: S::f32s) {
        self.run = if w_b.simd_eq(w_c).all_true() {
            self.run + 1
        } else {
            0
        };
        if self.run >= 3 {
            return;
        }
        let w = (w_a + w_c) + w_b * 4.0;
        let least = S::f32s::splat(simd, NO_MASS);
        let part = S::f32s::splat(simd, 1.0) / (w * 0.5 + alpha_tilde).max(w).max(least);
        self.parts = [w_a * part, (w_b + w_b) * part, w_c * part];
    }
}

/// Pulls D = a − 2 b + c towards 0.
#[inline(always)]
fn bend_triple<S: Simd>(
    [a, b, c]: [V3<S>; 3],
    [k_a, k_b, k_c]: [S::f32s; 3],
) -> (V3<S>, V3<S>, V3<S>) {
    let bow = (a - b) + (c - b);
    (
        a - Factor(k_a) * bow,
        b + Factor(k_b) * bow,
        c - Factor(k_c) * bow,
    )
}
