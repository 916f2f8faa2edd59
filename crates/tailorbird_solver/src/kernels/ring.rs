//! Closed chains: all distance constraints around a ring at once.
//!
//! A ring of n edges is a chain of n + 1 particles whose last is its first, and its last edge, the closing one, meets the first there. So
//! the system of `line` has two more entries, in the corners. The first edge is left out at first. Elimination of the others keeps their
//! dependence on it, μ_e = A_e + B_e μ_0, so that one unknown is left in the row of the first edge,
//!
//! - (D_0 − b_1 B_1 − b_n B_{n−1}) μ_0 = r_0 + b_1 A_1 + b_n A_{n−1}
//!
//! with b_1 and b_n for the off-diagonal entries of the first edge with the second and the closing edge (Temperton 1975). Then substitution
//! goes on as in `line`. Lanes may have rings of different lengths, and open chains, which have no closing edge: b_n = 0.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    edges::Edges,
    lanes::{Factor, Shared, SharedPoints, V3, WIDEST},
    lines::{FREE, Lines, NO_MASS, PRESSED, apply},
    row::{beside, own},
    share::{TensionBounds, share},
};
use crate::topology::chains::OPEN;

/// Solves as many chains as a vector has lanes, each in the form of columns, side by side from the first on. `closing` has for each lane
/// its closing edge, or [`OPEN`]; `factors` is scratch of at least 2 · len · lanes.
#[inline(always)]
pub fn solve<S: Simd, E: Edges<S>, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    edges: E,
    bears: S::f32s,
    closing: &[u32],
    factors: Shared,
) {
    let ring = Ring::<S, E, CONTACT> {
        simd,
        lines,
        edges,
        factors,
        last: last_edges(simd, closing),
        d: lines.particle(simd, 1) - lines.particle(simd, 0),
        w: lines.weight(simd, 0),
        n: normal::<S, CONTACT>(simd, lines, 0),
    };
    let first = ring.first_multiplier();
    let bounds = TensionBounds::new(bears, lines.give);
    let taut = if bounds.gives() {
        ring.substitute::<true>(first, bounds)
    } else {
        ring.substitute::<false>(first, bounds)
    };
    let joints = Joints { lines, closing };
    joints.copy::<S, CONTACT>();
    if CONTACT != PRESSED && !taut.is_empty() {
        // First all other particles, with the joints held, then the joints.
        let w = joints.hold::<S>();
        let pulls = taut.clone();
        simd.vectorize(
            #[inline(always)]
            || share::<S, CONTACT>(simd, lines, factors, pulls),
        );
        joints.share::<S, CONTACT>(factors, &taut, w);
    }
}

/// Joints of rings: the particle at which a ring starts and ends, stored twice.
#[derive(Clone, Copy)]
struct Joints<'a> {
    lines: Lines<'a>,
    closing: &'a [u32],
}

impl Joints<'_> {
    /// Lanes that are rings, with their closing edges.
    #[inline(always)]
    fn rings<S: Simd>(self) -> impl Iterator<Item = (usize, usize)> {
        let lanes = self.closing[..S::f32s::LEN].iter().enumerate();
        lanes
            .filter(|(_, edge)| **edge != OPEN)
            .map(|(lane, edge)| (lane, *edge as usize))
    }

    /// Copies the first particle to the last.
    #[inline(always)]
    fn copy<S: Simd, const CONTACT: u8>(self) {
        let (SharedPoints { x, y, z }, pressed) = (self.lines.position, self.lines.pressed);
        for (lane, edge) in self.rings::<S>() {
            let [first, last] = [0, edge + 1].map(|k| self.lines.at(k) + lane);
            for of in [x, y, z] {
                of.set(last, of.get(first));
            }
            if CONTACT == PRESSED {
                pressed.set(last, pressed.get(first));
            }
        }
    }

    /// Makes the joints kinematic. Returns their inverse masses.
    #[inline(always)]
    fn hold<S: Simd>(self) -> [f32; WIDEST] {
        let inv_mass = self.lines.inv_mass;
        let mut had = [0.0; WIDEST];
        for (lane, edge) in self.rings::<S>() {
            let [first, last] = [0, edge + 1].map(|k| self.lines.at(k) + lane);
            had[lane] = inv_mass.get(first);
            inv_mass.set(first, 0.0);
            inv_mass.set(last, 0.0);
        }
        had
    }

    /// Moves each joint by the tension beyond the stable limit of its edges, which is noted for the edges `taut`. All other particles have
    /// been moved before, as if the joint were held. The rest of the system of `share` has entries in the corners, as that of a ring's
    /// edges, and is solved like it: y_k = A_k + B_k y_0.
    ///
    /// With particles in contact B would be a matrix. There the joint alone moves, and the sum to be minimised falls as well.
    #[inline(always)]
    fn share<S: Simd, const CONTACT: u8>(
        self,
        factors: Shared,
        taut: &Range<usize>,
        w: [f32; WIDEST],
    ) {
        let Lines {
            position,
            inv_mass,
            normal,
            shared,
            ..
        } = self.lines;
        let lanes = S::f32s::LEN;
        for (lane, edge) in self.rings::<S>() {
            let tension = |e: usize| {
                if taut.contains(&e) {
                    factors.get((2 * e + 1) * lanes + lane)
                } else {
                    0.0
                }
            };
            let at = |k: usize| self.lines.at(k) + lane;
            let get = |of: SharedPoints, k: usize| {
                let i = at(k);
                Vec3::new(of.x.get(i), of.y.get(i), of.z.get(i))
            };
            let set = |k: usize, place: Vec3| {
                let i = at(k);
                position.x.set(i, place.x);
                position.y.set(i, place.y);
                position.z.set(i, place.z);
            };
            let [first, last] = [tension(0), tension(edge)];
            if first + last == 0.0 {
                continue;
            }
            let follows = shared.x;
            let mut gain = 0.0;
            for k in 1..=edge {
                let mut part = 0.0;
                if CONTACT == FREE {
                    let [before, after] = [tension(k - 1), tension(k)];
                    let w = inv_mass.get(at(k));
                    let pivot = 1.0 + w * (after + before * (1.0 - gain));
                    part = w
                        * before
                        * if k == 1 {
                            1.0
                        } else {
                            follows.get((k - 1) * lanes + lane)
                        };
                    if k == edge {
                        part += w * after;
                    }
                    part /= pivot;
                    gain = if k == edge { 0.0 } else { w * after / pivot };
                }
                factors.set(2 * k * lanes + lane, gain);
                follows.set(k * lanes + lane, part);
            }
            let mut next = 0.0;
            for k in (1..=edge).rev() {
                let i = k * lanes + lane;
                next = follows.get(i) + factors.get(2 * k * lanes + lane) * next;
                follows.set(i, next);
            }

            let place = get(position, 0);
            let mut push =
                first * (get(position, 1) - place) + last * (get(position, edge) - place);
            if CONTACT != FREE {
                let normal = get(normal, 0);
                push -= normal.dot(push) * normal;
            }
            let kept = |k: usize| 1.0 - follows.get(k * lanes + lane);
            let w = w[lane];
            let moved = w / (1.0 + w * (first * kept(1) + last * kept(edge))) * push;
            for k in [0, edge + 1] {
                set(k, place + moved);
            }
            if CONTACT == FREE {
                for k in 1..=edge {
                    set(k, get(position, k) + follows.get(k * lanes + lane) * moved);
                }
            }
        }
    }
}

/// Indices of the closing edges; −1 where there is none.
#[inline(always)]
fn last_edges<S: Simd>(simd: S, closing: &[u32]) -> S::f32s {
    let mut last = [-1.0; WIDEST];
    for (last, &edge) in last.iter_mut().zip(closing) {
        if edge != OPEN {
            *last = edge as f32;
        }
    }
    S::f32s::from_slice(simd, &last[..S::f32s::LEN])
}

#[inline(always)]
fn normal<S: Simd, const CONTACT: u8>(simd: S, lines: Lines, k: usize) -> V3<S> {
    if CONTACT == FREE {
        V3::splat(simd, Vec3::ZERO)
    } else {
        lines.normal(simd, k)
    }
}

/// A ring in each lane.
#[derive(Clone, Copy)]
struct Ring<'a, S: Simd, E, const CONTACT: u8> {
    simd: S,
    lines: Lines<'a>,
    edges: E,
    factors: Shared<'a>,
    /// Indices of the closing edges.
    last: S::f32s,
    /// The first edge, and the inverse mass and the normal of the joint, the particle between the first and the closing edge.
    d: V3<S>,
    w: S::f32s,
    n: V3<S>,
}

impl<S: Simd, E: Edges<S>, const CONTACT: u8> Ring<'_, S, E, CONTACT> {
    /// Number of edges of the longest lane.
    #[inline(always)]
    fn count(self) -> usize {
        self.lines.len - 1
    }

    /// `value` in the lanes whose closing edge is `e`, and 0 in the others.
    #[inline(always)]
    fn if_last(self, e: usize, value: S::f32s) -> S::f32s {
        let edge = S::f32s::splat(self.simd, e as f32);
        let zero = S::f32s::splat(self.simd, 0.0);
        self.last.simd_eq(edge).select(value, zero)
    }

    /// Eliminates all edges but the first, and solves for the multiplier of the first.
    #[inline(always)]
    fn first_multiplier(self) -> S::f32s {
        let Self { simd, lines, .. } = self;
        let lanes = S::f32s::LEN;
        let zero = S::f32s::splat(simd, 0.0);
        let one = S::f32s::splat(simd, 1.0);
        let least_w = S::f32s::splat(simd, NO_MASS);
        let mut a = lines.particle(simd, 1);
        let mut w_a = lines.weight(simd, 1);
        let mut n_a = normal::<S, CONTACT>(simd, lines, 1);
        let first = self.edges.at(simd, 0);
        let own_of = |edge, d, w, n| own::<S, CONTACT>(simd, lines.give, edge, d, w, n);
        let [diagonal_of_first, mut side_of_first] =
            own_of(first, self.d, [self.w, w_a], [self.n, n_a]);
        let mut left_of_first = diagonal_of_first;

        let (mut d_before, mut inv_pivot, mut g, mut h) = (self.d, zero, zero, zero);
        let mut second = zero;
        for e in 1..self.count() {
            let b = lines.particle(simd, e + 1);
            let w_b = lines.weight(simd, e + 1);
            let n_b = normal::<S, CONTACT>(simd, lines, e + 1);
            let d = b - a;
            let [diagonal, side] = own_of(self.edges.at(simd, e), d, [w_a, w_b], [n_a, n_b]);
            let mut before = beside::<S, CONTACT>(w_a, d_before, d, n_a);
            let mut owed = self.if_last(e, beside::<S, CONTACT>(self.w, d, self.d, self.n));
            if e == 1 {
                owed += before;
                (second, before) = (before, zero);
            }
            let factor = before * inv_pivot;
            inv_pivot = one / (diagonal - before * factor);
            g = (side + before * g) * inv_pivot;
            h = (owed + before * h) * inv_pivot;
            let slot = 2 * e * lanes;
            self.factors.store::<S>(slot, factor);
            self.factors.store::<S>(slot + lanes, g);
            lines.shared.x.store::<S>(e * lanes, h);
            (a, w_a, n_a, d_before) = (b, w_b, n_b, d);
        }

        // μ_e = A_e + B_e μ_0.
        let (mut alone, mut by_first, mut factor) = (zero, zero, zero);
        let mut b = lines.particle(simd, self.count());
        for e in (1..self.count()).rev() {
            let slot = 2 * e * lanes;
            alone = self.factors.load(simd, slot + lanes) + factor * alone;
            by_first = lines.shared.x.load(simd, e * lanes) + factor * by_first;
            factor = self.factors.load(simd, slot);
            let a = lines.particle(simd, e);
            let mut owed = self.if_last(e, beside::<S, CONTACT>(self.w, b - a, self.d, self.n));
            if e == 1 {
                owed += second;
            }
            side_of_first += owed * alone;
            left_of_first -= owed * by_first;
            b = a;
        }
        // For a ring of which all particles lie in one place, rounding may leave less.
        let least = diagonal_of_first * lines.give.compliance;
        side_of_first / left_of_first.max(least).max(least_w)
    }

    /// Substitutes back from the multiplier of the first edge. Returns the range of edges whose tension beyond the stable limit [`share`]
    /// needs.
    #[inline(always)]
    fn substitute<const GIVES: bool>(
        self,
        first: S::f32s,
        bounds: TensionBounds<S>,
    ) -> Range<usize> {
        let Self {
            simd,
            lines,
            edges,
            factors,
            ..
        } = self;
        let lanes = S::f32s::LEN;
        let (nothing, zero) = (V3::splat(simd, Vec3::ZERO), S::f32s::splat(simd, 0.0));
        let mut range = 0..0;
        let mut at = |e: usize, mu: S::f32s, d: V3<S>| {
            bounds.borne::<E, CONTACT>(simd, edges, factors, &mut range, e, mu, d)
        };
        let first = bounds.given::<GIVES>(first);
        let mut by_closing = nothing;
        let (mut pull, mut mu_far, mut factor) = (nothing, zero, zero);
        let mut far = lines.particle(simd, self.count());
        for e in (1..self.count()).rev() {
            let near = lines.particle(simd, e);
            let slot = 2 * e * lanes;
            let h = lines.shared.x.load(simd, e * lanes);
            let mu = (factors.load(simd, slot + lanes) + h * first) + factor * mu_far;
            factor = factors.load(simd, slot);
            mu_far = bounds.given::<GIVES>(mu);
            let d = far - near;
            let push = Factor(at(e, mu_far, d)) * d;
            let is_last = self.last.simd_eq(S::f32s::splat(simd, e as f32));
            by_closing = push.select(is_last, by_closing);
            apply::<S, CONTACT>(simd, lines, lines.at(e + 1), far, push - pull);
            (far, pull) = (near, push);
        }
        let push = Factor(at(0, first, self.d)) * self.d;
        apply::<S, CONTACT>(simd, lines, lines.at(1), far, push - pull);
        let near = lines.particle(simd, 0);
        apply::<S, CONTACT>(simd, lines, lines.at(0), near, by_closing - push);
        range
    }
}
