//! Questions about where a cloth is.

use bevy_math::Vec3;
use bevy_shape::Ray3d;
use tailorbird_solver::topology::{Topology, order::Stored};

use crate::{bounds::ClothBounds, particles::ClothParticles};

/// Hit of a ray on a cloth, in the space of the ray.
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
            let corners = corners.map(|i| self.0.state.position.get(i as usize));
            if let Some((barycentric, distance)) = meet(ray, corners)
                && nearest.is_none_or(|(.., d)| distance < d)
            {
                nearest = Some((triangle, barycentric, distance));
            }
        }
        let (triangle, barycentric, distance) = nearest?;
        let corners = topology.triangles().get(triangle)?;
        let [a, b, c] = corners.map(|i| self.0.state.position.get(i as usize));
        let point = ray.get_point(distance);
        let normal = (b - a).cross(c - a).normalize_or(-*ray.direction);
        let particle = corners.into_iter().map(|i| i as usize).min_by(|&i, &j| {
            let distance = |i| self.0.state.position.get(i).distance_squared(point);
            distance(i).total_cmp(&distance(j))
        })?;
        Some(ClothHit {
            triangle,
            barycentric,
            particle: self.order.given(Stored(particle as u32)).index(),
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

/// Tolerance of a hit outside a triangle, as a weight of a corner: rounding could take the edge from both of its triangles.
const EDGE: f32 = 1e-5;

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
    let weights = Vec3::new(1.0 - v - w, v, w);
    // Nor is what is not a number at any place.
    if !(weights.cmpge(Vec3::splat(-EDGE)).all() && distance >= 0.0) {
        return None;
    }
    let inside = weights.max(Vec3::ZERO);
    Some((inside / inside.element_sum(), distance))
}

#[cfg(test)]
mod tests {
    use bevy_math::{Dir3, UVec2, Vec2};

    use super::*;
    use crate::cloth::Cloth;

    /// Rays through particles and edges find no gap between the triangles.
    #[test]
    fn rays_do_not_slip_between_triangles() {
        let cloth = Cloth::grid(Vec2::ONE, UVec2::new(12, 12)).centered();
        let topology = Topology::build(&cloth.shape, Vec3::ONE).expect("valid");
        let mut particles = ClothParticles::at_rest(&topology);
        for i in 0..particles.len() {
            let p = particles.0.state.position.get(i);
            let wave = 0.1 * (7.0 * p.x).sin() * (5.0 * p.y).cos();
            particles.0.state.position.set(i, p + Vec3::Z * wave);
        }
        let bounds = ClothBounds {
            min: Vec3::splat(-0.6),
            max: Vec3::splat(0.6),
        };
        let inner = |i: &usize| (1..11).contains(&(i % 12)) && (1..11).contains(&(i / 12));
        for k in 0..200 {
            let turn = k as f32;
            let origin = Vec3::new(
                0.9 * turn.sin(),
                0.7 * (1.3 * turn).cos(),
                2.0 + 0.01 * turn,
            );
            for i in (0..particles.len()).filter(inner) {
                for neighbour in [i, i + 1, i + 12, i + 13] {
                    let to = (particles.position(i) + particles.position(neighbour)) / 2.0;
                    let ray = Ray3d::new(origin, Dir3::new(to - origin).expect("away"));
                    let hit = particles.cast_ray(&topology, &bounds, ray);
                    let hit =
                        hit.unwrap_or_else(|| panic!("no hit at {i}, {neighbour} from {origin}"));
                    assert!((hit.barycentric.element_sum() - 1.0).abs() < 1e-6);
                    assert!(hit.barycentric.min_element() >= 0.0);
                }
            }
        }
        let nowhere = Ray3d::new(Vec3::NAN, Dir3::NEG_Z);
        assert_eq!(particles.cast_ray(&topology, &bounds, nowhere), None);
    }

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
