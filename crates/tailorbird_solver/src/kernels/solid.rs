//! Particles against a moving rigid solid with a distance function.
//!
//! A particle's path is taken in the axes of the solid, so that a turning solid stands still and takes along particles that rub on it. A
//! path that is short compared to the solid needs only the distance at its end. A long path is followed from its start by Newton's method:
//! a convex solid lies behind the plane through its nearest point, so that the path cannot meet the solid before it meets the plane; where
//! it does, the next plane is taken. The last plane is where the particle is stopped, whatever lies beyond: nothing tunnels at any speed.

use std::ops::Range;

use bevy_math::{Isometry3d, Mat3, Vec3};
use fearless_simd::{Fallback, Level, Simd, dispatch, prelude::*};

use super::{
    contact::{Touching, unit},
    lanes::{V3, Window, each_lane, each_window},
};
use crate::instruction_set::for_few;

/// Number of planes that a long path is followed by.
const PLANES: u32 = 12;

/// Length from which on a path is long, as a part of the solid's size.
const LONG: f32 = 0.25;

/// Motion of a solid during one substep, in the frame of the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Origin at the start \[m\].
    pub from: Vec3,
    /// Origin at the end \[m\].
    pub to: Vec3,
    /// Rotation from the solid's axes to those of the frame, at the end.
    pub axes: Mat3,
    /// Rotation during the substep.
    pub turn: Mat3,
    /// Coulomb friction [-].
    pub friction: f32,
}

impl Motion {
    /// Motion of a solid from one pose in the frame of the particles to another.
    pub fn new([from, to]: [Isometry3d; 2], friction: f32) -> Self {
        let axes = Mat3::from_quat(to.rotation);
        Self {
            from: from.translation.into(),
            to: to.translation.into(),
            axes,
            turn: if from.rotation == to.rotation {
                Mat3::IDENTITY
            } else {
                axes * Mat3::from_quat(from.rotation).transpose()
            },
            friction,
        }
    }
}

/// Distances of points from a solid.
pub struct Distances<S: Simd> {
    /// Distance from the surface, negative inside \[m\].
    pub distance: S::f32s,
    /// Direction out of the solid at the nearest point of the surface.
    pub out: V3<S>,
    /// Length of `out`.
    pub length: S::f32s,
}

/// A solid around its origin, margin included.
pub trait DistanceFunction: Copy + Sync {
    /// True if the solid is convex, so that long paths can be followed.
    const CONVEX: bool = true;

    /// True for shapes of which games have many: worth the time to compile code for the widest vectors.
    const COMMON: bool = false;

    /// Distance that a particle can go in the solid before it comes nearer to the other side \[m\].
    fn size(&self) -> f32;

    /// Distances of points from the solid. `window` tells which particles they belong to.
    fn distances<S: Simd>(&self, simd: S, window: Window, point: V3<S>) -> Distances<S>;
}

/// Rotated vectors.
#[inline(always)]
pub(super) fn turned<S: Simd>(m: Mat3, v: V3<S>) -> V3<S> {
    V3 {
        x: v.x * m.x_axis.x + v.y * m.y_axis.x + v.z * m.z_axis.x,
        y: v.x * m.x_axis.y + v.y * m.y_axis.y + v.z * m.z_axis.y,
        z: v.x * m.x_axis.z + v.y * m.y_axis.z + v.z * m.z_axis.z,
    }
}

/// Distances of the ends of paths (in the axes of the solid) from the surface, or from the plane that stopped the path before.
#[inline(always)]
fn meet<S: Simd, Q: DistanceFunction>(
    simd: S,
    solid: &Q,
    window: Window,
    [start, end]: [V3<S>; 2],
    free: S::mask32s,
) -> Distances<S> {
    let zero = S::f32s::splat(simd, 0.0);
    let mut near = solid.distances(simd, window, end);
    if !Q::CONVEX {
        return near;
    }
    let travel = end - start;
    let t2 = travel.dot(travel);
    let size = solid.size();
    let long = t2.simd_gt(S::f32s::splat(simd, LONG * LONG * size * size));
    let reaches = near.distance.simd_lt(zero) | (near.distance * near.distance).simd_lt(t2);
    let candidates = free & long & reaches;
    if candidates.any_true() {
        // Few paths are long: they are followed one by one.
        let candidates = candidates.select(S::f32s::splat(simd, 1.0), zero);
        for (k, candidate) in candidates.as_slice().iter().enumerate() {
            if *candidate == 0.0 {
                continue;
            }
            if let Some((distance, out)) = sweep(solid, window.at + k, lane(start, k), lane(end, k))
            {
                near.distance.as_mut_slice()[k] = distance;
                near.out.x.as_mut_slice()[k] = out.x;
                near.out.y.as_mut_slice()[k] = out.y;
                near.out.z.as_mut_slice()[k] = out.z;
                near.length.as_mut_slice()[k] = 1.0;
            }
        }
    }
    near
}

/// One of several vectors side by side.
#[inline(always)]
pub(super) fn lane<S: Simd>(v: V3<S>, k: usize) -> Vec3 {
    Vec3::new(v.x.as_slice()[k], v.y.as_slice()[k], v.z.as_slice()[k])
}

/// Distance of a point from a solid, and the unit vector out of it.
#[inline(never)]
fn near_one<Q: DistanceFunction>(solid: &Q, i: usize, point: Vec3) -> (f32, Vec3) {
    let simd = Fallback::new();
    let near = solid.distances(simd, Window::single(i), V3::splat(simd, point));
    let out = unit(simd, near.out, near.length);
    (near.distance.as_slice()[0], lane(out, 0))
}

/// Follows a long path from its start. Returns the height of its end above the plane that stops it, and the plane's normal; `None` where
/// nothing stops it.
#[inline(never)]
fn sweep<Q: DistanceFunction>(solid: &Q, i: usize, start: Vec3, end: Vec3) -> Option<(f32, Vec3)> {
    let travel = end - start;
    let (mut distance, mut plane) = near_one(solid, i, start);
    if distance < -1e-4 * solid.size() {
        return None;
    }
    let mut time = 0.0;
    for k in 0..PLANES {
        let speed = -plane.dot(travel);
        if speed <= 0.0 {
            return None;
        }
        let next = time + distance.max(0.0) / speed;
        if next >= 1.0 {
            return None;
        }
        if k + 1 == PLANES {
            break;
        }
        time = next;
        (distance, plane) = near_one(solid, i, start + time * travel);
    }
    // If the path begins below the surface by rounding, it ends above it all the same, not at its start.
    let at = start + time * travel;
    Some((plane.dot(end - at) + distance, plane))
}

/// Keeps all free particles (`inv_mass` > 0) of a range out of a solid. Returns whether any touches.
pub fn collide_all<Q: DistanceFunction>(
    level: Level,
    solid: &Q,
    motion: &Motion,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    particles.check(&range);
    if Q::COMMON {
        return dispatch!(level, simd => collide_all_with(simd, solid, motion, particles, range));
    }
    for_few!(level, simd => collide_all_with(simd, solid, motion, particles, range))
}

#[inline(always)]
fn collide_all_with<S: Simd, Q: DistanceFunction>(
    simd: S,
    solid: &Q,
    motion: &Motion,
    particles: Touching,
    range: Range<usize>,
) -> bool {
    let zero = S::f32s::splat(simd, 0.0);
    let (from, to) = (V3::splat(simd, motion.from), V3::splat(simd, motion.to));
    let inverse = motion.axes.transpose();
    let turns = motion.turn != Mat3::IDENTITY;
    let mut any = false;
    each_window(
        simd,
        range,
        #[inline(always)]
        |window| {
            let free = particles.inv_mass.load_at(simd, window, 0).simd_gt(zero);
            let before: V3<S> = particles.previous.load_at(simd, window, 0);
            let end: V3<S> = particles.position.load_at(simd, window, 0) - to;
            let start = if turns {
                turned(motion.turn, before - from)
            } else {
                before - from
            };
            let local = [turned(inverse, start), turned(inverse, end)];
            let near = meet(simd, solid, window, local, free);
            let contacts = particles.known(simd, window);
            let touching =
                free & (near.distance.simd_lt(zero) | contacts.within(simd, near.distance));
            if !touching.any_true() {
                return;
            }
            let normal = turned(motion.axes, unit(simd, near.out, near.length));
            let touching =
                free & (near.distance.simd_lt(zero) | contacts.along(simd, normal, near.distance));
            if !touching.any_true() {
                return;
            }
            any = true;
            let depth = (zero - near.distance).max(zero);
            let depth = contacts.pushed(simd, [start, end], (normal, depth), touching, || {
                zero - solid.distances(simd, window, local[0]).distance
            });
            let still = V3::splat(simd, Vec3::ZERO);
            let path = contacts.resolve(
                simd,
                touching,
                [start, end],
                (normal, depth),
                (motion.friction, still),
            );
            let mut moved = path[0] - start;
            if turns {
                moved = turned(motion.turn.transpose(), moved);
            }
            particles.store(
                simd,
                window,
                touching,
                [before + moved, path[1] + to],
                normal,
                depth,
            );
        },
    );
    any
}

/// Contact of one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Unit normal, in the axes of the frame.
    pub normal: Vec3,
    /// Depth of the particle below the surface, negative above it \[m\].
    pub depth: f32,
}

/// Contact at the end of the path of particle `i`, with the surface of a solid or with the plane that stopped the path before.
pub fn nearest<Q: DistanceFunction>(
    solid: &Q,
    motion: &Motion,
    i: usize,
    [from, to]: [Vec3; 2],
) -> Contact {
    let inverse = motion.axes.transpose();
    let start = inverse * (motion.turn * (from - motion.from));
    let end = inverse * (to - motion.to);
    let (mut distance, mut out) = near_one(solid, i, end);
    let (length2, size) = (start.distance_squared(end), solid.size());
    let long = length2 > LONG * LONG * size * size;
    if Q::CONVEX
        && long
        && (distance < 0.0 || distance * distance < length2)
        && let Some(met) = sweep(solid, i, start, end)
    {
        (distance, out) = met;
    }
    Contact {
        normal: motion.axes * out,
        depth: -distance,
    }
}

/// Calls `found` for each particle of a range that touches a solid now, in order.
pub fn find<Q: DistanceFunction>(
    solid: &Q,
    motion: &Motion,
    particles: Touching,
    range: Range<usize>,
    found: impl FnMut(usize),
) {
    particles.check(&range);
    // Bodies that cloth pushes are few: not worth the code of all instruction sets.
    find_with(Fallback::new(), solid, motion, particles, range, found);
}

#[inline(always)]
fn find_with<S: Simd, Q: DistanceFunction>(
    simd: S,
    solid: &Q,
    motion: &Motion,
    particles: Touching,
    range: Range<usize>,
    mut found: impl FnMut(usize),
) {
    let zero = S::f32s::splat(simd, 0.0);
    let (from, to) = (V3::splat(simd, motion.from), V3::splat(simd, motion.to));
    let inverse = motion.axes.transpose();
    each_window(
        simd,
        range,
        #[inline(always)]
        |window| {
            let free =
                particles.inv_mass.load_at(simd, window, 0).simd_gt(zero) & window.todo(simd);
            let start: V3<S> = particles.previous.load_at(simd, window, 0) - from;
            let end: V3<S> = particles.position.load_at(simd, window, 0) - to;
            let local = [
                turned(inverse, turned(motion.turn, start)),
                turned(inverse, end),
            ];
            let near = meet(simd, solid, window, local, free);
            let touching = free & near.distance.simd_lt(zero);
            each_lane(simd, touching, |k| found(window.at + k));
        },
    );
}

#[cfg(test)]
#[path = "solid_tests.rs"]
mod tests;
