//! Normals of triangles and, weighted by area, of particles.

use bevy_math::Vec3;

use crate::points::Points;

/// Unit normals of the triangles. One without area keeps the normal it had.
///
/// # Panics
/// When a corner is not below the number of particles, or there are fewer normals than triangles.
pub fn flat(triangles: &[[u32; 3]], position: &Points, normals: &mut Points) {
    for (k, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|i| position.get(i as usize));
        let normal = (b - a).cross(c - a).normalize_or(normals.get(k));
        normals.set(k, normal);
    }
}

/// Unit normals of the particles: the sum of the cross products of the triangles around each, whose lengths are twice their
/// areas. A particle without a triangle, or whose triangles cancel, gets +z.
///
/// # Panics
/// When a corner is not below the number of particles, or there are fewer normals than particles.
pub fn smooth(triangles: &[[u32; 3]], position: &Points, normals: &mut Points) {
    normals.fill(Vec3::ZERO);
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| position.get(i));
        let cross = (b - a).cross(c - a);
        for i in corners {
            normals.add(i, cross);
        }
    }
    for i in 0..normals.len() {
        normals.set(i, normals.get(i).normalize_or(Vec3::Z));
    }
}
