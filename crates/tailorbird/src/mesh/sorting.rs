//! Sorts transparent cloths by where they are now.
//!
//! The renderer sorts what is transparent by the middle of the mesh asset's box, as it was when that came into view. A cloth is somewhere
//! else by then, often far from the place of its entity.

use bevy_camera::primitives::Aabb;
use bevy_core_pipeline::core_3d::{Transparent3d, TransparentSortingInfo3d};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_pbr::Transmissive3d;
use bevy_render::{
    Extract, ExtractSchedule, Render, RenderSystems, render_phase::ViewSortedRenderPhases,
    sync_world::MainEntity,
};
use bevy_transform::components::GlobalTransform;

use super::ClothMeshOf;

/// The middles of the boxes around cloths, in the world \[m\].
#[derive(Resource, Default)]
struct Middles(Vec<(MainEntity, Vec3)>);

/// Adds what sorts, to the renderer's app.
pub(super) fn finish(render_app: &mut bevy_app::SubApp) {
    render_app
        .init_resource::<Middles>()
        .add_systems(ExtractSchedule, extract_middles)
        .add_systems(
            Render,
            move_middles
                .after(RenderSystems::Queue)
                .before(RenderSystems::PhaseSort),
        );
}

fn extract_middles(
    cloths: Extract<Query<(Entity, &GlobalTransform, &Aabb), With<ClothMeshOf>>>,
    mut middles: ResMut<Middles>,
) {
    middles.0.clear();
    middles
        .0
        .extend(cloths.iter().map(|(entity, place, around)| {
            let middle = place.affine().transform_point3a(around.center);
            (entity.into(), middle.into())
        }));
}

fn move_middles(
    middles: Res<Middles>,
    transparent: Option<ResMut<ViewSortedRenderPhases<Transparent3d>>>,
    transmissive: Option<ResMut<ViewSortedRenderPhases<Transmissive3d>>>,
) {
    for phase in transparent
        .into_iter()
        .flat_map(|all| all.into_inner().values_mut())
    {
        for (entity, middle) in &middles.0 {
            if let Some(item) = phase.items.get_mut(&(Entity::PLACEHOLDER, *entity)) {
                set_middle(&mut item.sorting_info, *middle);
            }
        }
    }
    for phase in transmissive
        .into_iter()
        .flat_map(|all| all.into_inner().values_mut())
    {
        for (entity, middle) in &middles.0 {
            if let Some(item) = phase.items.get_mut(&(Entity::PLACEHOLDER, *entity)) {
                set_middle(&mut item.sorting_info, *middle);
            }
        }
    }
}

fn set_middle(info: &mut TransparentSortingInfo3d, middle: Vec3) {
    if let TransparentSortingInfo3d::Sorted { mesh_center, .. } = info {
        *mesh_center = middle;
    }
}
