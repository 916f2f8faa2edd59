//! Particles against a moving sphere.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    contact::{Path, Touching, unit_of_about},
    lanes::{Factor, V3, each_window},
};
use crate::points::Points;

/// How far from the surface a particle on it may seem to be, as a part of the radius squared.
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

impl MovingSphere {
    /// Keeps one particle out. `path` is relative to the centre. `None` where there is no contact.
    ///
    /// A particle that enters from outside is stopped at the tangent plane where it entered, however far it went: nothing
    /// tunnels at any speed. Along that plane it slides by a radius at most: further on, the sphere would have let it go.
    /// One that was inside before is pushed to the nearest point of the surface.
    #[inline]
    pub fn collide(&self, mut path: Path) -> Option<Path> {
        let r2 = self.radius * self.radius;
        let travel = path.to - path.from;
        let t2 = travel.length_squared();
        let start2 = path.from.length_squared();
        let approach = path.from.dot(travel);
        let inside = path.to.length_squared() < r2;
        // A particle that was pushed out to the surface is a rounding inside of it: it counts as outside.
        let from_outside = start2 >= r2 * (1.0 - ROUNDING);
        // The nearest point of the path's line to the centre lies ahead, not beyond the end, and inside.
        let through =
            approach < 0.0 && -approach < t2 && start2 * t2 - approach * approach < r2 * t2;
        let normal = if from_outside && approach < 0.0 && (inside || through) {
            // One that is on the surface enters where it is.
            let time = if start2 > r2 * (1.0 + ROUNDING) {
                let root = (approach * approach - t2 * (start2 - r2)).max(0.0).sqrt();
                ((-approach - root) / t2).max(0.0)
            } else {
                0.0
            };
            let hit = path.from + travel * time;
            let normal = hit.normalize_or(Vec3::Y);
            let sliding = (path.to - hit).reject_from_normalized(normal);
            path.to += sliding.clamp_length_max(self.radius) - sliding;
            normal
        } else if inside {
            // At the very centre every direction is as near; up is where cloth comes from.
            path.to.normalize_or(Vec3::Y)
        } else {
            return None;
        };
        let depth = self.radius - normal.dot(path.to);
        let surface = self.rotation.cross(normal) * self.radius;
        Some(path.resolve(normal, depth.max(0.0), self.friction, surface))
    }
}

/// Keeps all free particles (`inv_mass` > 0) out of a sphere; what [`MovingSphere::collide`] does to one, side by side. Returns whether any
/// touches.
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
                // Most are on the surface and go no long way: roots and quotients are found for the others alone.
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

/// Keeps one particle out of a sphere; returns whether it touches.
#[inline]
pub fn collide_one(
    sphere: &MovingSphere,
    i: usize,
    position: &mut Points,
    previous: &mut Points,
) -> bool {
    let path = Path {
        from: previous.get(i) - sphere.from,
        to: position.get(i) - sphere.to,
    };
    let Some(path) = sphere.collide(path) else {
        return false;
    };
    position.set(i, path.to + sphere.to);
    previous.set(i, path.from + sphere.from);
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sphere(radius: f32, friction: f32) -> MovingSphere {
        MovingSphere {
            from: Vec3::ZERO,
            to: Vec3::ZERO,
            rotation: Vec3::ZERO,
            radius,
            friction,
        }
    }

    fn point(range: f32) -> impl Strategy<Value = Vec3> {
        (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn nothing_ends_inside(from in point(3.0), to in point(3.0), radius in 0.01f32..2.0, friction in 0.0f32..2.0) {
            let sphere = sphere(radius, friction);
            let end = sphere.collide(Path { from, to }).map_or(to, |path| path.to);
            prop_assert!(end.length() >= radius * (1.0 - 1e-5));
        }

        #[test]
        fn nothing_passes_through(
            from in point(3.0), offset in point(1.0), radius in 0.05f32..1.0, speed in 0.1f32..100.0,
        ) {
            prop_assume!(from.length() > radius * 1.01);
            let sphere = sphere(radius, 0.0);
            let aim = offset.normalize_or_zero() * (radius * 0.9 * offset.length().min(1.0));
            let to = from + (aim - from).normalize() * speed;
            let end = sphere.collide(Path { from, to }).map_or(to, |path| path.to);
            for k in 0..=100 {
                let p = from.lerp(end, k as f32 / 100.0);
                prop_assert!(p.length() >= radius * 0.999, "{p}: {} {radius}", p.length());
            }
        }
    }

    #[test]
    fn a_shot_through_the_middle_stops_at_the_near_side() {
        let path = Path {
            from: Vec3::new(0.1, 0.0, 5.0),
            to: Vec3::new(0.1, 0.0, -50.0),
        };
        let end = sphere(0.5, 0.0).collide(path).expect("contact").to;
        assert!(end.z > 0.3 && end.length() < 0.75, "{end}");
    }

    #[test]
    fn a_particle_on_the_surface_is_not_shot_through_whatever_rounding_did() {
        for z in [1.0f32.next_down(), 1.0, 1.0f32.next_up()] {
            let path = Path {
                from: Vec3::Z * z,
                to: Vec3::NEG_Z * 1.2,
            };
            let end = sphere(1.0, 0.0).collide(path).map(|path| path.to);
            assert!(end.is_some_and(|end| end.z > 0.99), "{end:?}");
        }
    }

    #[test]
    fn friction_above_the_slope_holds_and_below_it_slides() {
        let slope = Vec3::new(0.6, 0.8, 0.0);
        let tangent = Vec3::new(0.8, -0.6, 0.0);
        let path = Path {
            from: slope,
            to: slope + Vec3::NEG_Y * 0.01,
        };
        let slid = |friction: f32| {
            let path = sphere(1.0, friction).collide(path).expect("contact");
            (path.to - path.from).dot(tangent)
        };
        // tan of the slope's angle is 0.75.
        assert!(slid(0.8).abs() < 1e-4);
        assert!((slid(0.0) - 0.006).abs() < 1e-4);
        assert!(slid(0.3) > 1e-3 && slid(0.3) < slid(0.0));
    }

    #[test]
    fn a_spinning_sphere_drags_along() {
        let spinning = MovingSphere {
            rotation: Vec3::Y * 0.1,
            ..sphere(1.0, 1.0)
        };
        let path = Path {
            from: Vec3::X,
            to: Vec3::X * 0.8,
        };
        let end = spinning.collide(path).expect("contact").to;
        assert!(end.z < -0.05, "{end}");
    }

    #[test]
    fn a_particle_that_starts_inside_is_put_outside_without_speed() {
        let inside = Vec3::new(0.1, 0.0, 0.0);
        let path = sphere(1.0, 0.0)
            .collide(Path {
                from: inside,
                to: inside,
            })
            .expect("contact");
        assert!((path.to.length() - 1.0).abs() < 1e-6);
        assert!((path.to - path.from).length() < 1e-6);
    }
}
