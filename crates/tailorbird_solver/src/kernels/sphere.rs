//! Particles against a moving sphere.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    contact::{Touching, unit_of_about},
    lanes::{Factor, V3, each_window},
};

/// Tolerance for the height of a particle on the surface, as a part of the radius squared.
const ROUNDING: f32 = 1e-4;

/// A sphere during one substep, in the frame of the particles.
#[derive(Clone, Copy, Debug)]
pub struct MovingSphere {
    /// Centre at the start \[m\].
    pub from: Vec3,
    /// Centre at the end \[m\].
    pub to: Vec3,
    /// Rotation during the substep: axis times angle \[rad\].
    pub rotation: Vec3,
    /// Radius, margin included \[m\].
    pub radius: f32,
    /// Coulomb friction [-].
    pub friction: f32,
}

/// Keeps all free particles (`inv_mass` > 0) out of a sphere. Returns whether any touches.
///
/// A particle that enters from outside is stopped at the tangent plane where it entered, however far it went: nothing tunnels at any speed.
/// Along that plane it slides by a radius at most: further on, the sphere would have let it go. A particle that was inside before is pushed
/// to the nearest point of the surface.
pub fn collide_all(
    level: Level,
    sphere: &MovingSphere,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    particles.check(&range);
    dispatch!(level, simd => collide_all_with(simd, sphere, particles, range))
}

#[inline(always)]
fn collide_all_with<S: Simd>(
    simd: S,
    sphere: &MovingSphere,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    let zero = S::f32s::splat(simd, 0.0);
    let one = S::f32s::splat(simd, 1.0);
    let radius = S::f32s::splat(simd, sphere.radius);
    let r2 = radius * radius;
    let surely_inside = r2 * (1.0 - ROUNDING);
    let surely_outside = r2 * (1.0 + ROUNDING);
    let rotation = V3::splat(simd, sphere.rotation);
    let turns = sphere.rotation != Vec3::ZERO;
    let (center_from, center_to) = (V3::splat(simd, sphere.from), V3::splat(simd, sphere.to));
    let mut any = false;
    each_window(
        simd,
        range.clone(),
        #[inline(always)]
        |window| {
            let free = particles.inv_mass.load_at(simd, window, 0).simd_gt(zero);
            let start = particles.previous.load_at(simd, window, 0) - center_from;
            let mut end: V3<S> = particles.position.load_at(simd, window, 0) - center_to;
            let travel = end - start;
            let (t2, start2) = (travel.dot(travel), start.dot(start));
            let approach = start.dot(travel);
            let inside = end.dot(end).simd_lt(r2);
            let ahead = approach.simd_lt(zero);
            let through = ahead
                & (zero - approach).simd_lt(t2)
                & (start2 * t2 - approach * approach).simd_lt(r2 * t2);
            let swept = start2.simd_ge(surely_inside) & ahead & (inside | through);
            let contacts = particles.known(simd, window);
            let touching = free & (swept | inside | contacts.stays(simd, end, radius));
            if touching.any_true() {
                any = true;
                // Most particles are on the surface and move little: roots and quotients are computed for the others alone.
                let mut hit = start;
                let above = touching & swept & start2.simd_gt(surely_outside);
                if above.any_true() {
                    let root = (approach * approach - t2 * (start2 - r2)).max(zero).sqrt();
                    let time = ((zero - approach - root) / t2).max(zero);
                    hit = start + Factor(above.select(time, zero)) * travel;
                }
                let normal = unit_of_about(simd, hit.select(swept, end), sphere.radius, touching);
                let long = touching & swept & t2.simd_gt(r2);
                if long.any_true() {
                    let beyond = end - hit;
                    let sliding = beyond - Factor(normal.dot(beyond)) * normal;
                    let length = sliding.dot(sliding).sqrt();
                    let cut = length.simd_gt(radius).select(radius / length - one, zero);
                    end = end + Factor(long.select(cut, zero)) * sliding;
                }
                let depth = (radius - normal.dot(end)).max(zero);
                let depth = contacts.pushed(simd, [start, end], (normal, depth), touching, || {
                    radius - start2.sqrt()
                });
                let mut surface = V3::splat(simd, Vec3::ZERO);
                if turns {
                    surface = Factor(radius) * rotation.cross(normal);
                }
                let path = contacts.resolve(
                    simd,
                    touching,
                    [start, end],
                    (normal, depth),
                    (sphere.friction, surface),
                );
                particles.store(
                    simd,
                    window,
                    touching,
                    [path[0] + center_from, path[1] + center_to],
                    normal,
                    depth,
                );
            }
        },
    );
    any
}
