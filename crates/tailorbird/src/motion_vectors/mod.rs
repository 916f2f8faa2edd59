//! Motion vectors of cloth, for temporal antialiasing, motion blur and whatever else looks at the frame before.
//!
//! Bevy knows where an entity was in the frame before, and its bones and morph weights, but not where each vertex was. So the
//! motion vectors of a cloth tell how its entity moves, none of its swinging, and temporal effects smear it. With
//! [`ClothMotionVectorsPlugin`] the vertices of all cloths carry their place in the frame before, and their materials look at it:
//!
//! ```no_run
//! # use bevy_app::prelude::*;
//! # use tailorbird::prelude::*;
//! # fn app(app: &mut App) {
//! app.add_plugins((ClothPlugins::default(), ClothMotionVectorsPlugin));
//! # }
//! ```
//!
//! A camera has motion vectors where it has Bevy's `MotionVectorPrepass`, which `TemporalAntiAliasing` and `MotionBlur` bring along.
//!
//! It costs 12 bytes for each vertex, and the time to write them. Materials of cloths are not
//! drawn in one batch with those of other things any more. [`ClothMeshSettings::motion_vectors`] switches it off and on.
//!
//! The entity's `MeshMaterial3d<StandardMaterial>` gives way to one of [`ClothMotionMaterial`], whose `base` follows the
//! `StandardMaterial`: that asset can be changed as before, and another one put on the entity. Materials of your own find
//! the places in [`ATTRIBUTE_PREVIOUS_POSITION`].

use std::collections::HashMap;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::{Asset, AssetEvent, AssetEventSystems, AssetId, Assets, Handle, embedded_asset};
use bevy_ecs::prelude::*;
use bevy_mesh::MeshVertexBufferLayoutRef;
use bevy_pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline,
    MaterialPlugin, MeshMaterial3d, PbrPlugin, StandardMaterial,
};
use bevy_reflect::Reflect;
use bevy_render::render_resource::{
    AsBindGroup, RenderPipelineDescriptor, SpecializedMeshPipelineError,
};
use bevy_shader::ShaderRef;

use crate::mesh::{ClothMeshOf, ClothMeshSettings, make_materials_two_sided};

pub use crate::mesh::ATTRIBUTE_PREVIOUS_POSITION;

/// Of [`ATTRIBUTE_PREVIOUS_POSITION`], in `motion.wesl`.
const LOCATION: u32 = 12;

/// Gives cloths motion vectors of their own. Add it after `DefaultPlugins`; without a renderer it does nothing.
pub struct ClothMotionVectorsPlugin;

/// A `StandardMaterial` whose motion vectors are those of the vertices.
pub type ClothMotionMaterial = ExtendedMaterial<StandardMaterial, ClothMotion>;

/// Extension of the base by [`ClothMotionMaterial`].
#[derive(Asset, AsBindGroup, Reflect, Clone, Debug, Default)]
pub struct ClothMotion {}

/// The material that a [`ClothMotionMaterial`] stands for. Written by [`ClothMotionVectorsPlugin`] alone.
#[derive(Component, Clone, Debug)]
pub struct ClothMotionBase(Handle<StandardMaterial>);

impl ClothMotionBase {
    /// The material.
    pub fn handle(&self) -> &Handle<StandardMaterial> {
        &self.0
    }
}

/// The materials that stand for others.
#[derive(Resource, Default)]
struct Stand(HashMap<AssetId<StandardMaterial>, AssetId<ClothMotionMaterial>>);

impl MaterialExtension for ClothMotion {
    fn prepass_vertex_shader() -> ShaderRef {
        "embedded://tailorbird/motion_vectors/motion.wesl".into()
    }

    fn deferred_vertex_shader() -> ShaderRef {
        Self::prepass_vertex_shader()
    }

    fn specialize(
        _pipeline: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        _key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let vertex = &mut descriptor.vertex;
        let has = |name: &'static str| vertex.shader_defs.contains(&name.into());
        let meant = has("PREPASS_PIPELINE") && has("MOTION_VECTOR_PREPASS");
        if !meant || !layout.0.contains(ATTRIBUTE_PREVIOUS_POSITION) {
            return Ok(());
        }
        let previous = ATTRIBUTE_PREVIOUS_POSITION.at_shader_location(LOCATION);
        let previous = layout.0.get_layout(&[previous])?;
        if let Some(buffer) = vertex.buffers.first_mut() {
            buffer.attributes.extend(previous.attributes);
            vertex.shader_defs.push("CLOTH_PREVIOUS_POSITION".into());
        }
        Ok(())
    }
}

impl Plugin for ClothMotionVectorsPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<PbrPlugin>() {
            return;
        }
        embedded_asset!(app, "motion.wesl");
        app.add_plugins(MaterialPlugin::<ClothMotionMaterial>::default())
            .init_resource::<Stand>()
            .add_systems(
                PostUpdate,
                (take_back_materials, stand_in_for_materials)
                    .chain()
                    .after(make_materials_two_sided)
                    .before(AssetEventSystems)
                    .run_if(resource_exists::<ClothMeshSettings>),
            );
    }

    fn finish(&self, app: &mut App) {
        if app.world().contains_resource::<Stand>()
            && let Some(mut settings) = app.world_mut().get_resource_mut::<ClothMeshSettings>()
        {
            settings.motion_vectors = true;
        }
    }
}

/// Gives the materials back where they are not stood in for any more.
fn take_back_materials(
    mut commands: Commands,
    settings: Res<ClothMeshSettings>,
    shown: Query<(Entity, &ClothMotionBase, Has<ClothMeshOf>)>,
) {
    for (entity, base, is_cloth) in &shown {
        if settings.motion_vectors && is_cloth {
            continue;
        }
        commands
            .entity(entity)
            .remove::<(MeshMaterial3d<ClothMotionMaterial>, ClothMotionBase)>()
            .insert(MeshMaterial3d(base.0.clone()));
    }
}

/// Puts materials in the place of others, and keeps them like those.
fn stand_in_for_materials(
    mut commands: Commands,
    settings: Res<ClothMeshSettings>,
    shown: Query<(Entity, &MeshMaterial3d<StandardMaterial>), With<ClothMeshOf>>,
    mut stand: ResMut<Stand>,
    mut changes: MessageReader<AssetEvent<StandardMaterial>>,
    materials: Res<Assets<StandardMaterial>>,
    mut own: ResMut<Assets<ClothMotionMaterial>>,
) {
    for change in changes.read() {
        if let AssetEvent::Modified { id } = change
            && let Some(base) = materials.get(*id)
            && let Some(mut own) = stand.0.get(id).and_then(|own_id| own.get_mut(*own_id))
        {
            own.base = base.clone();
        }
    }
    if !settings.motion_vectors || shown.is_empty() {
        return;
    }
    stand.0.retain(|_, id| own.contains(*id));
    for (entity, material) in &shown {
        // One that is still being loaded is waited for.
        let Some(base) = materials.get(material.id()) else {
            continue;
        };
        let known = stand.0.get(&material.id());
        let known = known.and_then(|id| own.get_strong_handle(*id));
        let handle = known.unwrap_or_else(|| {
            let handle = own.add(ClothMotionMaterial {
                base: base.clone(),
                extension: ClothMotion {},
            });
            stand.0.insert(material.id(), handle.id());
            handle
        });
        commands
            .entity(entity)
            .remove::<MeshMaterial3d<StandardMaterial>>()
            .insert((MeshMaterial3d(handle), ClothMotionBase(material.0.clone())));
    }
}
