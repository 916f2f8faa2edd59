//! Contact of a particle with a surface: no penetration, Coulomb friction, no bounce.
//!
//! The chain solver looks for contacts twice in a substep. Before the solve, particles are pushed out and their contacts noted (normal and
//! depth), without friction; the lines then move these particles along the surface alone. After the solve, the remaining depth is pushed
//! out, and friction acts with the depth of both times, because the whole push presses the two together.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::lanes::{Factor, Shared, SharedPoints, V3, Window};
use crate::{numbers::Numbers, points::Points};

/// Path of a particle through a substep, relative to the collider: from `from` to `to` \[m\].
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Position at the start of the substep.
    pub from: Vec3,
    /// Position at the end of the substep.
    pub to: Vec3,
}

impl Path {
    /// Resolves a contact with a surface of unit `normal` that `to` lies `depth` \[m\] below.
    ///
    /// 1. `to` is pushed out along the normal.
    /// 2. The tangential displacement relative to the surface (which itself moves by `surface` \[m\]) is taken back, by `most` \[m\] at
    ///    most: friction times the depth that presses the two together.
    /// 3. Any motion away from the surface that is left comes from the push alone, so `from` follows: a particle that was inside does not
    ///    pop out with a speed.
    #[inline]
    pub fn resolve(self, normal: Vec3, depth: f32, most: f32, surface: Vec3) -> Self {
        let mut to = self.to + normal * depth;
        let moved = to - self.from;
        let away = normal.dot(moved);
        let sliding = moved - normal * away - surface;
        let length = sliding.length();
        if length <= most {
            to -= sliding;
        } else {
            to -= sliding * (most / length);
        }
        Self {
            from: self.from + normal * away.max(0.0),
            to,
        }
    }
}

/// Contacts of a cloth's particles, noted before its constraints are solved.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Unit normals, 0 without contact; shorter where a particle carries a part of a body.
    pub normal: Points,
    /// Depth by which each particle was pushed out \[m\].
    pub depth: Numbers,
    /// Impulse of the constraints on each particle along its normal \[N s\] · substep; empty where no particle carries a part of a body.
    pub pressed: Numbers,
    /// True if there are any contacts.
    pub any: bool,
}

impl Contacts {
    /// Forgets all contacts, and sets `any` to false.
    pub fn clear(&mut self) {
        self.normal.clear();
        self.depth.clear();
        self.pressed.clear();
        self.any = false;
    }

    /// Forgets all contacts of `len` particles.
    pub fn reset(&mut self, len: usize) {
        if !self.any && self.depth.len() == len {
            return;
        }
        self.normal.clear();
        self.normal.resize(len, 0.0);
        self.depth.clear();
        self.depth.resize(len, 0.0);
        self.any = false;
    }
}

/// Record of the contacts of a cloth in a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// True if the cloth touched anything.
    pub any: bool,
    /// True if, in this step, any particle was inside a collider that it did not enter by its own motion.
    pub overlaps: bool,
    /// Largest displacement, since the start of the substep, of a collider that it touches \[m\].
    pub swept: f32,
    /// Number of colliders that it touches.
    pub colliders: usize,
}

/// Time within the substep at which contacts are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Before the constraints are solved: particles are pushed out and contacts noted, without friction.
    Approach,
    /// After the solve, with friction.
    Final,
}

/// Particles of a cloth against colliders.
#[derive(Clone, Copy)]
pub struct Touching<'a> {
    pub position: SharedPoints<'a>,
    pub previous: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Normals and depths; `None` where contacts are not noted.
    pub contacts: Option<(SharedPoints<'a>, Shared<'a>)>,
    pub phase: Phase,
    /// Treatment of particles that are already inside.
    pub out: Out<'a>,
}

/// Treatment of particles that were inside a collider at the start of the substep.
#[derive(Clone, Copy)]
pub struct Out<'a> {
    /// Largest distance by which such a particle is pushed out \[m\].
    pub most: f32,
    /// Set to true where there is such a particle, and `most` bounds its push.
    pub overlaps: &'a AtomicBool,
}

/// Noted contacts of particles side by side.
#[derive(Clone, Copy)]
pub struct Known<'a, S: Simd> {
    normal: V3<S>,
    depth: S::f32s,
    phase: Phase,
    out: Out<'a>,
}

impl<'a> Touching<'a> {
    /// Checks that each array has one element for each particle, and that the range lies within.
    ///
    /// # Panics
    /// When one of these does not hold.
    pub fn check(&self, range: &Range<usize>) {
        let len = self.inv_mass.len();
        let contacts = self
            .contacts
            .is_none_or(|(normal, depth)| normal.is_of(len) && depth.len() == len);
        let all = self.position.is_of(len) && self.previous.is_of(len) && range.end <= len;
        assert!(
            all && contacts,
            "one of each for {len} particles, {range:?} of them"
        );
    }

    #[inline(always)]
    pub fn known<S: Simd>(self, simd: S, window: Window) -> Known<'a, S> {
        match (self.contacts, self.phase) {
            (Some((normal, depth)), Phase::Final) => Known {
                normal: normal.load_at(simd, window, 0),
                depth: depth.load_at(simd, window, 0),
                phase: self.phase,
                out: self.out,
            },
            _ => Known {
                normal: V3::splat(simd, Vec3::ZERO),
                depth: S::f32s::splat(simd, 0.0),
                phase: self.phase,
                out: self.out,
            },
        }
    }

    /// Stores the paths of touching particles, and notes contacts.
    #[inline(always)]
    pub fn store<S: Simd>(
        self,
        simd: S,
        window: Window,
        touching: S::mask32s,
        [from, to]: [V3<S>; 2],
        normal: V3<S>,
        depth: S::f32s,
    ) {
        let before: V3<S> = self.previous.load_at(simd, window, 0);
        self.previous
            .store_at(simd, window, 0, from.select(touching, before));
        let before: V3<S> = self.position.load_at(simd, window, 0);
        self.position
            .store_at(simd, window, 0, to.select(touching, before));
        if let (Some((normals, depths)), Phase::Approach) = (self.contacts, self.phase) {
            let before: V3<S> = normals.load_at(simd, window, 0);
            normals.store_at(simd, window, 0, normal.select(touching, before));
            let before = depths.load_at(simd, window, 0);
            depths.store_at::<S>(simd, window, 0, touching.select(depth, before));
        }
    }
}

impl<S: Simd> Known<'_, S> {
    /// Mask of the particles (relative to the centre of a sphere) that were in contact with it and are no further above it than they were
    /// below.
    #[inline(always)]
    pub fn stays(self, simd: S, to: V3<S>, radius: S::f32s) -> S::mask32s {
        let zero = S::f32s::splat(simd, 0.0);
        let reach = radius + self.depth;
        let same = to.dot(self.normal).simd_gt(radius * 0.7);
        self.depth.simd_gt(zero) & same & to.dot(to).simd_lt(reach * reach)
    }

    /// Mask of the particles that were in contact with something and are no further above a surface than they were below.
    #[inline(always)]
    pub fn within(self, simd: S, height: S::f32s) -> S::mask32s {
        self.depth.simd_gt(S::f32s::splat(simd, 0.0)) & height.simd_lt(self.depth)
    }

    /// Mask of the particles that were in contact with a surface of this normal and are no further above it than they were below.
    #[inline(always)]
    pub fn along(self, simd: S, normal: V3<S>, height: S::f32s) -> S::mask32s {
        let zero = S::f32s::splat(simd, 0.0);
        let same = normal.dot(self.normal).simd_gt(S::f32s::splat(simd, 0.9));
        self.depth.simd_gt(zero) & same & height.simd_lt(self.depth)
    }

    /// Distances by which particles are pushed out whose paths end this deep inside: the whole depth. A particle that was inside at its
    /// start, deeper than this distance, comes out only by as much as it went in, plus the allowed distance.
    #[inline(always)]
    pub fn pushed(
        self,
        simd: S,
        [from, to]: [V3<S>; 2],
        (normal, depth): (V3<S>, S::f32s),
        touching: S::mask32s,
        depth_at_start: impl FnOnce() -> S::f32s,
    ) -> S::f32s {
        let zero = S::f32s::splat(simd, 0.0);
        let most = normal.dot(from - to).max(zero) + self.out.most;
        let deep = touching & depth.simd_gt(most);
        if !deep.any_true() {
            return depth;
        }
        let inside = deep & depth_at_start().simd_gt(S::f32s::splat(simd, self.out.most));
        if inside.any_true() {
            self.out.overlaps.store(true, Ordering::Relaxed);
        }
        inside.select(most, depth)
    }

    /// Resolves contacts with surfaces of unit normals that the ends of the paths lie `depth` \[m\] below.
    ///
    /// 1. The end is pushed out along the normal.
    /// 2. In the final phase, the tangential displacement relative to the surface (which itself moves by `surface` \[m\]) is taken back, by
    ///    at most the coefficient of friction times the depth plus the noted depth: the push presses the two together.
    /// 3. Any motion away from the surface that is left comes from the push alone, so the start follows: a particle that was inside does
    ///    not pop out with a speed.
    ///
    /// For particles that do not touch, the result has no meaning.
    #[inline(always)]
    pub fn resolve(
        self,
        simd: S,
        touching: S::mask32s,
        [from, to]: [V3<S>; 2],
        (normal, depth): (V3<S>, S::f32s),
        (friction, surface): (f32, V3<S>),
    ) -> [V3<S>; 2] {
        let zero = S::f32s::splat(simd, 0.0);
        let one = S::f32s::splat(simd, 1.0);
        let to = to + Factor(depth) * normal;
        let moved = to - from;
        let away = normal.dot(moved);
        let from_out = from + Factor(away.max(zero)) * normal;
        if self.phase == Phase::Approach {
            return [from_out, to];
        }
        let same = normal.dot(self.normal).simd_gt(S::f32s::splat(simd, 0.7));
        let most = (depth + same.select(self.depth, zero)) * friction;
        let sliding = moved - Factor(away) * normal - surface;
        let length2 = sliding.dot(sliding);
        let slips = touching & length2.simd_gt(most * most);
        let mut kept = one;
        if slips.any_true() {
            kept = slips.select(most / length2.sqrt(), one);
        }
        [from_out, to - Factor(kept) * sliding]
    }
}

/// Unit vectors along vectors of these lengths; up where the length is 0.
#[inline(always)]
pub fn unit<S: Simd>(simd: S, v: V3<S>, length: S::f32s) -> V3<S> {
    let any = length.simd_gt(S::f32s::splat(simd, 1e-15));
    let unit = Factor(S::f32s::splat(simd, 1.0) / length) * v;
    unit.select(any, V3::splat(simd, Vec3::Y))
}

/// Largest relative deviation of a squared length from the expected one for which the series below is used.
const ABOUT: f32 = 0.02;

/// Unit vectors along `v`, where `meant`; up where the length is 0. Vectors of about the expected length need no root and no quotient: for
/// them 1/√(1 + e) is 1 − e/2 + 3e²/8 − 5e³/16 + 35e⁴/128, to within 10⁻⁹.
#[inline(always)]
pub fn unit_of_about<S: Simd>(simd: S, v: V3<S>, expected: f32, meant: S::mask32s) -> V3<S> {
    let square = v.dot(v);
    let e = square * expected.powi(-2) - 1.0;
    let series = (((e * (35.0 / 128.0) - 5.0 / 16.0) * e + 3.0 / 8.0) * e - 0.5) * e + 1.0;
    let about = e.abs().simd_lt(S::f32s::splat(simd, ABOUT));
    let unit_of_series = Factor(series * expected.recip()) * v;
    let others = meant & !about;
    if others.any_true() {
        return unit_of_series.select(about, unit(simd, v, square.sqrt()));
    }
    unit_of_series
}
