//! Fabrics: how cotton and denim look.

use std::path::{Path, PathBuf};

use super::mipmaps::{Texels, with_mipmaps};
use bevy::{log::error, math::Affine2, prelude::*};

/// The side of one tile of the textures [m].
const TILE: f32 = 0.1;

/// The textures of all fabrics.
#[derive(Resource, Clone, Debug)]
pub struct Fabrics {
    cotton: Weave,
    denim: Weave,
}

/// The textures of one fabric. Missing ones are logged, and the cloth is plain.
#[derive(Clone, Debug, Default)]
struct Weave {
    albedo: Option<Handle<Image>>,
    normal: Option<Handle<Image>>,
    metallic_roughness: Option<Handle<Image>>,
}

impl FromWorld for Fabrics {
    fn from_world(world: &mut World) -> Self {
        let mut images = world.resource_mut::<Assets<Image>>();
        Self {
            cotton: Weave::load("cotton", &mut images),
            denim: Weave::load("denim", &mut images),
        }
    }
}

impl Weave {
    fn load(name: &str, images: &mut Assets<Image>) -> Self {
        let mut load = |kind: &str, texels| {
            let path = textures().join(format!("{name}_{kind}.png"));
            match image::open(&path) {
                Ok(image) => Some(images.add(with_mipmaps(&image.to_rgba8(), texels))),
                Err(error) => {
                    error!("{}: {error}", path.display());
                    None
                }
            }
        };
        Self {
            albedo: load("albedo", Texels::Color),
            normal: load("normal", Texels::Normal),
            metallic_roughness: load("metallic_roughness", Texels::Value),
        }
    }
}

/// Where the textures are: in the checkout that the example was built from, or in the current folder.
fn textures() -> PathBuf {
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/textures");
    if built.is_dir() {
        built
    } else {
        PathBuf::from("assets/textures")
    }
}

impl Fabrics {
    /// What a cloth of this preset looks like. `color` is its dye; denim is blue by itself. `size` is that of the
    /// cloth [m].
    pub fn material(
        &self,
        preset: &str,
        color: Color,
        size: Vec2,
        textured: bool,
    ) -> StandardMaterial {
        let denim = preset == "denim";
        let (weave, dye) = if denim {
            (&self.denim, Color::srgb(0.55, 0.60, 0.72))
        } else {
            (&self.cotton, color)
        };
        let plain = StandardMaterial {
            base_color: if denim {
                Color::srgb(0.16, 0.23, 0.38)
            } else {
                color
            },
            ..surface(preset)
        };
        if !textured {
            return plain;
        }
        StandardMaterial {
            base_color: dye,
            base_color_texture: weave.albedo.clone(),
            normal_map_texture: weave.normal.clone(),
            metallic_roughness_texture: weave.metallic_roughness.clone(),
            uv_transform: Affine2::from_scale(size / TILE),
            ..plain
        }
    }
}

/// How much a fabric shines, and how much light goes through it.
fn surface(preset: &str) -> StandardMaterial {
    let (roughness, reflectance, through) = match preset {
        "silk" => (0.5, 0.4, 0.3),
        "leather" => (0.55, 0.5, 0.0),
        "rubber" => (0.7, 0.5, 0.0),
        "denim" => (1.0, 0.25, 0.0),
        _ => (1.0, 0.3, 0.2),
    };
    StandardMaterial {
        perceptual_roughness: roughness,
        reflectance,
        metallic: 0.0,
        diffuse_transmission: through,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}
