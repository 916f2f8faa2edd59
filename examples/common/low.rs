//! Materials for renderers without a graphics card: those of [`Detail::Low`](super::detail::Detail).
//!
//! A processor goes through the whole of Bevy's shader for every pixel, with all that a material could have.

use std::collections::HashMap;

use bevy::{
    asset::uuid_handle,
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::render_resource::{
        AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
    },
    shader::{Shader, ShaderRef},
};

/// Draws whatever has a `StandardMaterial` with a [`LowMaterial`] in its place.
pub struct LowMaterialPlugin;

const SHADER: Handle<Shader> = uuid_handle!("0d5d4b5e-6a0f-4d0e-9a50-53f4a1c9be11");

impl Plugin for LowMaterialPlugin {
    fn build(&self, app: &mut App) {
        let Some(mut shaders) = app.world_mut().get_resource_mut::<Assets<Shader>>() else {
            return;
        };
        let shader = Shader::from_wesl(
            include_str!("low.wesl"),
            "embedded://tailorbird_demo/low.wesl",
        );
        if let Err(error) = shaders.insert(&SHADER, shader) {
            error!("{error}");
            return;
        }
        app.add_plugins(MaterialPlugin::<LowMaterial>::default())
            .init_resource::<Stand>()
            // What has no material yet is not drawn, so that Bevy's shader is not built.
            .add_systems(Last, stand_in);
    }
}

/// A colour or a texture in the light of one sun, with its shadow.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
#[bind_group_data(LowKey)]
pub struct LowMaterial {
    #[uniform(0)]
    surface: LowSurface,
    #[texture(1)]
    texture: Option<Handle<Image>>,
    /// Is none: in its place comes what Bevy has for that, with a sampler that is not anisotropic.
    #[texture(2)]
    #[sampler(3)]
    plain: Option<Handle<Image>>,
    unlit: bool,
    /// True if nothing is drawn where the colour is transparent.
    holes: bool,
}

/// Uniforms of the shader.
#[derive(ShaderType, Clone, Copy, Debug)]
struct LowSurface {
    color: Vec4,
    tiles: Vec4,
    /// Exponent and strength of the gloss, and the part of the light that goes through.
    surface: Vec4,
}

/// Key that the shader is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LowKey {
    textured: bool,
    unlit: bool,
    holes: bool,
}

impl From<&LowMaterial> for LowKey {
    fn from(material: &LowMaterial) -> Self {
        Self {
            textured: material.texture.is_some(),
            unlit: material.unlit,
            holes: material.holes,
        }
    }
}

impl LowMaterial {
    fn of(base: &StandardMaterial) -> Self {
        let [a, b, c, d] = base.uv_transform.matrix2.to_cols_array();
        let [exponent, strength] = gloss(base.perceptual_roughness, base.reflectance);
        Self {
            surface: LowSurface {
                color: base.base_color.to_linear().to_vec4(),
                tiles: Vec4::new(a, b, c, d),
                surface: Vec4::new(exponent, strength, base.diffuse_transmission, 0.0),
            },
            texture: base.base_color_texture.clone(),
            plain: None,
            unlit: base.unlit,
            holes: base.alpha_mode != AlphaMode::Opaque,
        }
    }
}

/// Exponent and strength of Blinn and Phong's highlight for a roughness and a reflectance as `StandardMaterial` has them [-].
///
/// n = 2/α² − 2 with α = r² (Walter and others 2007), strength F₀ (n + 8)/8, which keeps the light that is sent back the
/// same (Akenine-Möller and others 2018); F₀ = 0.16 reflectance². The smoothest counts as of roughness 0.2.
fn gloss(roughness: f32, reflectance: f32) -> [f32; 2] {
    let alpha = roughness.clamp(0.2, 1.0).powi(2);
    let exponent = 2.0 / (alpha * alpha) - 2.0;
    [
        exponent,
        0.16 * reflectance * reflectance * (exponent + 8.0) / 8.0,
    ]
}

impl Material for LowMaterial {
    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    fn specialize(
        _pipeline: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _layout: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        // Cloth has a back, and the sky is seen from within.
        descriptor.primitive.cull_mode = None;
        let LowKey {
            textured,
            unlit,
            holes,
        } = key.bind_group_data;
        if let Some(fragment) = &mut descriptor.fragment {
            let defs = [
                ("LOW_TEXTURED", textured),
                ("LOW_UNLIT", unlit),
                ("LOW_HOLES", holes),
            ];
            let meant = defs.into_iter().filter(|(_, meant)| *meant);
            fragment
                .shader_defs
                .extend(meant.map(|(def, _)| def.into()));
        }
        Ok(())
    }
}

/// The material that a [`LowMaterial`] stands for.
#[derive(Component, Clone, Debug)]
pub struct LowBase(Handle<StandardMaterial>);

/// The materials that stand for others.
#[derive(Resource, Default)]
struct Stand(HashMap<AssetId<StandardMaterial>, AssetId<LowMaterial>>);

/// Puts materials in the place of others, and keeps them like those.
fn stand_in(
    mut commands: Commands,
    shown: Query<(Entity, &MeshMaterial3d<StandardMaterial>)>,
    mut stand: ResMut<Stand>,
    mut changes: MessageReader<AssetEvent<StandardMaterial>>,
    bases: Res<Assets<StandardMaterial>>,
    mut own: ResMut<Assets<LowMaterial>>,
) {
    for change in changes.read() {
        if let AssetEvent::Modified { id } = change
            && let Some(base) = bases.get(*id)
            && let Some(mut own) = stand.0.get(id).and_then(|own_id| own.get_mut(*own_id))
        {
            *own = LowMaterial::of(base);
        }
    }
    if shown.is_empty() {
        return;
    }
    stand.0.retain(|_, id| own.contains(*id));
    for (entity, material) in &shown {
        let Some(base) = bases.get(material.id()) else {
            continue;
        };
        let known = stand.0.get(&material.id());
        let known = known.and_then(|id| own.get_strong_handle(*id));
        let handle = known.unwrap_or_else(|| {
            let handle = own.add(LowMaterial::of(base));
            stand.0.insert(material.id(), handle.id());
            handle
        });
        commands
            .entity(entity)
            .remove::<MeshMaterial3d<StandardMaterial>>()
            .insert((MeshMaterial3d(handle), LowBase(material.0.clone())));
    }
}
