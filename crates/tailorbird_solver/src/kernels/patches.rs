//! Particles against a triangle mesh, with one contact plane for each particle.
//!
//! The plane touches the surface at the point nearest to the particle, and is valid as long as the particle stays near the position at
//! which the plane was computed. In most substeps of most particles it does, and a contact costs as much as one with a plane.

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Reading, V3, Window, each_window},
    solid::{DistanceFunction, Distances, Motion},
};
use crate::{numbers::Numbers, points::Points};
use std::ops::Range;

/// Cached contact planes of a cloth's particles, in the axes of the mesh.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// Unit normals.
    pub normal: Points,
    /// Distances of the planes from the origin \[m\].
    pub offset: Numbers,
    /// Positions of the particles when their planes were computed \[m\].
    pub place: Points,
    /// Distance from `place` within which the plane is valid \[m\]; negative where there is no plane yet.
    pub holds: Numbers,
}

impl Patches {
    /// Forgets the planes of all `len` particles.
    pub fn reset(&mut self, len: usize) {
        for points in [&mut self.normal, &mut self.place] {
            points.clear();
            points.resize(len, 0.0);
        }
        for numbers in [&mut self.offset, &mut self.holds] {
            numbers.clear();
            numbers.resize(len, -1.0);
        }
    }

    /// Sets the plane of particle `i`: through `point`, with this unit normal.
    pub fn set(&mut self, i: usize, point: Vec3, normal: Vec3, place: Vec3, holds: f32) {
        self.normal.set(i, normal);
        self.offset[i] = normal.dot(point);
        self.place.set(i, place);
        self.holds[i] = holds;
    }

    /// Height of a point above the plane of particle `i` \[m\].
    pub fn height(&self, i: usize, point: Vec3) -> f32 {
        self.normal.get(i).dot(point) - self.offset[i]
    }
}

/// Planes of a cloth's particles, as a solid.
#[derive(Clone, Copy, Debug)]
pub struct ContactPlanes<'a> {
    pub patches: &'a Patches,
    /// Distance that is kept from the planes \[m\].
    pub margin: f32,
}

impl DistanceFunction for ContactPlanes<'_> {
    const CONVEX: bool = false;
    const COMMON: bool = true;

    #[inline(always)]
    fn size(&self) -> f32 {
        f32::MAX
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, window: Window, p: V3<S>) -> Distances<S> {
        let out = self.patches.normal.window(simd, window, 0);
        let offset = Reading(&self.patches.offset).load_at(simd, window);
        Distances {
            distance: out.dot(p) - offset - self.margin,
            out,
            // A unit vector, or 0 without a plane.
            length: out.dot(out),
        }
    }
}

/// Calls `found` for each free particle of a range whose plane is no longer valid, in order.
pub fn outdated(
    level: Level,
    patches: &Patches,
    motion: &Motion,
    (position, inv_mass): (&Points, &[f32]),
    range: Range<usize>,
    found: impl FnMut(usize),
) {
    dispatch!(level, simd => outdated_with(simd, patches, motion, (position, inv_mass), range, found));
}

#[inline(always)]
fn outdated_with<S: Simd>(
    simd: S,
    patches: &Patches,
    motion: &Motion,
    (position, inv_mass): (&Points, &[f32]),
    range: Range<usize>,
    mut found: impl FnMut(usize),
) {
    let zero = S::f32s::splat(simd, 0.0);
    let one = S::f32s::splat(simd, 1.0);
    let to = V3::splat(simd, motion.to);
    let inverse = motion.axes.transpose();
    each_window(
        simd,
        range,
        #[inline(always)]
        |window| {
            let place: V3<S> = patches.place.window(simd, window, 0);
            let local = super::solid::turned(inverse, position.window(simd, window, 0) - to);
            let moved = local - place;
            let holds = Reading(&patches.holds).load_at(simd, window);
            let free = Reading(inv_mass).load_at(simd, window).simd_gt(zero);
            let valid = holds.simd_ge(zero) & moved.dot(moved).simd_le(holds * holds);
            let out = free & window.todo(simd) & !valid;
            if out.any_true() {
                let lanes = out.select(one, zero);
                for (k, lane) in lanes.as_slice().iter().enumerate() {
                    if *lane != 0.0 {
                        found(window.at + k);
                    }
                }
            }
        },
    );
}
