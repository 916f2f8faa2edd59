//! Questions about where a cloth is.

use bevy_math::{Ray3d, Vec3};

use crate::{bounds::ClothBounds, particles::ClothParticles, topology::Topology};

/// Where a ray meets a cloth, in the space of the ray that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothHit {
    /// The triangle, an index into [`Topology::triangles()`].
    pub triangle: usize,
    /// Weights of its three corners; they add up to 1.
    pub barycentric: Vec3,
    /// The corner that is nearest to the point.
    pub particle: usize,
    /// The point \[m\].
    pub point: Vec3,
    /// Unit normal of the triangle, on the side that the ray came from.
    pub normal: Vec3,
    /// Distance from the ray's origin \[m\].
    pub distance: f32,
}

impl ClothParticles {
    /// The first triangle that a ray (in the cloth's frame) meets, from either side.
    pub fn cast_ray(
        &self,
        topology: &Topology,
        bounds: &ClothBounds,
        ray: Ray3d,
    ) -> Option<ClothHit> {
        if self.len() != topology.particles() || !meets_box(ray, bounds) {
            return None;
        }
        let mut nearest: Option<(usize, Vec3, f32)> = None;
        for (triangle, corners) in topology.triangles().iter().enumerate() {
            let corners = corners.map(|i| self.position.get(i as usize));
            if let Some((barycentric, distance)) = meet(ray, corners)
                && nearest.is_none_or(|(.., d)| distance < d)
            {
                nearest = Some((triangle, barycentric, distance));
            }
        }
        let (triangle, barycentric, distance) = nearest?;
        let corners = topology.triangles().get(triangle)?;
        let [a, b, c] = corners.map(|i| self.position.get(i as usize));
        let point = ray.get_point(distance);
        let normal = (b - a).cross(c - a).normalize_or(-*ray.direction);
        let particle = corners.into_iter().map(|i| i as usize).min_by(|&i, &j| {
            let distance = |i| self.position.get(i).distance_squared(point);
            distance(i).total_cmp(&distance(j))
        })?;
        Some(ClothHit {
            triangle,
            barycentric,
            particle: self.order.given(particle as u32) as usize,
            point,
            normal: if normal.dot(*ray.direction) > 0.0 {
                -normal
            } else {
                normal
            },
            distance,
        })
    }

    /// The particle nearest to a point of the cloth's frame \[m\], and its distance \[m\].
    pub fn closest_particle(&self, point: Vec3) -> Option<(usize, f32)> {
        self.positions()
            .map(|p| p.distance_squared(point))
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(i, d)| (i, d.sqrt()))
    }
}

/// Slab test.
fn meets_box(ray: Ray3d, bounds: &ClothBounds) -> bool {
    let inverse = ray.direction.recip();
    let (a, b) = (
        (bounds.min - ray.origin) * inverse,
        (bounds.max - ray.origin) * inverse,
    );
    // A ray inside the plane of a flat box gives 0 · ∞ = NaN, which min and max pass over.
    let enter = a.min(b).to_array().into_iter().fold(0.0, f32::max);
    let leave = a
        .max(b)
        .to_array()
        .into_iter()
        .fold(f32::INFINITY, f32::min);
    enter <= leave * (1.0 + 1e-5)
}

/// Ray against triangle (Möller and Trumbore 1997), both sides: barycentric coordinates and distance.
fn meet(ray: Ray3d, [a, b, c]: [Vec3; 3]) -> Option<(Vec3, f32)> {
    let direction = *ray.direction;
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from_a = ray.origin - a;
    let v = from_a.dot(p) / determinant;
    let q = from_a.cross(ab);
    let w = direction.dot(q) / determinant;
    let distance = ac.dot(q) / determinant;
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance >= 0.0)
        .then_some((Vec3::new(1.0 - v - w, v, w), distance))
}

#[cfg(test)]
mod tests {
    use bevy_math::{Dir3, UVec2, Vec2};

    use super::*;
    use crate::cloth::Cloth;

    #[test]
    fn a_ray_meets_the_front_triangle_from_both_sides() {
        let cloth = Cloth::grid(Vec2::ONE, UVec2::new(5, 5)).centered();
        let topology = Topology::build(&cloth.shape, Vec3::ONE).expect("valid");
        let particles = ClothParticles::at_rest(&topology);
        let bounds = ClothBounds {
            min: Vec3::new(-0.5, -0.5, 0.0),
            max: Vec3::new(0.5, 0.5, 0.0),
        };
        for side in [1.0, -1.0] {
            let ray = Ray3d::new(
                Vec3::new(0.26, 0.01, 2.0 * side),
                Dir3::new(Vec3::Z * -side).expect("unit"),
            );
            let hit = particles.cast_ray(&topology, &bounds, ray).expect("hit");
            assert!((hit.distance - 2.0).abs() < 1e-6);
            assert_eq!(hit.particle, 2 * 5 + 3);
            assert_eq!(hit.normal, Vec3::Z * side);
            let [a, b, c] = topology
                .triangles()
                .get(hit.triangle)
                .expect("one")
                .map(|i| particles.position(i as usize));
            let point = a * hit.barycentric.x + b * hit.barycentric.y + c * hit.barycentric.z;
            assert!(point.distance(hit.point) < 1e-6);
        }
        let miss = Ray3d::new(Vec3::new(0.6, 0.0, 2.0), Dir3::NEG_Z);
        assert_eq!(particles.cast_ray(&topology, &bounds, miss), None);
        assert_eq!(
            particles
                .closest_particle(Vec3::new(-9.0, 9.0, 0.0))
                .map(|c| c.0),
            Some(0)
        );
    }
}
