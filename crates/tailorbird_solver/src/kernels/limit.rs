//! Motion constraints: a particle stays within a ball around its target, and out of a ball behind it.
//!
//! With target t, unit normal n, largest distance r, backstop distance b and radius R:
//!
//! 1. |x − c| ≥ R for c = t − n (b + R): x ← c + R (x − c)/|x − c|
//! 2. |x − t| ≤ r: x ← t + r (x − t)/|x − t|
//!
//! A stopped particle does not come back with a speed of its own: the part of x − x⁻ − u that points away from the ball that stopped it is
//! taken out, where u is the displacement of the target in the substep. So targets that appear on the other side of a particle, or jump, do
//! not throw it.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, Reading, Shared, SharedPoints, V3, Window, each_window};
use crate::points::Points;

/// Targets and distances of all particles.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Targets at the start and at the end of the step \[m\].
    pub targets: [&'a Points; 2],
    /// Parts of the step that have passed at the start and at the end of the substep, 0 to 1.
    pub fractions: (f32, f32),
    /// Largest distance from the target \[m\]; infinite is free.
    pub max_distance: &'a [f32],
    pub backstop: Option<Backstop<'a>>,
}

#[derive(Clone, Copy)]
pub struct Backstop<'a> {
    /// Unit normals at the start and at the end of the step.
    pub normals: [&'a Points; 2],
    /// Distance from the target to the ball \[m\]; infinite is none.
    pub distance: &'a [f32],
    /// Radius of the ball \[m\].
    pub radius: &'a [f32],
}

/// Keeps the free particles (`inv_mass` > 0) of a range within their limits.
///
/// # Panics
/// When an array does not have one element for each particle.
pub fn hold(
    level: Level,
    limits: Limits,
    position: SharedPoints,
    previous: SharedPoints,
    inv_mass: Shared,
    range: Range<usize>,
) {
    let len = inv_mass.len();
    let backstop = limits.backstop.is_none_or(|backstop| {
        backstop.normals.iter().all(|p| p.is_of(len))
            && [backstop.distance, backstop.radius].map(<[f32]>::len) == [len; 2]
    });
    let all = position.is_of(len) && previous.is_of(len) && range.end <= len;
    let targets = limits.targets.iter().all(|p| p.is_of(len));
    assert!(
        all && backstop && targets && limits.max_distance.len() == len,
        "one of each for {len} particles, {range:?} of them"
    );
    dispatch!(level, simd => hold_with(simd, limits, position, previous, inv_mass, range));
}

#[inline(always)]
fn hold_with<S: Simd>(
    simd: S,
    limits: Limits,
    position: SharedPoints,
    previous: SharedPoints,
    inv_mass: Shared,
    range: Range<usize>,
) {
    let zero = S::f32s::splat(simd, 0.0);
    let (from, to) = limits.fractions;
    each_window(
        simd,
        range.clone(),
        #[inline(always)]
        |window| {
            let target = between(simd, limits.targets, window, to);
            let start: V3<S> = position.load_at(simd, window, 0);
            let mut path = Pushed {
                place: start,
                pushed: V3::splat(simd, bevy_math::Vec3::ZERO),
            };
            let mut stopped = zero.simd_gt(zero);
            if let Some(backstop) = limits.backstop {
                let normal = unit(simd, between(simd, backstop.normals, window, to));
                let distance = Reading(backstop.distance).load_at(simd, window);
                let radius: S::f32s = Reading(backstop.radius).load_at(simd, window);
                let center = target - Factor(distance + radius) * normal;
                let d = start - center;
                let q = d.dot(d);
                // Never for an infinite distance.
                let inside = q.simd_lt(radius * radius);
                if inside.any_true() {
                    let out = q.simd_gt(zero);
                    let out =
                        (Factor(S::f32s::splat(simd, 1.0) / q.sqrt()) * d).select(out, normal);
                    path = path.select(inside, center + Factor(radius) * out, out);
                    stopped |= inside;
                }
            }
            let most: S::f32s = Reading(limits.max_distance).load_at(simd, window);
            let d = path.place - target;
            let q = d.dot(d);
            let beyond = q.simd_gt(most * most);
            if beyond.any_true() {
                let inwards = Factor((zero - S::f32s::splat(simd, 1.0)) / q.sqrt()) * d;
                path = path.select(beyond, target - Factor(most) * inwards, inwards);
                stopped |= beyond;
            }
            if stopped.any_true() {
                let stopped = stopped & inv_mass.load_at(simd, window, 0).simd_gt(zero);
                let moved = target - between(simd, limits.targets, window, from);
                let before: V3<S> = previous.load_at(simd, window, 0);
                let away = path.pushed.dot(path.place - before - moved).max(zero);
                let kept = before + Factor(away) * path.pushed;
                position.store_at(simd, window, 0, path.place.select(stopped, start));
                previous.store_at(simd, window, 0, kept.select(stopped, before));
            }
        },
    );
}

/// Positions of particles, and the direction of the last push of each.
#[derive(Clone, Copy)]
struct Pushed<S: Simd> {
    place: V3<S>,
    pushed: V3<S>,
}

impl<S: Simd> Pushed<S> {
    #[inline(always)]
    fn select(self, mask: S::mask32s, place: V3<S>, pushed: V3<S>) -> Self {
        Self {
            place: place.select(mask, self.place),
            pushed: pushed.select(mask, self.pushed),
        }
    }
}

/// Point between two ends, at a fraction of their distance; 0 and 1 give the ends exactly.
#[inline(always)]
fn between<S: Simd>(simd: S, ends: [&Points; 2], window: Window, fraction: f32) -> V3<S> {
    let [from, to] = ends.map(|points| points.window(simd, window, 0));
    let part = |f: f32| Factor(S::f32s::splat(simd, f));
    part(1.0 - fraction) * from + part(fraction) * to
}

/// Vectors scaled to unit length; 0 where there is no direction.
#[inline(always)]
fn unit<S: Simd>(simd: S, v: V3<S>) -> V3<S> {
    let q = v.dot(v);
    let any = q.simd_gt(S::f32s::splat(simd, 1e-30));
    let unit = Factor(S::f32s::splat(simd, 1.0) / q.sqrt()) * v;
    unit.select(any, V3::splat(simd, bevy_math::Vec3::ZERO))
}

#[cfg(test)]
#[path = "limit_tests.rs"]
mod tests;
