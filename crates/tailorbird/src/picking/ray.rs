//! The ray backend: a ray from the camera through the pointer, against the cloth's current triangles.

use bevy_camera::{
    Camera,
    visibility::{RenderLayers, ViewVisibility},
};
use bevy_ecs::prelude::*;
use bevy_math::Dir3;
use bevy_picking::Pickable;
use bevy_picking::backend::{HitData, PointerHits, ray::RayMap};
use bevy_shape::Ray3d;
use tailorbird_cloth::prelude::*;

use super::ClothPointerHit;

/// Sends a hit for each cloth under each pointer.
pub(super) fn update_hits(
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Option<&RenderLayers>)>,
    cloths: Query<
        (
            Entity,
            &ClothTopology,
            &ClothParticles,
            &ClothFrame,
            &ClothBounds,
            Option<&Pickable>,
            Option<&RenderLayers>,
            Option<&ViewVisibility>,
        ),
        With<Cloth>,
    >,
    mut hits: MessageWriter<PointerHits>,
) {
    for (id, ray) in rays.iter() {
        let Ok((camera, camera_layers)) = cameras.get(id.camera) else {
            continue;
        };
        let mut picks = Vec::new();
        for (entity, topology, particles, frame, bounds, pickable, layers, visibility) in &cloths {
            let pickable = pickable.is_none_or(|pickable| pickable.is_hoverable);
            let shown = visibility.is_none_or(|visibility| visibility.get());
            let camera_layers = camera_layers.cloned().unwrap_or_default();
            if !pickable
                || !shown
                || !camera_layers.intersects(&layers.cloned().unwrap_or_default())
            {
                continue;
            }
            let Ok(direction) = Dir3::new(frame.vector_to_frame(*ray.direction)) else {
                continue;
            };
            let local = Ray3d::new(frame.to_frame(ray.origin), direction);
            if let Some(hit) = particles.cast_ray(topology, bounds, local) {
                let extra = ClothPointerHit {
                    triangle: hit.triangle,
                    barycentric: hit.barycentric,
                    particle: hit.particle,
                };
                let data = HitData::new_with_extra(
                    id.camera,
                    hit.distance,
                    Some(frame.to_world(hit.point)),
                    Some(frame.vector_to_world(hit.normal)),
                    extra,
                );
                picks.push((entity, data));
            }
        }
        if !picks.is_empty() {
            hits.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}
