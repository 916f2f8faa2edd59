//! The entries of the linear systems of `line` and `ring`.

use fearless_simd::{Simd, prelude::*};

use super::{
    edges::Edge,
    lanes::V3,
    lines::{FREE, Give, LEAST_PIVOT, NO_MASS},
};

/// Diagonal and right side of an edge `d`, from the inverse masses and contact normals of its ends.
#[inline(always)]
pub(super) fn own<S: Simd, const CONTACT: u8>(
    simd: S,
    give: Give,
    Edge { l2, alpha }: Edge<S>,
    d: V3<S>,
    [w_a, w_b]: [S::f32s; 2],
    [n_a, n_b]: [V3<S>; 2],
) -> [S::f32s; 2] {
    let least_w = S::f32s::splat(simd, NO_MASS);
    let quarter = l2 * 0.25;
    let q = d.dot(d);
    let w = w_a + w_b;
    let stretch = alpha.max(w * (l2 * give.compliance));
    let mut diagonal = w * q.max(quarter) + (stretch + least_w);
    if CONTACT != FREE {
        let (along_a, along_b) = (n_a.dot(d), n_b.dot(d));
        diagonal = diagonal - w_a * along_a * along_a - w_b * along_b * along_b;
        diagonal = diagonal.max(w * (l2 * LEAST_PIVOT) + least_w);
    }
    [diagonal, ((l2 - q) * 0.5).min(quarter)]
}

/// Negative off-diagonal of an edge `d` and the edge before it. They meet at a particle of inverse mass `w` and contact normal `n`.
#[inline(always)]
pub(super) fn beside<S: Simd, const CONTACT: u8>(
    w: S::f32s,
    d_before: V3<S>,
    d: V3<S>,
    n: V3<S>,
) -> S::f32s {
    let mut dd = d_before.dot(d);
    if CONTACT != FREE {
        dd -= n.dot(d_before) * n.dot(d);
    }
    w * dd
}
