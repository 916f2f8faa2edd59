//! Long paths against solids, and the search for particles that touch.

use crate::properties::*;
use bevy_math::{DVec3, Mat3, Vec3};
use fearless_simd::Level;

use super::{
    cases,
    contact::{Meeting, Particles, Verdict, particles},
    solid::STILL,
    vector,
};
use crate::kernels::{
    ball::Ball,
    capsule::Capsule,
    cuboid::Cuboid,
    cylinder::Cylinder,
    solid::{DistanceFunction, Motion, collide_all, find, nearest},
};

/// Many paths at once, each as it is alone, which others check.
fn compare<Q: DistanceFunction>(
    solid: &Q,
    motion: &Motion,
    particles: &Particles,
) -> Result<(), TestCaseError> {
    let path = |i: usize| [particles.from[i], particles.to[i]];
    let rule = |i: usize| {
        let contact = nearest(solid, motion, i, path(i));
        let [from, to] = [path(i)[0] - motion.from, path(i)[1] - motion.to].map(Vec3::as_dvec3);
        let depth = f64::from(contact.depth);
        if depth.abs() < 1e-5 {
            return Verdict::Doubt;
        }
        if depth < 0.0 {
            return Verdict::Free;
        }
        let (normal, surface) = (contact.normal.as_dvec3(), DVec3::ZERO);
        Verdict::Touches(Meeting {
            from,
            to,
            normal,
            depth,
            depth_at_start: 0.0,
            surface,
        })
    };
    let all = 0..particles.from.len();
    let is = particles
        .collide(|touching| collide_all(Level::new(), solid, motion, touching, all.clone()));
    let outside =
        |[from, to]: [DVec3; 2]| [from + motion.from.as_dvec3(), to + motion.to.as_dvec3()];
    particles.compare(&is, motion.friction, 1e-4, rule, outside)?;

    let mut found = Vec::new();
    particles.collide(|touching| {
        find(solid, motion, touching, all.clone(), |i| found.push(i));
        false
    });
    found.sort_unstable();
    let last = all.end - 1;
    let touches = |i: &usize| nearest(solid, motion, *i, path(*i)).depth > 0.0;
    prop_assert_eq!(found, (0..last).filter(touches).collect::<Vec<_>>());
    Ok(())
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn long_paths_side_by_side_are_followed_as_alone(
        particles in particles(1.5, 4.0), from in vector(0.2), moved in vector(0.1), friction in 0.0_f32..1.0, kind in 0..4,
    ) {
        let particles = Particles { noted: None, most: f32::INFINITY, ..particles };
        let motion = Motion { from, to: from + moved, axes: Mat3::IDENTITY, turn: Mat3::IDENTITY, friction };
        match kind {
            0 => compare(&Ball { radius: 0.6 }, &motion, &particles)?,
            1 => compare(&Cuboid { half_size: Vec3::new(0.5, 0.6, 0.7) }, &motion, &particles)?,
            2 => compare(&Cylinder { radius: 0.5, half_height: 0.7 }, &motion, &particles)?,
            _ => compare(&Capsule::new(0.5, 0.3, 0.4, 0.01), &motion, &particles)?,
        }
    }

    /// Into a ball it is stopped at the plane where it enters, to what twelve steps of Newton's leave; past it nothing happens.
    #[test]
    fn a_long_path_is_stopped_by_what_it_enters_alone(
        from in vector(3.0), aim in vector(1.0), aside in 0.0_f32..2.0, travel in 0.5_f32..10.0, radius in 0.3_f32..2.0, at in vector(1.0),
    ) {
        prop_assume!(from.length() > 1.01 * radius && from.cross(aim).length() > 0.1);
        // Past the middle by a part of the radius.
        let off = aim.reject_from(from).normalize() * aside * radius;
        let direction = (off - from).normalize();
        let path = [from, from + direction * travel];
        let motion = Motion { from: at, to: at, ..STILL };
        let contact = nearest(&Ball { radius }, &motion, 0, path.map(|p| p + at));
        let (r, d) = (f64::from(radius), direction.as_dvec3().normalize());
        let along = -from.as_dvec3().dot(d);
        let past = (from.as_dvec3().length_squared() - along * along).max(0.0).sqrt();
        prop_assume!((past / r - 1.0).abs() > 0.05);
        let enters = along - (r * r - past * past).max(0.0).sqrt();
        prop_assume!((enters - f64::from(travel)).abs() > 1e-3 && travel > 0.26 * radius);
        if past > r || enters > f64::from(travel) {
            prop_assert!(contact.depth < 0.0, "{}", contact.depth);
        } else {
            let hit = from.as_dvec3() + d * enters;
            let normal = hit.normalize();
            let depth = normal.dot(hit - (from.as_dvec3() + d * f64::from(travel)));
            prop_assert!(contact.normal.as_dvec3().distance(normal) < 1e-3, "{} {normal}", contact.normal);
            prop_assert!((f64::from(contact.depth) - depth).abs() < 2e-3 * f64::from(travel), "{} {depth}", contact.depth);
        }
    }
}

/// A path that starts deeper inside than a ten-thousandth of the size was inside, and is let through.
#[test]
fn a_path_is_followed_from_the_surface_on() {
    for (below, followed) in [(0.95e-4, true), (1.05e-4, false)] {
        let path = [Vec3::X * (2.0 - 2.0 * below), Vec3::X * -5.0];
        let contact = nearest(&Ball { radius: 2.0 }, &STILL, 0, path);
        assert_eq!(contact.depth > 0.0, followed, "{below}: {}", contact.depth);
        // It ends on the surface, and not where it began.
        let end = path[1].x + contact.normal.x * contact.depth;
        assert_eq!((end - 2.0).abs() < 2e-6, followed, "{below}: {end}");
    }
}

/// Distance that a particle can go in a solid before it comes nearer to the other side.
#[test]
fn the_size_of_a_solid_is_the_radius_of_what_fits_into_it() {
    let size = Vec3::new(0.5, 0.3, 0.7);
    assert_eq!(Ball { radius: 0.4 }.size(), 0.4);
    assert_eq!(Cuboid { half_size: size }.size(), 0.3);
    for [radius, half_height] in [[0.2, 0.6], [0.6, 0.2]] {
        assert_eq!(
            Cylinder {
                radius,
                half_height
            }
            .size(),
            0.2
        );
    }
    for [bottom, top] in [[0.2, 0.6], [0.6, 0.2], [0.2, 0.2]] {
        assert!((Capsule::new(bottom, top, 0.9, 0.01).size() - 0.21).abs() < 1e-6);
    }
    // One ball contains the other.
    assert!((Capsule::new(0.2, 0.6, 0.1, 0.01).size() - 0.61).abs() < 1e-6);
}
