//! Half-spaces, heights and contact planes of meshes.

use crate::properties::*;
use bevy_math::{DVec3, Mat3, UVec2, Vec2, Vec3};
use fearless_simd::Level;
use parry3d::{
    query::{Ray, RayCast},
    shape::HeightField,
    utils::Array2,
};

use super::{
    cases,
    contact::{Meeting, Particles, Verdict, near, particles},
    vector,
};
use crate::{
    kernels::{
        half_space::{self, MovingHalfSpace},
        patches::{ContactPlanes, Patches, outdated},
        solid::{self, Motion},
        terrain::Terrain,
    },
    points::Points,
};

/// Below the margin, or noted before along the same normal and no further above than it was below.
fn rule(plane: &MovingHalfSpace, particles: &Particles, i: usize) -> Verdict {
    let normal = plane.normal.as_dvec3();
    let from = particles.from[i].as_dvec3() - plane.from.as_dvec3();
    let to = particles.to[i].as_dvec3() - plane.to.as_dvec3();
    let margin = f64::from(plane.margin);
    let height = normal.dot(to) - margin;
    let (noted, depth) = particles.known(i);
    let (cos, depth_at_start) = (normal.dot(noted), margin - normal.dot(from));
    let most = f64::from(particles.most);
    if near(height, 0.0)
        || near(height, depth)
        || near(cos, 0.9)
        || near(cos, 0.7)
        || near(depth_at_start, most)
    {
        return Verdict::Doubt;
    }
    if height < 0.0 || (depth > 0.0 && cos > 0.9 && height < depth) {
        let depth = (-height).max(0.0);
        let surface = DVec3::ZERO;
        return Verdict::Touches(Meeting {
            from,
            to,
            normal,
            depth,
            depth_at_start,
            surface,
        });
    }
    Verdict::Free
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn half_spaces_keep_particles_out_as_stated(
        normal in vector(1.0), from in vector(1.0), moved in vector(0.1), margin in 0.0_f32..0.1, friction in 0.0_f32..1.5,
        mut particles in particles(1.0, 0.2),
    ) {
        prop_assume!(normal.length() > 0.1);
        let plane = MovingHalfSpace { from, to: from + moved, normal: normal.normalize(), margin, friction };
        for (normal, _) in particles.noted.iter_mut().flatten() {
            *normal = (plane.normal + 0.8 * *normal).normalize_or(Vec3::X);
        }
        let all = 0..particles.from.len();
        let is = particles.collide(|touching| half_space::collide_all(Level::new(), &plane, touching, all));
        let outside = |[start, end]: [DVec3; 2]| [start + plane.from.as_dvec3(), end + plane.to.as_dvec3()];
        particles.compare(&is, friction, 5e-6, |i| rule(&plane, &particles, i), outside)?;
    }

    /// Each particle has a half-space of its own.
    #[test]
    fn particles_meet_the_planes_that_they_see(
        planes in prop::collection::vec((vector(1.0), vector(0.5)), 40), margin in 0.0_f32..0.1, friction in 0.0_f32..1.5,
        particles in particles(1.0, 0.2),
    ) {
        let mut patches = Patches::default();
        patches.reset(particles.from.len());
        let plane = |i: usize| MovingHalfSpace {
            from: planes[i].1,
            to: planes[i].1,
            normal: planes[i].0.normalize_or(Vec3::Y),
            margin,
            friction,
        };
        for (i, to) in particles.to.iter().enumerate() {
            let MovingHalfSpace { from, normal, .. } = plane(i);
            patches.set(i, from, normal, Vec3::ZERO, 1.0);
            prop_assert!((patches.height(i, *to) - normal.dot(to - from)).abs() < 1e-6);
        }
        let seen = ContactPlanes { patches: &patches, margin };
        let motion = Motion { from: Vec3::ZERO, to: Vec3::ZERO, axes: Mat3::IDENTITY, turn: Mat3::IDENTITY, friction };
        let all = 0..particles.from.len();
        let is = particles.collide(|touching| solid::collide_all(Level::new(), &seen, &motion, touching, all));
        let rule = |i: usize| {
            let plane = plane(i);
            match rule(&plane, &particles, i) {
                Verdict::Touches(mut meeting) => {
                    // From the plane's point to the origin.
                    meeting.from += plane.from.as_dvec3();
                    meeting.to += plane.to.as_dvec3();
                    Verdict::Touches(meeting)
                }
                other => other,
            }
        };
        particles.compare(&is, friction, 5e-6, rule, |path| path)?;
    }

    /// The plane of the triangle below, as another library's rays find it, and its distance.
    #[test]
    fn heights_are_those_of_the_triangles_below(
        heights in prop::collection::vec(-1.0_f32..1.0, 5 * 4), cell in [0.5_f32..2.0, 0.5_f32..2.0], stretch in 0.5_f32..2.0,
        margin in 0.0_f32..0.1, at in [-0.6_f32..0.6, -0.6_f32..0.6], above in -1.0_f32..1.0, mirrored in any::<bool>(),
    ) {
        let sign = if mirrored { -1.0 } else { 1.0 };
        let terrain = Terrain {
            heights: &heights, resolution: UVec2::new(5, 4), cell: Vec2::new(sign * cell[0], cell[1]), stretch, margin,
        };
        let size = Vec3::new(4.0 * cell[0], stretch, 3.0 * cell[1]);
        // Rows are along x there.
        let turned: Vec<f32> = (0..5).flat_map(|column| (0..4).map(move |row| 5 * row + column)).map(|i| heights[i]).collect();
        let field = HeightField::new(Array2::new(4, 5, turned), size);
        let place = Vec3::new(at[0] * size.x, 0.0, at[1] * size.z);
        let motion = Motion { from: Vec3::ZERO, to: Vec3::ZERO, axes: Mat3::IDENTITY, turn: Mat3::IDENTITY, friction: 0.0 };
        let of = |p: Vec3| {
            let p = Vec3::new(sign * p.x, p.y, p.z);
            let contact = solid::nearest(&terrain, &motion, 0, [p, p]);
            (Vec3::new(sign * contact.normal.x, contact.normal.y, contact.normal.z), contact.depth)
        };
        let ray = Ray::new(place + Vec3::Y * 10.0, Vec3::NEG_Y);
        let hit = field.cast_local_ray_and_get_normal(&ray, f32::MAX, false);
        if at.iter().any(|x| x.abs() > 0.501) {
            prop_assert!(of(place).1 < -1e30, "nothing is below");
            return Ok(());
        }
        prop_assume!(at.iter().all(|x| x.abs() < 0.499));
        let Some(hit) = hit else { return Err(TestCaseError::reject("an edge")) };
        let height = 10.0 - hit.time_of_impact;
        let (normal, depth) = of(place + Vec3::Y * (height + above));
        let wanted = hit.normal * hit.normal.y.signum();
        // Not along the edges of triangles.
        prop_assume!((normal.dot(wanted) - 1.0).abs() < 1e-3);
        prop_assert!(normal.distance(wanted) < 1e-4, "{normal} {wanted}");
        prop_assert!((depth - (margin - above * wanted.y)).abs() < 1e-4, "{depth}");
    }

    /// A plane is valid within its distance from the position for which it was computed, in the axes of the mesh; a held particle needs
    /// none.
    #[test]
    fn planes_hold_near_where_they_were_looked_for(
        places in prop::collection::vec((vector(1.0), vector(0.1), 0.0_f32..0.15), 1..40), turn in vector(1.0), to in vector(1.0),
    ) {
        let axes = Mat3::from_quat(bevy_math::Quat::from_scaled_axis(turn));
        let mut patches = Patches::default();
        patches.reset(places.len() + 2);
        for (i, (place, _, holds)) in places.iter().enumerate() {
            patches.set(i, *place, Vec3::Y, *place, *holds);
        }
        let position: Points = places.iter().map(|(p, moved, _)| to + axes * (p + moved)).chain([Vec3::ZERO; 2]).collect();
        // The last but one was never looked for, the last one is held.
        let inv_mass: Vec<f32> = (0..places.len() + 2).map(|i| if i == places.len() + 1 { 0.0 } else { 1.0 }).collect();
        let motion = Motion { from: Vec3::ZERO, to, axes, turn: Mat3::IDENTITY, friction: 0.0 };
        prop_assume!(places.iter().all(|(_, moved, holds)| (moved.length() - holds).abs() > 1e-5));
        let mut found = Vec::new();
        outdated(Level::new(), &patches, &motion, (&position, &inv_mass), 0..inv_mass.len(), |i| found.push(i));
        found.sort_unstable();
        let wanted = places.iter().enumerate().filter(|(_, (_, moved, holds))| moved.length() > *holds).map(|(i, _)| i);
        prop_assert_eq!(found, wanted.chain([places.len()]).collect::<Vec<_>>());
    }
}

/// A point on the last row or column belongs to the last cell.
#[test]
fn heights_end_with_those_of_the_last_corners() {
    let heights: Vec<f32> = (0..9).map(|i| 0.1 * (i * i) as f32).collect();
    let terrain = Terrain {
        heights: &heights,
        resolution: UVec2::splat(3),
        cell: Vec2::ONE,
        stretch: 1.0,
        margin: 0.0,
    };
    let motion = Motion {
        from: Vec3::ZERO,
        to: Vec3::ZERO,
        axes: Mat3::IDENTITY,
        turn: Mat3::IDENTITY,
        friction: 0.0,
    };
    for (i, height) in heights.iter().enumerate() {
        let p = Vec3::new((i % 3) as f32 - 1.0, *height, (i / 3) as f32 - 1.0);
        let contact = solid::nearest(&terrain, &motion, 0, [p, p]);
        assert!(contact.depth.abs() < 1e-6, "{i}: {}", contact.depth);
    }
    // The plane at the border is that beside it.
    for at in [Vec2::new(1.0, -0.5), Vec2::new(-0.5, 1.0)] {
        let normal = |at: Vec2| {
            let p = Vec3::new(at.x, 0.0, at.y);
            solid::nearest(&terrain, &motion, 0, [p, p]).normal
        };
        assert!(normal(at).distance(normal(at * 0.999)) < 1e-6, "{at}");
    }
}
