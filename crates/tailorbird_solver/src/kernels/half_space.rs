//! Particles against a moving half-space: everything below a plane is solid.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    contact::Touching,
    lanes::{V3, each_window},
};

/// A half-space during one substep, in the frame of the particles.
#[derive(Clone, Copy, Debug)]
pub struct MovingHalfSpace {
    /// A point of the plane at the start \[m\].
    pub from: Vec3,
    /// The same point at the end \[m\].
    pub to: Vec3,
    /// Unit normal, out of the solid.
    pub normal: Vec3,
    /// Distance that is kept from the plane \[m\].
    pub margin: f32,
    /// Coulomb friction [-].
    pub friction: f32,
}

/// Keeps all free particles (`inv_mass` > 0) out of a half-space. Returns whether any touches.
pub fn collide_all(
    level: Level,
    plane: &MovingHalfSpace,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    particles.check(&range);
    dispatch!(level, simd => collide_all_with(simd, plane, particles, range))
}

#[inline(always)]
fn collide_all_with<S: Simd>(
    simd: S,
    plane: &MovingHalfSpace,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    let zero = S::f32s::splat(simd, 0.0);
    let margin = S::f32s::splat(simd, plane.margin);
    let normal = V3::splat(simd, plane.normal);
    let (from, to) = (V3::splat(simd, plane.from), V3::splat(simd, plane.to));
    let mut any = false;
    each_window(
        simd,
        range.clone(),
        #[inline(always)]
        |window| {
            let end: V3<S> = particles.position.load_at(simd, window, 0) - to;
            let height = normal.dot(end);
            let contacts = particles.known(simd, window);
            let free = particles.inv_mass.load_at(simd, window, 0).simd_gt(zero);
            let touching =
                free & (height.simd_lt(margin) | contacts.along(simd, normal, height - margin));
            if touching.any_true() {
                any = true;
                let start = particles.previous.load_at(simd, window, 0) - from;
                let depth = (margin - height).max(zero);
                let depth = contacts.pushed(simd, [start, end], (normal, depth), touching, || {
                    margin - normal.dot(start)
                });
                let surface = V3::splat(simd, Vec3::ZERO);
                let path = contacts.resolve(
                    simd,
                    touching,
                    [start, end],
                    (normal, depth),
                    (plane.friction, surface),
                );
                particles.store(
                    simd,
                    window,
                    touching,
                    [path[0] + from, path[1] + to],
                    normal,
                    depth,
                );
            }
        },
    );
    any
}
