//! Solids with distance functions, and particles that meet them while they move and turn.

use crate::properties::*;
use bevy_math::{DMat3, DVec3, Mat3, Quat, Vec3};
use fearless_simd::Level;
use parry3d::{
    query::PointQuery,
    shape::{Capsule as Pill, Cuboid as Block, Cylinder as Can, Segment},
};

use super::{
    cases,
    contact::{Particles, Verdict, meeting, particles},
    vector,
};
use crate::kernels::{
    ball::{Ball, Ground},
    capsule::Capsule,
    contact::Phase,
    cuboid::Cuboid,
    cylinder::Cylinder,
    solid::{DistanceFunction, Motion, collide_all, nearest},
};

pub(super) const STILL: Motion = Motion {
    from: Vec3::ZERO,
    to: Vec3::ZERO,
    axes: Mat3::IDENTITY,
    turn: Mat3::IDENTITY,
    friction: 0.0,
};

/// Numbers below 4, a handful of operations, among them a root.
pub(super) const MOST: f64 = 3e-6;

fn size() -> impl Strategy<Value = f32> {
    0.05_f32..1.0
}

/// Distance of a point from a solid, and the direction out of it.
pub(super) fn near_of<Q: DistanceFunction>(solid: &Q, p: Vec3) -> (f64, DVec3) {
    let contact = nearest(solid, &STILL, 0, [p, p]);
    (-f64::from(contact.depth), contact.normal.as_dvec3())
}

/// Compares the solid's distance, which is a plane's, with another library's: equal inside, and no more than that outside. Along the
/// normal, it changes by the distance moved.
fn compare<Q: DistanceFunction>(
    solid: &Q,
    p: Vec3,
    other: &dyn PointQuery,
    exact: bool,
) -> Result<(), TestCaseError> {
    let (distance, normal) = near_of(solid, p);
    let wanted = f64::from(other.distance_to_local_point(p, false));
    if exact || wanted < 0.0 {
        prop_assert!((distance - wanted).abs() < MOST, "{distance} {wanted}");
    } else {
        prop_assert!(
            distance > -MOST && distance < wanted + MOST,
            "{distance} {wanted}"
        );
    }
    prop_assert!((normal.length() - 1.0).abs() < 1e-6);
    let (further, _) = near_of(solid, p + normal.as_vec3());
    prop_assert!(
        (further - distance - 1.0).abs() < MOST,
        "{distance} {further}"
    );
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn a_capsule_is_as_far_as_elsewhere(p in vector(2.0), r in size(), h in size()) {
        let shape = Pill { segment: Segment::new(Vec3::Y * -h, Vec3::Y * h), radius: r };
        prop_assume!(shape.segment.distance_to_local_point(p, false) > 0.01);
        compare(&Capsule::new(r, r, h, 0.0), p, &shape, true)?;
        let [wide, narrow] = [0.1, 0.0].map(|margin| near_of(&Capsule::new(r, r, h, margin), p).0);
        prop_assert!((narrow - wide - 0.1).abs() < MOST);
    }

    /// The least of the distances of its balls, found by bisection: it is convex along the axis.
    #[test]
    fn a_tapered_capsule_is_as_far_as_its_nearest_ball(p in vector(2.0), a in size(), b in size(), h in size(), margin in 0.0_f32..0.1) {
        let solid = Capsule::new(a, b, h, margin);
        let [at, a64, b64, h64] = [0.0, a.into(), b.into(), f64::from(h)];
        let ball = |part: f64| {
            let center = DVec3::Y * (at + (2.0 * part - 1.0) * h64);
            (p.as_dvec3() - center).length() - (a64 + (b64 - a64) * part) - f64::from(margin)
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let [first, second] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if ball(first) < ball(second) {
                high = second;
            } else {
                low = first;
            }
        }
        // Where one ball nearly holds the other the slope has no bounds.
        prop_assume!((a - b).abs() < 1.9 * h || (a - b).abs() > 2.0 * h);
        let center = DVec3::Y * (2.0 * low - 1.0) * h64;
        prop_assume!(p.as_dvec3().distance(center) > 0.01);
        let (distance, normal) = near_of(&solid, p);
        prop_assert!((distance - ball(low)).abs() < 2.0 * MOST, "{distance} {}", ball(low));
        prop_assert!(normal.distance((p.as_dvec3() - center).normalize()) < 1e-3);
    }

    #[test]
    fn a_box_is_as_far_as_the_plane_of_its_nearest_face(p in vector(2.0), half in [size(), size(), size()]) {
        let half_size = Vec3::from(half);
        compare(&Cuboid { half_size }, p, &Block::new(half_size), false)?;
        let wanted = (p.as_dvec3().abs() - half_size.as_dvec3()).max_element();
        let (distance, _) = near_of(&Cuboid { half_size }, p);
        prop_assert!((distance - wanted).abs() < MOST);
    }

    #[test]
    fn a_cylinder_is_as_far_as_its_side_or_end(p in vector(2.0), radius in size(), half_height in size()) {
        prop_assume!(p.x.hypot(p.z) > 0.01);
        let solid = Cylinder { radius, half_height };
        compare(&solid, p, &Can::new(half_height, radius), false)?;
        let from_axis = f64::from(p.x).hypot(p.z.into());
        let wanted = (from_axis - f64::from(radius)).max(f64::from(p.y).abs() - f64::from(half_height));
        prop_assert!((near_of(&solid, p).0 - wanted).abs() < MOST);
    }

    #[test]
    fn balls_and_the_ground_are_as_far_as_they_are(p in vector(2.0), radius in size()) {
        prop_assume!(p.length() > 0.01);
        compare(&Ball { radius }, p, &parry3d::shape::Ball::new(radius), true)?;
        let (distance, normal) = near_of(&Ground { margin: radius }, p);
        prop_assert_eq!(normal, DVec3::Y);
        prop_assert!((distance - f64::from(p.y) + f64::from(radius)).abs() < MOST);
    }

    /// A quarter of its size, and more: followed, so that what passes through a part of the ball does not get by.
    #[test]
    fn paths_of_a_quarter_of_the_size_are_followed(radius in 0.1_f32..1.0) {
        for (travel, followed) in [(0.24, false), (0.26, true)] {
            // A chord that dips by 3 ‰ of the radius below the surface in its middle, and has both ends above.
            let path = [-0.5, 0.5].map(|half| Vec3::new(travel * half, 0.997, 0.0) * radius);
            let contact = nearest(&Ball { radius }, &STILL, 0, path);
            prop_assert_eq!(contact.depth > 0.0, followed, "{} {}", travel, contact.depth);
            let both = Particles {
                from: vec![path[0]; 2],
                to: vec![path[1]; 2],
                noted: None,
                phase: Phase::Final,
                most: f32::INFINITY,
            };
            let is = both.collide(|touching| collide_all(Level::new(), &Ball { radius }, &STILL, touching, 0..2));
            prop_assert_eq!(is.any, followed);
        }
    }
}

proptest! {
    #![proptest_config(cases(500))]

    /// A ball and a box that move and turn: in their axes they stand still.
    #[test]
    fn what_moves_and_turns_meets_particles_as_stated(
        mut particles in particles(0.8, 0.05), place in vector(0.5), moved in vector(0.1), axes in vector(2.0), turn in vector(0.2),
        turns in any::<bool>(), friction in 0.0_f32..1.0, is_box in any::<bool>(),
    ) {
        let axes = Quat::from_scaled_axis(axes);
        let turn = if turns { Quat::from_scaled_axis(turn) } else { Quat::IDENTITY };
        // From where the frame was to where it is.
        let motion = Motion {
            from: place, to: place + moved, axes: Mat3::from_quat(axes), turn: Mat3::from_quat(turn), friction,
        };
        let half = DVec3::new(0.5, 0.6, 0.7);
        let distance_of = |p: DVec3| {
            if !is_box {
                return (p.length() - 0.6, p.normalize());
            }
            let by = p.abs() - half;
            let face = (0..3).max_by(|a, b| by[*a].total_cmp(&by[*b])).unwrap_or(0);
            let mut normal = DVec3::ZERO;
            normal[face] = p[face].signum();
            (by[face], normal)
        };
        let [to_world, turned] = [axes, turn].map(|q| DMat3::from_quat(q.as_dquat()));
        let local = |particles: &Particles, i: usize| {
            let from = turned * (particles.from[i].as_dvec3() - place.as_dvec3());
            let to = particles.to[i].as_dvec3() - motion.to.as_dvec3();
            [from, to].map(|p| to_world.transpose() * p)
        };
        for i in 0..particles.from.len() {
            // As the solid moves, so that paths are short against it.
            let travel = particles.to[i] - particles.from[i];
            particles.to[i] = motion.to + turn * (particles.from[i] - place) + travel;
            let normal = (to_world * distance_of(local(&particles, i)[1]).1).as_vec3();
            if let Some(noted) = &mut particles.noted {
                noted[i].0 = (normal + 0.8 * noted[i].0).normalize_or(Vec3::X);
            }
        }
        let axes_of = |p: Vec3| to_world.transpose() * p.as_dvec3();
        let mut still = particles.clone();
        for (normal, _) in still.noted.iter_mut().flatten() {
            *normal = axes_of(*normal).as_vec3();
        }
        let rule = |i: usize| {
            let [from, to] = local(&particles, i);
            let sorted = (to.abs() - half).to_array();
            let edge = |a: usize, b: usize| (sorted[a] - sorted[b]).abs() < 1e-5;
            if to.length() < 0.05 || (is_box && (edge(0, 1) || edge(1, 2) || edge(2, 0))) {
                return Verdict::Doubt;
            }
            meeting(&still, i, [from, to], distance_of(to), distance_of(from).0)
        };
        let outside = |[from, to]: [DVec3; 2]| {
            let from = turned.transpose() * (to_world * from) + place.as_dvec3();
            [from, to_world * to + motion.to.as_dvec3()]
        };
        let all = 0..particles.from.len();
        let is = particles.collide(|touching| {
            let level = Level::new();
            if is_box {
                collide_all(level, &Cuboid { half_size: half.as_vec3() }, &motion, touching, all)
            } else {
                collide_all(level, &Ball { radius: 0.6 }, &motion, touching, all)
            }
        });
        // Directions from 0.05 of the middle are off by 10⁻⁶/0.05.
        still.compare_with(&is, friction, 1e-4, rule, outside, &particles)?;
    }
}
