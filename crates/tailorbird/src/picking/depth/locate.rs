//! Search for the triangle of a cloth at a point.

use bevy_camera::visibility::{RenderLayers, ViewVisibility};
use bevy_ecs::{prelude::*, query::QueryData};
use bevy_math::Vec3;
use bevy_picking::{Pickable, backend::HitData};
use bevy_shape::Ray3d;
use tailorbird_cloth::{
    prelude::*,
    topology::order::{Given, Stored},
};

use super::{super::ClothPointerHit, view::VisiblePoint};

/// Largest distance of a visible point from the cloth's surface, as a fraction of the edges there. Room for rounding: things that touch the
/// cloth from the other side are hidden by it.
const TOLERANCE: f32 = 0.25;

/// Components of a cloth that are read.
#[derive(QueryData)]
pub(super) struct Cloths {
    entity: Entity,
    topology: &'static ClothTopology,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    bounds: &'static ClothBounds,
    pickable: Option<&'static Pickable>,
    layers: Option<&'static RenderLayers>,
    visibility: Option<&'static ViewVisibility>,
}

/// A place on a cloth that moves with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Located {
    cloth: Entity,
    /// Of the topology that the triangle belongs to.
    revision: u64,
    triangle: usize,
    barycentric: Vec3,
}

/// The place on the nearest cloth at a point that was visible to a camera with these layers, where there is one.
/// `seconds` is how long the cloth may have moved since.
pub(super) fn nearest(
    point: VisiblePoint,
    seconds: f32,
    camera_layers: Option<&RenderLayers>,
    cloths: &Query<Cloths, With<Cloth>>,
) -> Option<Located> {
    let default_layers = RenderLayers::default();
    let camera_layers = camera_layers.unwrap_or(&default_layers);
    cloths
        .iter()
        .filter(|cloth| {
            cloth.pickable.is_none_or(|pickable| pickable.is_hoverable)
                && cloth.visibility.is_none_or(|visibility| visibility.get())
                && camera_layers.intersects(cloth.layers.unwrap_or(&default_layers))
        })
        .filter_map(|cloth| cloth.locate(point, seconds))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(located, _)| located)
}

impl ClothsItem<'_, '_> {
    /// The nearest place on this cloth and its distance \[m\], where it is near enough.
    fn locate(&self, visible: VisiblePoint, seconds: f32) -> Option<(Located, f32)> {
        let (particles, triangles) = (self.particles, self.topology.triangles());
        if particles.is_empty() || particles.len() != self.topology.particles() {
            return None;
        }
        let points = particles.points();
        let point = self.frame.to_frame(visible.position);
        let to_box = point.distance(point.clamp(self.bounds.min, self.bounds.max));
        if to_box > self.bounds.max.distance(self.bounds.min) {
            return None;
        }

        // The triangle that holds the point has a corner within its longest edge, so it is among those whose first
        // corner is not much further away than the nearest particle.
        let (start, distance) = particles.closest_particle(point)?;
        let edge = self
            .topology
            .neighbors(particles.order().stored(Given(start as u32)))
            .iter()
            .map(|i| points.get(i.index()).distance(particles.position(start)))
            .fold(0.0, f32::max);
        let reach = (distance + 2.0 * edge).powi(2);
        let (triangle, barycentric, distance) = triangles
            .iter()
            .enumerate()
            .filter(|(_, [first, ..])| points.get(*first as usize).distance_squared(point) <= reach)
            .map(|(triangle, corners)| {
                let corners = corners.map(|i| points.get(i as usize));
                let barycentric = closest_on_triangle(point, corners);
                (
                    triangle,
                    barycentric,
                    weigh(barycentric, corners).distance(point),
                )
            })
            .min_by(|a, b| a.2.total_cmp(&b.2))?;

        let corners = triangles.get(triangle)?.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| points.get(i));
        let edge = (a.distance(b) + b.distance(c) + c.distance(a)) / 3.0;
        let speed = corners
            .into_iter()
            .map(|i| particles.order().given(Stored(i as u32)).index())
            .map(|i| particles.velocity(i).length())
            .fold(0.0, f32::max);
        let located = Located {
            cloth: self.entity,
            revision: self.topology.revision,
            triangle,
            barycentric,
        };
        let tolerance = TOLERANCE * edge + visible.texel_width + speed * seconds;
        (distance <= tolerance).then_some((located, distance))
    }
}

impl Located {
    /// The hit, where the cloth is now. `None` when it is gone or was rebuilt.
    pub fn pick(
        &self,
        camera: Entity,
        ray: Ray3d,
        cloths: &Query<Cloths, With<Cloth>>,
    ) -> Option<(Entity, HitData)> {
        let cloth = cloths.get(self.cloth).ok()?;
        if cloth.topology.revision != self.revision {
            return None;
        }
        let indices = cloth
            .topology
            .triangles()
            .get(self.triangle)?
            .map(|i| i as usize);
        if indices.iter().any(|&i| i >= cloth.particles.len()) {
            return None;
        }
        let [a, b, c] = indices.map(|i| cloth.frame.to_world(cloth.particles.points().get(i)));
        let position = weigh(self.barycentric, [a, b, c]);
        let normal = (b - a).cross(c - a).normalize_or(-*ray.direction);
        let extra = ClothPointerHit {
            triangle: self.triangle,
            barycentric: self.barycentric,
            particle: indices
                .into_iter()
                .map(|i| cloth.particles.order().given(Stored(i as u32)).index())
                .min_by(|&i, &j| {
                    let distance = |i| {
                        cloth
                            .particles
                            .world_position(i, cloth.frame)
                            .distance_squared(position)
                    };
                    distance(i).total_cmp(&distance(j))
                })?,
        };
        let data = HitData::new_with_extra(
            camera,
            (position - ray.origin).dot(*ray.direction),
            Some(position),
            Some(if normal.dot(*ray.direction) > 0.0 {
                -normal
            } else {
                normal
            }),
            extra,
        );
        Some((self.cloth, data))
    }
}

fn weigh(barycentric: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    a * barycentric.x + b * barycentric.y + c * barycentric.z
}

/// Barycentric coordinates of the point of a triangle that is nearest to `point`: by the seven regions around it (Ericson,
/// Real-Time Collision Detection, 2005, 5.1.5). Where an edge has no length one of its ends is taken.
fn closest_on_triangle(point: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let (ab, ac) = (b - a, c - a);
    let ratio = |part: f32, whole: f32| if whole > 0.0 { part / whole } else { 0.0 };

    let ap = point - a;
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Vec3::X;
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return Vec3::Y;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = ratio(d1, d1 - d3);
        return Vec3::new(1.0 - t, t, 0.0);
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return Vec3::Z;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = ratio(d2, d2 - d6);
        return Vec3::new(1.0 - t, 0.0, t);
    }
    let va = d3 * d6 - d5 * d4;
    let (to_b, to_c) = (d4 - d3, d5 - d6);
    if va <= 0.0 && to_b >= 0.0 && to_c >= 0.0 {
        let t = ratio(to_b, to_b + to_c);
        return Vec3::new(0.0, 1.0 - t, t);
    }
    let whole = va + vb + vc;
    let (v, w) = (ratio(vb, whole), ratio(vc, whole));
    Vec3::new(1.0 - v - w, v, w)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No point of a fine raster of the triangle is nearer than the one that is found.
    #[test]
    fn nothing_on_the_triangle_is_nearer() {
        let corners = [
            Vec3::new(0.1, 0.0, 0.2),
            Vec3::new(1.0, 0.2, -0.1),
            Vec3::new(0.3, 0.9, 0.4),
        ];
        for i in 0..7 * 7 * 7 {
            let point = Vec3::new((i % 7) as f32, (i / 7 % 7) as f32, (i / 49) as f32) / 3.0 - 0.5;
            let found = closest_on_triangle(point, corners);
            assert!(found.min_element() >= 0.0 && (found.element_sum() - 1.0).abs() < 1e-6);
            let distance = weigh(found, corners).distance(point);
            for v in 0..=40 {
                for w in 0..=40 - v {
                    let (v, w) = (v as f32 / 40.0, w as f32 / 40.0);
                    let other = weigh(Vec3::new(1.0 - v - w, v, w), corners);
                    assert!(distance <= other.distance(point) + 1e-6, "{point}: {found}");
                }
            }
        }
    }

    #[test]
    fn degenerate_triangles_give_finite_weights() {
        let (a, b) = (Vec3::ZERO, Vec3::X);
        for corners in [[a, a, a], [a, b, b], [a, a, b], [a, b, a], [a, b, b * 2.0]] {
            for point in [a, b, Vec3::new(0.4, 1.0, 0.0), Vec3::NEG_X] {
                let found = closest_on_triangle(point, corners);
                assert!(found.is_finite() && (found.element_sum() - 1.0).abs() < 1e-6);
            }
        }
    }
}
