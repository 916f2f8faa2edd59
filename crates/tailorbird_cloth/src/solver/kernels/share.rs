//! Tension that a substep does not stand along edges as they lie acts along them as they will lie.
//!
//! With tension X_k \[kg\] · substep⁻² of the edges k beyond what they bear, particles z_k that have inverse masses W_k = w_k (I − n nᵀ), and
//! the ends of the edges where they will be:
//!
//! - x_k = z_k + W_k (X_k (x_{k+1} − x_k) − X_{k−1} (x_k − x_{k−1}))
//!
//! That is the least of Σ |x − z|²/(2 w) + Σ X |x_{k+1} − x_k|²/2 along the surfaces: no wave grows whatever X is, where the same tension along
//! edges as they lie lets waves grow from κ = 4 w X = 4/3 on. By elimination, x_k = p_k + G_k x_{k+1}: G_k = X_k D, with
//! D = (W_k⁻¹ + X_k + X_{k−1} (I − G_{k−1}))⁻¹. Free particles have numbers in place of the matrices.

#![expect(clippy::doc_markdown, reason = "formulas")]

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{Factor, Shared, SharedPoints, V3},
    line::{FREE, Lines},
};

/// What the elimination leaves: p_k, and G_k where particles are in contact.
#[derive(Clone, Copy)]
pub(crate) struct Scratch<'a> {
    pub place: SharedPoints<'a>,
    pub diagonal: SharedPoints<'a>,
    pub beside: SharedPoints<'a>,
}

/// A symmetric matrix: xx, yy, zz, and yz, zx, xy.
#[derive(Clone, Copy)]
struct Symmetric<S: Simd> {
    diagonal: V3<S>,
    beside: V3<S>,
}

impl<S: Simd> Symmetric<S> {
    #[inline(always)]
    fn by(self, v: V3<S>) -> V3<S> {
        let (d, b) = (self.diagonal, self.beside);
        V3 {
            x: d.x * v.x + b.z * v.y + b.y * v.z,
            y: b.z * v.x + d.y * v.y + b.x * v.z,
            z: b.y * v.x + b.x * v.y + d.z * v.z,
        }
    }

    #[inline(always)]
    fn scaled(self, s: S::f32s) -> Self {
        Self {
            diagonal: Factor(s) * self.diagonal,
            beside: Factor(s) * self.beside,
        }
    }

    /// This less s v vᵀ.
    #[inline(always)]
    fn less(self, s: S::f32s, v: V3<S>) -> Self {
        let u = Factor(s) * v;
        Self {
            diagonal: V3 {
                x: self.diagonal.x - u.x * v.x,
                y: self.diagonal.y - u.y * v.y,
                z: self.diagonal.z - u.z * v.z,
            },
            beside: V3 {
                x: self.beside.x - u.y * v.z,
                y: self.beside.y - u.z * v.x,
                z: self.beside.z - u.x * v.y,
            },
        }
    }

    /// The inverse, of what is at least 1.
    #[inline(always)]
    fn inverse(self, simd: S) -> Self {
        let (d, b) = (self.diagonal, self.beside);
        let diagonal = V3 {
            x: d.y * d.z - b.x * b.x,
            y: d.z * d.x - b.y * b.y,
            z: d.x * d.y - b.z * b.z,
        };
        let beside = V3 {
            x: b.y * b.z - b.x * d.x,
            y: b.z * b.x - b.y * d.y,
            z: b.x * b.y - b.z * d.z,
        };
        let determinant = d.x * diagonal.x + b.z * beside.z + b.y * beside.y;
        Self { diagonal, beside }.scaled(S::f32s::splat(simd, 1.0) / determinant)
    }
}

/// Solves as many chains as a vector has lanes, whose X_k is in the second half of the slots of `factors` for a range of edges, and 0 for
/// all others.
#[inline(always)]
pub(super) fn share<S: Simd, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    factors: Shared,
    edges: Range<usize>,
) {
    if CONTACT == FREE {
        share_free(simd, lines, factors, edges);
    } else {
        share_in_contact(simd, lines, factors, edges);
    }
}

#[inline(always)]
fn tension<S: Simd>(simd: S, factors: Shared, edges: &Range<usize>, k: usize) -> S::f32s {
    if k < edges.end {
        factors.load(simd, (2 * k + 1) * S::f32s::LEN)
    } else {
        S::f32s::splat(simd, 0.0)
    }
}

#[inline(always)]
fn share_free<S: Simd>(simd: S, lines: Lines, factors: Shared, edges: Range<usize>) {
    let lanes = S::f32s::LEN;
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let (mut place, mut gain, mut before) = (V3::splat(simd, Vec3::ZERO), zero, zero);
    for k in edges.start..=edges.end {
        let (z, w) = (lines.particle(simd, k), lines.weight(simd, k));
        let after = tension(simd, factors, &edges, k);
        let (to_near, to_far) = (w * before, w * after);
        let inv_pivot = one / (one + to_far + to_near * (one - gain));
        place = Factor(inv_pivot) * (z + Factor(to_near) * place);
        gain = to_far * inv_pivot;
        before = after;
        factors.store::<S>(2 * k * lanes, gain);
        lines.shared.place.store(k * lanes, place);
    }
    let mut x = place;
    lines.position.store(lines.at(edges.end), x);
    for k in edges.rev() {
        let gain = factors.load(simd, 2 * k * lanes);
        let place: V3<S> = lines.shared.place.load(simd, k * lanes);
        x = place + Factor(gain) * x;
        lines.position.store(lines.at(k), x);
    }
}

#[inline(always)]
fn share_in_contact<S: Simd>(simd: S, lines: Lines, factors: Shared, edges: Range<usize>) {
    let lanes = S::f32s::LEN;
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let least = S::f32s::splat(simd, 1e-6);
    let nothing = V3::splat(simd, Vec3::ZERO);
    let (mut place, mut before) = (nothing, zero);
    let mut gain = Symmetric {
        diagonal: nothing,
        beside: nothing,
    };
    for k in edges.start..=edges.end {
        let (z, w) = (lines.particle(simd, k), lines.weight(simd, k));
        let n: V3<S> = lines.normal(simd, k);
        let after = tension(simd, factors, &edges, k);
        let (to_near, to_far) = (w * before, w * after);
        let all = one + to_far + to_near;
        let minus = gain.scaled(zero - to_near);
        let pivot = Symmetric {
            diagonal: minus.diagonal
                + V3 {
                    x: all,
                    y: all,
                    z: all,
                },
            beside: minus.beside,
        };
        // D/w = (B + c n nᵀ)⁻¹ with c = 1/(1 − n²).
        let inverse = pivot.inverse(simd);
        let a = inverse.by(n);
        let d = inverse.less(one / (one - n.dot(n) + n.dot(a)).max(least), a);
        let near = place - z + gain.by(z);
        place = z + d.by(Factor(to_near) * near - Factor(to_far) * z);
        gain = d.scaled(to_far);
        before = after;
        lines.shared.place.store(k * lanes, place);
        lines.shared.diagonal.store(k * lanes, gain.diagonal);
        lines.shared.beside.store(k * lanes, gain.beside);
    }
    let mut x = place;
    for k in (edges.start..=edges.end).rev() {
        if k < edges.end {
            let gain = Symmetric {
                diagonal: lines.shared.diagonal.load(simd, k * lanes),
                beside: lines.shared.beside.load(simd, k * lanes),
            };
            let place: V3<S> = lines.shared.place.load(simd, k * lanes);
            x = place + gain.by(x);
        }
        lines.position.store(lines.at(k), x);
    }
}
