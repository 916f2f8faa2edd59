//! Arrows of moving air.

use bevy_color::{Alpha, Srgba, palettes::tailwind};
use bevy_ecs::prelude::*;
use bevy_gizmos::gizmos::Gizmos;
use bevy_math::{Affine3A, Isometry3d, Vec3};
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::prelude::*;

use super::ClothGizmos;

const COLOR: Srgba = tailwind::CYAN_300;

/// Arrows along each side of a zone, and around each cloth.
const ARROWS: i32 = 5;

/// Length of an arrow for 1 m/s \[m\].
const PER_SPEED: f32 = 0.04;

/// Speed below which air has no arrow [m/s].
const STILL: f32 = 0.05;

pub(super) fn draw(
    wind: Res<ClothWindState>,
    zones: Query<(&ClothWindZone, &GlobalTransform)>,
    cloths: Query<(&ClothFrame, &ClothBounds), With<Cloth>>,
    mut gizmos: Gizmos<ClothGizmos>,
) {
    for (zone, transform) in &zones {
        let at = transform.affine();
        let (scale, rotation, translation) = at.to_scale_rotation_translation();
        let half = match zone.shape {
            ClothWindShape::Cuboid { size } => {
                gizmos.cube(at * Affine3A::from_scale(size), COLOR);
                let half = 0.5 * size * scale.abs();
                let inner = (half - zone.falloff).max(Vec3::ZERO);
                let full =
                    Affine3A::from_scale_rotation_translation(2.0 * inner, rotation, translation);
                gizmos.cube(full, COLOR.with_alpha(0.3));
                half
            }
            ClothWindShape::Sphere { radius } => {
                let radius = radius * scale.abs().max_element();
                let place = Isometry3d::new(translation, rotation);
                gizmos.sphere(place, radius, COLOR);
                let inner = (radius - zone.falloff).max(0.0);
                gizmos.sphere(place, inner, COLOR.with_alpha(0.3));
                Vec3::splat(radius)
            }
        };
        let place = Isometry3d::new(translation, rotation);
        arrows(&mut gizmos, &wind, place, half);
    }
    for (frame, bounds) in &cloths {
        let middle = 0.5 * (bounds.min + bounds.max);
        let half = 0.5 * (bounds.max - bounds.min) + 0.1;
        let place = frame.isometry() * Isometry3d::from_translation(middle);
        arrows(&mut gizmos, &wind, place, half);
    }
}

/// Arrows in a box of these half sides.
fn arrows(gizmos: &mut Gizmos<ClothGizmos>, wind: &ClothWindState, place: Isometry3d, half: Vec3) {
    if !half.is_finite() {
        return;
    }
    let part = |k: i32| (2 * k + 1 - ARROWS) as f32 / ARROWS as f32;
    for k in 0..ARROWS.pow(3) {
        let (x, y, z) = (k % ARROWS, k / ARROWS % ARROWS, k / ARROWS.pow(2));
        let from = place * (half * Vec3::new(part(x), part(y), part(z)));
        let velocity = wind.velocity_at(from);
        if velocity.length() > STILL {
            gizmos.arrow(from, from + velocity * PER_SPEED, COLOR);
        }
    }
}
