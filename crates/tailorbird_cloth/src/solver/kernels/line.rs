//! All distance constraints along a chain of particles at once: one Newton step of a tridiagonal system.
//!
//! For the edges k = 0 … m−2 between particles k and k+1 of a chain, with d_k = x_{k+1} − x_k, q_k = |d_k|² and rest length
//! L_k, the constraints are C_k = (q_k − L_k²)/(2 L_k) = 0, whose gradients d_k/L_k need no square root. The multipliers
//! λ_k = L_k μ_k of all edges follow from
//!
//! - diagonal: (w_k + w_{k+1}) q_k + α̃_k L_k²
//! - beside it: −w_{k+1} d_k · d_{k+1}
//! - right side: −(q_k − L_k²)/2
//!
//! by elimination forward and substitution back (Thomas), and Δx_k = w_k (μ_{k−1} d_{k−1} − μ_k d_k). So a correction travels
//! the whole chain in one pass, where relaxation carries it one edge (Goldenthal et al. 2007, Han & Harada 2012).
//!
//! Chains lie side by side, one in each lane: particle k of the chain in lane l is at `offset + k · stride + l`. That is how
//! the columns of a sheet lie in memory; rows are transposed and the chains of a mesh gathered into the same form.
//!
//! Guards: q on the diagonal is at least L²/4, and the right side at most L²/4, as the quadratic form overshoots in strong
//! compression; the diagonal has a relative floor, as a straight chain that is held at both ends is singular.
//!
//! A particle in contact moves along the surface alone: its inverse mass is w (I − n nᵀ), n being the contact's unit normal and
//! 0 where there is none.
//!
//! With `BEND`, the triples k, k+1, k+2 resist bending on the way: D = x_k − 2 x_{k+1} + x_{k+2} is pulled towards 0, by
//! Δx = ∓w D/max(α̃ + W/2, W) with W = w_k + 4 w_{k+1} + w_{k+2}. The sum α̃ + W of position-based dynamics would be too soft at
//! rest: multipliers start at 0 in each substep, and half of what the other triples do to D comes later in the pass.

#![expect(clippy::doc_markdown, reason = "formulas")]

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::lanes::{Factor, Shared, SharedPoints, V3};

/// Inverse masses times square metres below this are none: what is held at both ends is divided by something.
const NO_MASS: f32 = 1e-30;

/// The least diagonal, as a part of (w_k + w_{k+1}) L²: two particles in contact one above the other cannot be moved along
/// their edge.
const LEAST_PIVOT: f32 = 0.05;

/// The part of (w_k + w_{k+1}) L² that is added to the diagonal. With 10⁻⁶ a row that is taut between two pins never came to rest
/// (13 mm/s); with 10⁻⁴ it does, and stretches no more.
const RELATIVE_COMPLIANCE: f32 = 1e-4;

/// Where the chains lie.
#[derive(Clone, Copy)]
pub(crate) struct Lines<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 where there is none; read with `CONTACT` alone.
    pub normal: SharedPoints<'a>,
    /// First particle of the first lane.
    pub offset: usize,
    /// From one particle of a chain to the next.
    pub stride: usize,
    /// Particles of a chain.
    pub len: usize,
}

/// What holds for all edges of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStiffness {
    /// L \[m\].
    pub rest_length: f32,
    /// α̃ = α/h² [1/kg].
    pub stretch: f32,
    /// α̃ of the triples [1/kg]; infinite is without bending.
    pub bend: f32,
}

/// What an edge resists with, for each lane.
#[derive(Clone, Copy)]
pub(crate) struct Edge<S: Simd> {
    /// L² \[m²\].
    pub l2: S::f32s,
    /// α̃ L² \[m²/kg\].
    pub alpha: S::f32s,
}

/// What the edges of chains resist with.
pub(crate) trait Edges: Copy {
    /// Those from the particles `k` to the next.
    fn at<S: Simd>(self, simd: S, k: usize) -> Edge<S>;
}

impl Edges for LineStiffness {
    #[inline(always)]
    fn at<S: Simd>(self, simd: S, _k: usize) -> Edge<S> {
        let l2 = self.rest_length * self.rest_length;
        Edge {
            l2: S::f32s::splat(simd, l2),
            alpha: S::f32s::splat(simd, self.stretch * l2),
        }
    }
}

/// Edges that differ: those of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct MeshLines<'a> {
    /// L \[m\], 0 where there is no edge.
    pub rest_length: &'a [f32],
    /// By what `stretch` is multiplied [-].
    pub scale: &'a [f32],
    /// α̃ of an edge whose scale is 1 [1/kg].
    pub stretch: f32,
    /// From one edge of a chain to the next.
    pub stride: usize,
}

impl Edges for MeshLines<'_> {
    #[inline(always)]
    fn at<S: Simd>(self, simd: S, k: usize) -> Edge<S> {
        let load =
            |values: &[f32]| S::f32s::from_slice(simd, &values[k * self.stride..][..S::f32s::LEN]);
        let length = load(self.rest_length);
        let l2 = length * length;
        Edge {
            l2,
            alpha: load(self.scale) * self.stretch * l2,
        }
    }
}

/// A sweep forward: the particles e, e+1 and e+2 around the edge e, and what the elimination carries on.
struct Sweep<S: Simd> {
    a: V3<S>,
    b: V3<S>,
    c: V3<S>,
    w_a: S::f32s,
    w_b: S::f32s,
    w_c: S::f32s,
    n_a: V3<S>,
    /// The edge before: d, off-diagonal's part of its far end, 1/pivot, solution.
    d: V3<S>,
    inv_pivot: S::f32s,
    g: S::f32s,
}

/// Solves as many chains as a vector has lanes. `factors` is scratch of at least 2 · len · lanes.
///
/// One vector at a time: with two, whose divisions could fill the gaps of one another, the state no longer fits the registers,
/// and a quarter of the speed is lost (AVX-512).
#[inline(always)]
pub(crate) fn solve<S: Simd, E: Edges, const BEND: bool, const CONTACT: bool>(
    simd: S,
    lines: Lines,
    edges: E,
    bend: f32,
    factors: Shared,
) {
    let m = lines.len;
    if m < 2 {
        return;
    }
    let lanes = S::f32s::LEN;
    let at = |k: usize| lines.offset + k * lines.stride;
    let slot = |k: usize| 2 * k * lanes;
    let nothing = V3::splat(simd, Vec3::ZERO);
    let least_w = S::f32s::splat(simd, NO_MASS);
    let bend = S::f32s::splat(simd, bend);
    let zero = S::f32s::splat(simd, 0.0);
    let mut s: Sweep<S> = Sweep {
        a: lines.position.load(simd, at(0)),
        b: lines.position.load(simd, at(1)),
        c: nothing,
        w_a: lines.inv_mass.load(simd, at(0)),
        w_b: lines.inv_mass.load(simd, at(1)),
        w_c: zero,
        n_a: nothing,
        d: nothing,
        inv_pivot: zero,
        g: zero,
    };
    if CONTACT {
        s.n_a = lines.normal.load(simd, at(0));
    }
    if BEND && m > 2 {
        s.c = lines.position.load(simd, at(2));
        s.w_c = lines.inv_mass.load(simd, at(2));
        (s.a, s.b, s.c) = bend_triple(simd, [s.a, s.b, s.c], [s.w_a, s.w_b, s.w_c], bend);
        lines.position.store(at(0), s.a);
    }

    for e in 0..m - 1 {
        let (mut next, mut w_next) = (nothing, S::f32s::splat(simd, 0.0));
        if BEND {
            if e + 3 < m {
                next = lines.position.load(simd, at(e + 3));
                w_next = lines.inv_mass.load(simd, at(e + 3));
                (s.b, s.c, next) =
                    bend_triple(simd, [s.b, s.c, next], [s.w_b, s.w_c, w_next], bend);
            }
            lines.position.store(at(e + 1), s.b);
        } else if e + 2 < m {
            s.c = lines.position.load(simd, at(e + 2));
            s.w_c = lines.inv_mass.load(simd, at(e + 2));
        }

        let Edge { l2, alpha } = edges.at(simd, e);
        let quarter = l2 * 0.25;
        let d = s.b - s.a;
        let q = d.dot(d);
        let w = s.w_a + s.w_b;
        let mut diagonal = w * q.max(quarter) + alpha;
        let mut dd = s.d.dot(d);
        let mut n_b = nothing;
        if CONTACT {
            n_b = lines.normal.load(simd, at(e + 1));
            let (along_a, along_b) = (s.n_a.dot(d), n_b.dot(d));
            diagonal = diagonal - s.w_a * along_a * along_a - s.w_b * along_b * along_b;
            dd -= s.n_a.dot(s.d) * along_a;
        }
        diagonal =
            diagonal.max((w * (l2 * LEAST_PIVOT)).max(least_w)) + w * (l2 * RELATIVE_COMPLIANCE);
        let beside = s.w_a * dd;
        let rhs = ((l2 - q) * 0.5).min(quarter);
        // −beside is the off-diagonal of the edges e − 1 and e.
        let factor = beside * s.inv_pivot;
        let inv_pivot = S::f32s::splat(simd, 1.0) / (diagonal - beside * factor);
        let g = (rhs + beside * s.g) * inv_pivot;
        factors.store::<S>(slot(e), factor);
        factors.store::<S>(slot(e) + lanes, g);

        (s.d, s.inv_pivot, s.g) = (d, inv_pivot, g);
        (s.a, s.b, s.c) = (s.b, s.c, next);
        (s.w_a, s.w_b, s.w_c) = (s.w_b, s.w_c, w_next);
        s.n_a = n_b;
    }

    // μ_e = g_e + factor_{e+1} μ_{e+1}; what moves particle e + 1 is w (μ_e d_e − μ_{e+1} d_{e+1}).
    let mut far: V3<S> = lines.position.load(simd, at(m - 1));
    let (mut pull, mut mu_far, mut factor) = (nothing, zero, zero);
    for e in (0..m - 1).rev() {
        let near = lines.position.load(simd, at(e));
        let mu = factors.load(simd, slot(e) + lanes) + factor * mu_far;
        factor = factors.load(simd, slot(e));
        let push = Factor(mu) * (far - near);
        apply::<S, CONTACT>(simd, lines, at(e + 1), far, push - pull);
        (far, pull, mu_far) = (near, push, mu);
    }
    apply::<S, CONTACT>(simd, lines, at(0), far, nothing - pull);
}

/// Moves particles by what pushes them, along the surface alone where they are in contact.
#[inline(always)]
fn apply<S: Simd, const CONTACT: bool>(
    simd: S,
    lines: Lines,
    i: usize,
    position: V3<S>,
    mut push: V3<S>,
) {
    if CONTACT {
        let n: V3<S> = lines.normal.load(simd, i);
        push = push - Factor(n.dot(push)) * n;
    }
    let w = lines.inv_mass.load(simd, i);
    lines.position.store(i, position + Factor(w) * push);
}

/// Pulls D = a − 2 b + c towards 0.
#[inline(always)]
fn bend_triple<S: Simd>(
    simd: S,
    [a, b, c]: [V3<S>; 3],
    [w_a, w_b, w_c]: [S::f32s; 3],
    alpha_tilde: S::f32s,
) -> (V3<S>, V3<S>, V3<S>) {
    let bow = (a - b) + (c - b);
    let w = (w_a + w_c) + w_b * 4.0;
    let least = S::f32s::splat(simd, NO_MASS);
    let lambda =
        Factor(S::f32s::splat(simd, 1.0) / (w * 0.5 + alpha_tilde).max(w).max(least)) * bow;
    (
        a - Factor(w_a) * lambda,
        b + Factor(w_b + w_b) * lambda,
        c - Factor(w_c) * lambda,
    )
}
