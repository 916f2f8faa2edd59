//! Textures and materials, each made once.

use std::{array, borrow::Cow, collections::HashMap};

use bevy_asset::prelude::*;
use bevy_color::ColorToComponents;
use bevy_ecs::prelude::*;
use bevy_image::{
    Image, ImageAddressMode, ImageFilterMode, ImageLoaderSettings, ImageSampler,
    ImageSamplerDescriptor,
};
use bevy_math::{Affine2, Vec2};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use tailorbird_cloth::prelude::*;

use super::{
    ClothFabric, ClothLook,
    mipmaps::{Texels, with_mipmaps},
};

/// The textures of a fabric: what their files are called, and what is in them.
fn kinds(has_holes: bool) -> [(&'static str, Texels); 3] {
    let albedo = if has_holes {
        Texels::Cutout
    } else {
        Texels::Color
    };
    [
        ("albedo", albedo),
        ("normal", Texels::Normal),
        ("metallic_roughness", Texels::Value),
    ]
}

/// The fabrics that are in use.
#[derive(Resource, Debug)]
pub struct ClothFabricLibrary {
    /// Folder of the textures.
    folder: Option<String>,
    /// By the names of fabrics, and whether they have holes.
    textures: HashMap<(Cow<'static, str>, bool), Textures>,
    materials: HashMap<Key, AssetId<StandardMaterial>>,
}

/// Key of cloths that look alike.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Key {
    /// Name of the fabric, and whether it has holes.
    fabric: (Cow<'static, str>, bool),
    /// Color, dye, roughness, reflectance, transmission, tiles along u and v.
    numbers: [u32; 13],
    textured: bool,
}

/// The textures of a fabric, in the order of [`kinds`].
#[derive(Debug)]
enum Textures {
    Loading([Handle<Image>; 3]),
    /// Smaller copies are being made.
    Shrinking(Task<[Image; 3]>),
    Ready([Handle<Image>; 3]),
    /// The asset server has said why.
    Missing,
}

impl ClothFabricLibrary {
    pub(super) fn new(folder: Option<String>) -> Self {
        Self {
            folder,
            textures: HashMap::new(),
            materials: HashMap::new(),
        }
    }

    /// Returns whether all fabrics of cloths look as they are to: none of their textures is still being loaded.
    pub fn is_ready(&self) -> bool {
        let pending =
            |textures: &Textures| matches!(textures, Textures::Loading(_) | Textures::Shrinking(_));
        !self.textures.values().any(pending)
    }
}

/// Gives cloths the material of their look.
pub(super) fn dress_cloths(
    mut commands: Commands,
    mut library: ResMut<ClothFabricLibrary>,
    server: Res<AssetServer>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    cloths: Query<(Entity, &ClothLook, Option<&Cloth>), Or<(Changed<ClothLook>, Changed<Cloth>)>>,
) {
    let library = &mut *library;
    for (entity, look, cloth) in &cloths {
        let ClothLook {
            ref fabric,
            dye,
            textured,
            uv_size,
        } = *look;
        let size = uv_size
            .or_else(|| cloth.and_then(Cloth::size))
            .unwrap_or(Vec2::ONE);
        let tiles = size / fabric.tile;
        let folder = library.folder.as_ref().filter(|_| textured);
        let textured = folder.is_some();
        let [own, dyed] = [fabric.color, dye].map(|color| color.to_linear().to_f32_array());
        let mut numbers = own.into_iter().chain(dyed).chain([
            fabric.roughness,
            fabric.reflectance,
            fabric.transmission,
            tiles.x,
            tiles.y,
        ]);
        let key = Key {
            fabric: (fabric.name.clone(), fabric.has_holes),
            numbers: array::from_fn(|_| numbers.next().unwrap_or(0.0).to_bits()),
            textured,
        };
        let known = library.materials.get(&key);
        let material = known.and_then(|id| materials.get_strong_handle(*id));
        let material = material.unwrap_or_else(|| {
            library.materials.retain(|_, id| materials.contains(*id));
            let mut material = fabric.surface(dye, textured);
            material.uv_transform = Affine2::from_scale(tiles);
            if let Some(folder) = folder {
                let textures = library
                    .textures
                    .entry(key.fabric.clone())
                    .or_insert_with(|| {
                        Textures::Loading(kinds(fabric.has_holes).map(|(kind, texels)| {
                            let path = format!("{folder}/{}_{kind}.png", fabric.name);
                            let settings = move |settings: &mut ImageLoaderSettings| {
                                settings.is_srgb = matches!(texels, Texels::Color | Texels::Cutout);
                                settings.sampler = repeating(texels == Texels::Cutout);
                            };
                            server.load_builder().with_settings(settings).load(path)
                        }))
                    });
                if let Textures::Ready(textures) = textures {
                    put_on(&mut material, textures);
                }
            }
            let material = materials.add(material);
            library.materials.insert(key, material.id());
            material
        });
        commands.entity(entity).insert(MeshMaterial3d(material));
    }
}

/// Makes smaller copies of the textures that have been loaded, and gives them to the materials that wait for them.
pub(super) fn load_textures(
    mut library: ResMut<ClothFabricLibrary>,
    server: Res<AssetServer>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if library.is_ready() {
        return;
    }
    let ClothFabricLibrary {
        textures,
        materials: ours,
        ..
    } = &mut *library;
    for (fabric, textures) in textures {
        match textures {
            Textures::Loading(handles) => {
                if handles.iter().any(|h| server.load_state(h).is_failed()) {
                    *textures = Textures::Missing;
                    continue;
                }
                let loaded = [0, 1, 2].map(|k: usize| images.get(&handles[k]).cloned());
                let [Some(a), Some(b), Some(c)] = loaded else {
                    continue;
                };
                let kinds = kinds(fabric.1);
                let task = async move {
                    let mut full = [a, b, c].into_iter().zip(kinds);
                    array::from_fn(|_| {
                        let next = full.next();
                        next.map_or_else(Image::default, |(image, (_, texels))| {
                            with_mipmaps(image, texels)
                        })
                    })
                };
                *textures = Textures::Shrinking(AsyncComputeTaskPool::get().spawn(task));
            }
            Textures::Shrinking(task) => {
                let Some(made) = check_ready(task) else {
                    continue;
                };
                let made = made.map(|image| images.add(image));
                for (key, id) in &*ours {
                    if key.fabric == *fabric
                        && key.textured
                        && let Some(mut material) = materials.get_mut(*id)
                    {
                        put_on(&mut material, &made);
                    }
                }
                *textures = Textures::Ready(made);
            }
            Textures::Ready(_) | Textures::Missing => {}
        }
    }
}

fn put_on(material: &mut StandardMaterial, [albedo, normal, roughness]: &[Handle<Image>; 3]) {
    material.base_color_texture = Some(albedo.clone());
    material.normal_map_texture = Some(normal.clone());
    material.metallic_roughness_texture = Some(roughness.clone());
}

/// Of a texture that repeats. A texel that is a hole or none is read from one copy alone: means of copies would be neither.
fn repeating(has_holes: bool) -> ImageSampler {
    ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: if has_holes {
            ImageFilterMode::Nearest
        } else {
            ImageFilterMode::Linear
        },
        anisotropy_clamp: if has_holes { 1 } else { 8 },
        ..ImageSamplerDescriptor::default()
    })
}
