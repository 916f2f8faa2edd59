//! Moving spheres: paths that enter stop where they do, whatever their length, and slide from there by a radius at most.

use crate::properties::*;
use bevy_math::{DVec3, Vec3};
use fearless_simd::Level;
use parry3d::{query::PointQuery, shape::Ball};

use super::{
    cases,
    contact::{Meeting, Particles, Verdict, near, particles},
    vector,
};
use crate::kernels::{
    contact::Phase,
    sphere::{MovingSphere, collide_all},
};

fn collide(sphere: &MovingSphere, particles: &Particles) -> super::contact::Collided {
    let all = 0..particles.from.len();
    particles.collide(|touching| collide_all(Level::new(), sphere, touching, all))
}

/// Contact rule of a sphere for a particle's path.
fn rule(sphere: &MovingSphere, particles: &Particles, i: usize) -> Verdict {
    let r = f64::from(sphere.radius);
    let from = particles.from[i].as_dvec3() - sphere.from.as_dvec3();
    let mut to = particles.to[i].as_dvec3() - sphere.to.as_dvec3();
    let travel = to - from;
    let (t2, approach) = (travel.length_squared(), from.dot(travel));
    // A rounding inside of the surface counts as on it.
    let part = from.length_squared() / (r * r);
    let (outside, above) = (part >= 1.0 - 1e-4, part > 1.0 + 1e-4);
    let nearest = (from.length_squared() - approach * approach / t2)
        .max(0.0)
        .sqrt();
    let inside = to.length() < r;
    let through = approach < 0.0 && -approach < t2 && nearest < r;
    let swept = outside && approach < 0.0 && (inside || through);
    let (noted, depth) = particles.known(i);
    let stays = depth > 0.0 && to.dot(noted) > 0.7 * r && to.length() < r + depth;
    let doubt = near(part, 1.0 - 1e-4)
        || near(part, 1.0 + 1e-4)
        || near(to.length(), r)
        || near(approach, 0.0)
        || near(-approach, t2)
        || near(nearest, r)
        || (depth > 0.0 && (near(to.dot(noted), 0.7 * r) || near(to.length(), r + depth)))
        // The root takes what is grazed apart, and the middle has no direction.
        || (swept && above && r - nearest < 0.02)
        || (!swept && to.length() < 0.05);
    if doubt {
        return Verdict::Doubt;
    }
    if !(swept || inside || stays) {
        return Verdict::Free;
    }
    let mut at = to;
    if swept {
        at = from;
        if above {
            let half = (r * r - nearest * nearest).sqrt();
            let along = (-approach / t2.sqrt() - half).max(0.0);
            at = from + travel / t2.sqrt() * along;
        }
        if t2 > r * r {
            let n = at.normalize();
            let sliding = (to - at) - n * n.dot(to - at);
            to += sliding.clamp_length_max(r) - sliding;
        }
    }
    let normal = at.normalize();
    let meeting = Meeting {
        from,
        to,
        normal,
        depth: (r - normal.dot(to)).max(0.0),
        depth_at_start: r - from.length(),
        surface: sphere.rotation.as_dvec3().cross(normal) * r,
    };
    let (noted, _) = particles.known(i);
    if near(normal.dot(noted), 0.7) || near(meeting.depth_at_start, f64::from(particles.most)) {
        return Verdict::Doubt;
    }
    Verdict::Touches(meeting)
}

fn spheres() -> impl Strategy<Value = MovingSphere> {
    let turn = prop_oneof![Just(Vec3::ZERO), vector(0.3)];
    (vector(0.5), vector(0.2), turn, 0.3_f32..1.2, 0.0_f32..1.5).prop_map(
        |(from, moved, rotation, radius, friction)| MovingSphere {
            from,
            to: from + moved,
            rotation,
            radius,
            friction,
        },
    )
}

/// Roots at 0.02 of the surface are off by 10⁻⁶/√0.02, and by as much again for paths of up to four times the radius.
const MOST: f64 = 2e-4;

fn compare(sphere: &MovingSphere, particles: &Particles) -> Result<usize, TestCaseError> {
    let is = collide(sphere, particles);
    let outside =
        |[from, to]: [DVec3; 2]| [from + sphere.from.as_dvec3(), to + sphere.to.as_dvec3()];
    let rule = |i: usize| rule(sphere, particles, i);
    let count = particles.compare(&is, sphere.friction, MOST, rule, outside)?;
    if particles.most.is_infinite() {
        // Whatever happens, nothing that is free ends inside.
        let ball = Ball::new(sphere.radius);
        for i in 0..particles.from.len() - 1 {
            let distance = ball.distance_to_local_point(is.to.get(i) - sphere.to, false);
            prop_assert!(distance > -1e-5, "{i} ends at {distance}");
        }
    }
    Ok(count)
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn spheres_stop_short_paths_as_stated(sphere in spheres(), particles in particles(1.2, 0.2)) {
        compare(&sphere, &particles)?;
    }

    #[test]
    fn spheres_stop_long_paths_as_stated(sphere in spheres(), particles in particles(2.0, 4.0)) {
        compare(&sphere, &particles)?;
    }

    /// On the surface: where the series stands for the root.
    #[test]
    fn spheres_stop_what_lies_on_them(
        sphere in spheres(), mut particles in particles(1.0, 0.3), off in prop::collection::vec(-0.01_f32..0.03, 40),
    ) {
        for (i, off) in off.into_iter().take(particles.from.len()).enumerate() {
            let travel = particles.to[i] - particles.from[i];
            let direction = particles.from[i].normalize_or(Vec3::X);
            particles.from[i] = sphere.from + direction * sphere.radius * (1.0 + off);
            particles.to[i] = particles.from[i] + travel * 0.3;
            if let Some(noted) = &mut particles.noted {
                noted[i].0 = (direction + 0.8 * noted[i].0).normalize_or(Vec3::X);
            }
        }
        compare(&sphere, &particles)?;
    }

    /// However fast: from outside, no part of the path lies within.
    #[test]
    fn nothing_passes_through_a_sphere(
        from in vector(3.0), offset in vector(1.0), radius in 0.05_f32..1.0, speed in 0.1_f32..100.0,
    ) {
        prop_assume!(from.length() > radius * 1.01);
        let aim = offset.normalize_or_zero() * (radius * 0.9 * offset.length().min(1.0));
        let [_, end] = one(&still(radius, 0.0), [from, from + (aim - from).normalize() * speed]);
        let ball = Ball::new(radius);
        for k in 0..=100 {
            let distance = ball.distance_to_local_point(from.lerp(end, k as f32 / 100.0), false);
            prop_assert!(distance > -1e-3 * radius, "{distance}");
        }
    }

    /// A particle that would slide by more than a radius slides by a radius.
    #[test]
    fn a_long_slide_is_cut_to_a_radius(radius in 0.1_f32..1.0, aside in 0.1_f32..0.8, speed in 5.0_f32..50.0) {
        prop_assume!((speed - 2.0 * radius) * aside > radius);
        let from = Vec3::new(aside * radius, 0.0, 2.0 * radius);
        let [_, end] = one(&still(radius, 0.0), [from, from - Vec3::Z * speed]);
        let normal = Vec3::new(aside, 0.0, (1.0 - aside * aside).sqrt());
        let hit = normal * radius;
        prop_assert!(((end - hit).length() / radius - 1.0).abs() < 1e-4, "{end}");
        // Rounding of the whole path, in a dozen operations.
        prop_assert!((end - hit).dot(normal).abs() < 1e-6 * speed);
    }
}

fn still(radius: f32, friction: f32) -> MovingSphere {
    MovingSphere {
        from: Vec3::ZERO,
        to: Vec3::ZERO,
        rotation: Vec3::ZERO,
        radius,
        friction,
    }
}

/// The path of one particle after a contact with friction.
fn one(sphere: &MovingSphere, [from, to]: [Vec3; 2]) -> [Vec3; 2] {
    let is = collide(
        sphere,
        &Particles {
            // The last one is held.
            from: vec![from; 2],
            to: vec![to; 2],
            noted: None,
            phase: Phase::Final,
            most: f32::INFINITY,
        },
    );
    [is.from.get(0), is.to.get(0)]
}

#[test]
fn a_particle_on_the_surface_is_not_shot_through_whatever_rounding_did() {
    for z in [1.0_f32.next_down(), 1.0, 1.0_f32.next_up()] {
        let [_, end] = one(&still(1.0, 0.0), [Vec3::Z * z, Vec3::NEG_Z * 1.2]);
        assert!(end.z > 0.99, "{end}");
    }
}

/// A path that starts within the surface by no more than 10⁻⁴ of the square enters there; one that starts deeper was inside, and leaves at
/// the nearest point.
#[test]
fn a_rounding_inside_counts_as_on_the_surface() {
    for (square, outside) in [(1.0 - 0.95e-4, true), (1.0 - 1.05e-4, false)] {
        let from = Vec3::Z * f32::sqrt(square);
        let [_, end] = one(&still(1.0, 0.0), [from, from + Vec3::new(0.3, 0.0, -0.2)]);
        assert_eq!((end.z - 1.0).abs() < 1e-4, outside, "{square}: {end}");
    }
    // What starts no more than that above it enters where it is, and what is higher where it meets the surface.
    for (square, where_it_is) in [(1.0 + 0.95e-4, true), (1.0 + 1.05e-4, false)] {
        let from = Vec3::Z * f32::sqrt(square);
        let [_, end] = one(&still(1.0, 0.0), [from, from + Vec3::new(0.3, 0.0, -0.006)]);
        // Where x = 0.02 − √(0.02² − 2 · 5 · 10⁻⁵) the normal is turned by 0.0025, so that the tangent plane is lower by 8 · 10⁻⁴ at the end.
        assert_eq!((end.z - 1.0).abs() < 1e-4, where_it_is, "{square}: {end}");
    }
}

#[test]
fn friction_above_the_slope_holds_and_below_it_slides() {
    let slope = Vec3::new(0.6, 0.8, 0.0);
    let tangent = Vec3::new(0.8, -0.6, 0.0);
    let slid = |friction: f32| {
        let [from, to] = one(&still(1.0, friction), [slope, slope + Vec3::NEG_Y * 0.01]);
        (to - from).dot(tangent)
    };
    // tan of the slope's angle is 0.75; of 0.006 along it, friction takes its part of the 0.008 into it.
    assert!(slid(0.8).abs() < 1e-6);
    for friction in [0.0, 0.3, 0.7] {
        assert!((slid(friction) - (0.006 - friction * 0.008)).abs() < 1e-6);
    }
}

#[test]
fn a_particle_that_starts_inside_is_put_outside_without_speed() {
    let inside = Vec3::new(0.1, 0.0, 0.0);
    let [from, to] = one(&still(1.0, 0.0), [inside; 2]);
    assert!((to.length() - 1.0).abs() < 1e-6);
    assert!(to.distance(from) < 1e-6);
    // From the very middle upwards.
    assert_eq!(one(&still(1.0, 0.0), [Vec3::ZERO; 2])[1], Vec3::Y);
}

#[test]
fn a_spinning_sphere_drags_along() {
    let spinning = MovingSphere {
        rotation: Vec3::Y * 0.1,
        ..still(1.0, 1.0)
    };
    let [_, to] = one(&spinning, [Vec3::X, Vec3::X * 0.8]);
    // 0.1 Y × X, less than what friction can do.
    assert!(to.distance(Vec3::new(1.0, 0.0, -0.1)) < 1e-6, "{to}");
}
