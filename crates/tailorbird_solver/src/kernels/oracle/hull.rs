//! Hulls, as the planes of their faces.

use crate::properties::*;
use bevy_math::{Vec3, Vec4};
use fearless_simd::Level;
use parry3d::{query::PointQuery, shape::ConvexPolyhedron};

use super::{
    cases,
    contact::{meeting, particles},
    solid::{MOST, STILL, near_of},
    vector,
};
use crate::kernels::{
    planes::{PlaneList, Planes},
    solid::collide_all,
};

/// A hull of points near a sphere, as its planes, with another library's.
fn hull(points: &[Vec3]) -> Option<(ConvexPolyhedron, PlaneList)> {
    let shape = ConvexPolyhedron::from_convex_hull(points)?;
    let planes = shape.faces().iter().map(|face| {
        let vertex = shape.vertices_adj_to_face()[face.first_vertex_or_edge as usize];
        let normal = face.normal;
        normal.extend(normal.dot(shape.points()[vertex as usize]))
    });
    let planes = PlaneList::new(&planes.collect::<Vec<Vec4>>());
    Some((shape, planes))
}

proptest! {
    #![proptest_config(cases(200))]

    /// Hulls of few planes, and of so many that only planes are searched that can be the nearest.
    #[test]
    fn a_hull_is_as_far_as_the_plane_of_its_nearest_face(
        points in prop_oneof![prop::collection::vec(vector(1.0), 5..9), prop::collection::vec(vector(1.0), 40..80)],
        places in prop::collection::vec(vector(1.5), 8), margin in 0.0_f32..0.1,
    ) {
        let points: Vec<Vec3> = points.into_iter().map(|p| p.normalize_or(Vec3::X) * (1.0 + 0.05 * p.x)).collect();
        let Some((shape, planes)) = hull(&points) else { return Err(TestCaseError::reject("no hull")) };
        let solid = Planes { planes: &planes, margin, size: 0.5 };
        for p in places {
            let (distance, normal) = near_of(&solid, p);
            let faces = shape.faces().iter().map(|face| {
                let vertex = shape.vertices_adj_to_face()[face.first_vertex_or_edge as usize];
                face.normal.as_dvec3().dot(p.as_dvec3() - shape.points()[vertex as usize].as_dvec3())
            });
            let wanted = faces.fold(f64::MIN, f64::max);
            prop_assert!((distance + f64::from(margin) - wanted).abs() < MOST, "{distance} {wanted}");
            prop_assert!((near_of(&solid, p + normal.as_vec3() * 1e-2).0 - distance - 1e-2).abs() < MOST);
            let other = f64::from(shape.distance_to_local_point(p, false));
            // It takes faces for one whose normals are apart by up to 0.025, so that its hull is another by as much as that.
            prop_assert!(other > 0.0 || (wanted - other).abs() < 0.025, "{wanted} {other}");
            prop_assert!(wanted < other + 0.025, "{wanted} {other}");
        }
    }

    /// Many points at once, some together and some far apart: whichever planes are looked at, the nearest is among them.
    #[test]
    fn many_points_at_once_find_the_nearest_of_many_planes(
        points in prop::collection::vec(vector(1.0), 40..120), middle in vector(0.8), spread in 0.0_f32..1.0,
        mut particles in particles(1.0, 0.05),
    ) {
        let points: Vec<Vec3> = points.into_iter().map(|p| p.normalize_or(Vec3::X)).collect();
        let Some((_, planes)) = hull(&points) else { return Err(TestCaseError::reject("no hull")) };
        let solid = Planes { planes: &planes, margin: 0.0, size: 0.5 };
        for (from, to) in particles.from.iter_mut().zip(&mut particles.to) {
            [*from, *to] = [*from, *to].map(|p| middle + spread * p);
        }
        let rule = |i: usize| {
            let (from, to) = (particles.from[i], particles.to[i]);
            let side = |p: Vec3| near_of(&solid, p);
            meeting(&particles, i, [from, to].map(Vec3::as_dvec3), side(to), side(from).0)
        };
        let all = 0..particles.from.len();
        let is = particles.collide(|touching| collide_all(Level::new(), &solid, &STILL, touching, all));
        // Where two planes are as near as each other, either is right.
        particles.compare(&is, 0.0, 1e-4, rule, |path| path)?;
    }
}
