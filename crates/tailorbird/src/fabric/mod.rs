//! Fabrics: how cloth moves and looks, by one name.
//!
//! ![A curtain of red cotton](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/curtain.png)
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{UVec2, Vec2};
//! # use tailorbird::prelude::*;
//! fn curtain(mut commands: Commands) {
//!     let shape = Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48));
//!     // Moves like silk and looks like it.
//!     commands.spawn((shape.clone(), ClothFabric::SILK.bundle()));
//!     // Looks like lace, and moves like leather.
//!     commands.spawn((shape, ClothLook::new(ClothFabric::LACE), ClothMaterial::leather()));
//! }
//! ```
//!
//! Small textures (256² texels) come with the feature `fabric_textures`. Those of full size (1024²) are in this repository's
//! `assets/textures`: a game that shows cloth from near takes the files that it needs into a folder of its own assets, and names that in
//! [`ClothFabricPlugin::folder`]. Without either the cloth is plain. All cloths of one look share one material.

#[cfg(feature = "fabric_textures")]
mod embedded;
mod library;
mod mipmaps;

use std::borrow::Cow;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::AssetServer;
use bevy_camera::visibility::VisibilitySystems;
use bevy_color::{Color, LinearRgba};
use bevy_ecs::prelude::*;
use bevy_material::AlphaMode;
use bevy_math::Vec2;
use bevy_pbr::StandardMaterial;
use bevy_reflect::prelude::*;
use tailorbird_cloth::prelude::*;

pub use library::ClothFabricLibrary;
use library::{dress_cloths, load_textures};
pub use mipmaps::{Texels, with_mipmaps};

/// A fabric: how cloth moves and looks. The presets are constants; a game makes its own as any other value:
///
/// ```
/// # use bevy_color::{Color, LinearRgba};
/// # use tailorbird::prelude::*;
/// let velvet = ClothFabric {
///     // `velvet_albedo.png`, `velvet_normal.png`, `velvet_metallic_roughness.png` in `ClothFabricPlugin::folder`.
///     name: "velvet".into(),
///     material: ClothMaterial { areal_density: 0.35, ..ClothMaterial::cotton() },
///     color: Color::srgb(0.3, 0.02, 0.06),
///     ..ClothFabric::COTTON
/// };
/// ```
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Default)]
pub struct ClothFabric {
    /// Name, by which its textures begin; two fabrics of one name have the same textures.
    pub name: Cow<'static, str>,
    /// Material for the simulation.
    pub material: ClothMaterial,
    /// Colour where it has no textures: the mean of that of its texture.
    pub color: Color,
    /// Perceptual roughness where it has no textures, 0.089 to 1 [-].
    pub roughness: f32,
    /// Specular intensity, 0 to 1 [-]: [`StandardMaterial::reflectance`].
    pub reflectance: f32,
    /// The part of the light that shines through, 0 to 1 [-]: [`StandardMaterial::diffuse_transmission`].
    pub transmission: f32,
    /// True if its texture has holes.
    pub has_holes: bool,
    /// Side of one tile of its textures \[m\].
    pub tile: f32,
}

impl Default for ClothFabric {
    /// Cotton.
    fn default() -> Self {
        Self::COTTON
    }
}

impl ClothFabric {
    /// [`ClothMaterial::silk`]: a satin that shines.
    pub const SILK: Self = Self {
        roughness: 0.5,
        reflectance: 0.4,
        transmission: 0.3,
        tile: 0.06,
        ..Self::plain("silk", ClothMaterial::silk())
    };
    /// [`ClothMaterial::cotton`]: plain weave.
    pub const COTTON: Self = Self {
        transmission: 0.2,
        ..Self::plain("cotton", ClothMaterial::cotton())
    };
    /// [`ClothMaterial::denim`]: blue twill.
    pub const DENIM: Self = Self {
        color: Color::srgb(0.16, 0.23, 0.38),
        reflectance: 0.25,
        ..Self::plain("denim", ClothMaterial::denim())
    };
    /// [`ClothMaterial::canvas`]: plain weave of thick yarns.
    pub const CANVAS: Self = Self {
        transmission: 0.08,
        ..Self::plain("canvas", ClothMaterial::canvas())
    };
    /// [`ClothMaterial::leather`]: grained.
    pub const LEATHER: Self = Self {
        color: Color::srgb(0.38, 0.24, 0.15),
        roughness: 0.55,
        reflectance: 0.5,
        ..Self::plain("leather", ClothMaterial::leather())
    };
    /// [`ClothMaterial::rubber`]: dull black.
    pub const RUBBER: Self = Self {
        color: Color::srgb(0.19, 0.19, 0.19),
        roughness: 0.7,
        reflectance: 0.5,
        ..Self::plain("rubber", ClothMaterial::rubber())
    };
    /// [`ClothMaterial::lace`]: flowers on a net, with holes.
    pub const LACE: Self = Self {
        transmission: 0.35,
        has_holes: true,
        tile: 0.25,
        ..Self::plain("lace", ClothMaterial::lace())
    };

    /// The presets.
    pub const ALL: [Self; 7] = [
        Self::SILK,
        Self::COTTON,
        Self::DENIM,
        Self::CANVAS,
        Self::LEATHER,
        Self::RUBBER,
        Self::LACE,
    ];

    /// Rough, white, opaque.
    const fn plain(name: &'static str, material: ClothMaterial) -> Self {
        Self {
            name: Cow::Borrowed(name),
            material,
            color: Color::WHITE,
            roughness: 1.0,
            reflectance: 0.3,
            transmission: 0.0,
            has_holes: false,
            tile: 0.1,
        }
    }

    /// The preset of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fabric| fabric.name == name)
    }

    /// Material and look, for the entity of a cloth.
    pub fn bundle(self) -> impl Bundle {
        self.dyed(Color::WHITE)
    }

    /// The same, dyed.
    pub fn dyed(self, dye: impl Into<Color>) -> impl Bundle {
        (self.material, ClothLook::new(self).with_dye(dye))
    }

    /// Surface material without textures.
    fn surface(&self, dye: Color, textured: bool) -> StandardMaterial {
        StandardMaterial {
            base_color: if textured {
                dye
            } else {
                product(self.color, dye)
            },
            // Textures have the roughness of each place.
            perceptual_roughness: if textured { 1.0 } else { self.roughness },
            reflectance: self.reflectance,
            metallic: 0.0,
            diffuse_transmission: self.transmission,
            alpha_mode: if textured && self.has_holes {
                AlphaMode::AlphaToCoverage
            } else {
                AlphaMode::Opaque
            },
            double_sided: true,
            cull_mode: None,
            ..StandardMaterial::default()
        }
    }
}

/// A colour that is dyed.
fn product(color: Color, dye: Color) -> Color {
    if color == Color::WHITE {
        return dye;
    }
    if dye == Color::WHITE {
        return color;
    }
    let [a, b] = [color, dye].map(|color| color.to_linear());
    LinearRgba::new(
        a.red * b.red,
        a.green * b.green,
        a.blue * b.blue,
        a.alpha * b.alpha,
    )
    .into()
}

/// Look of a cloth: on the entity of a [`Cloth`] it gives it a `MeshMaterial3d<StandardMaterial>`, in place of one that is there.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothLook {
    /// Fabric of the cloth.
    pub fabric: ClothFabric,
    /// Factor of the fabric's own colour.
    pub dye: Color,
    /// True if it has the textures of its fabric.
    pub textured: bool,
    /// Length of a unit of the texture coordinates on the cloth \[m\]. By default the size of a grid, and 1 m for any other mesh.
    pub uv_size: Option<Vec2>,
}

impl ClothLook {
    /// Look of a fabric, undyed.
    pub fn new(fabric: ClothFabric) -> Self {
        Self {
            fabric,
            dye: Color::WHITE,
            textured: true,
            uv_size: None,
        }
    }

    /// Dyed.
    #[must_use]
    pub fn with_dye(self, dye: impl Into<Color>) -> Self {
        Self {
            dye: dye.into(),
            ..self
        }
    }
}

impl Default for ClothLook {
    fn default() -> Self {
        Self::new(ClothFabric::default())
    }
}

/// Makes cloths look like their [`ClothLook`]. Without a renderer it does nothing.
#[derive(Default)]
pub struct ClothFabricPlugin {
    /// The folder with the textures, in that of the game's assets. `None` stands for the small ones that the feature `fabric_textures`
    /// puts into the program; without that feature, for none.
    pub folder: Option<String>,
}

impl ClothFabricPlugin {
    /// With the textures of this folder, in that of the game's assets.
    pub fn from_folder(folder: impl Into<String>) -> Self {
        Self {
            folder: Some(folder.into()),
        }
    }
}

impl Plugin for ClothFabricPlugin {
    fn build(&self, app: &mut App) {
        #[cfg(feature = "fabric_textures")]
        let folder = self.folder.clone().or_else(|| embedded::add(app));
        #[cfg(not(feature = "fabric_textures"))]
        let folder = self.folder.clone();
        app.register_type::<ClothLook>()
            .insert_resource(ClothFabricLibrary::new(folder))
            .add_systems(
                PostUpdate,
                (dress_cloths, load_textures)
                    .chain()
                    .before(VisibilitySystems::CheckVisibility)
                    .run_if(resource_exists::<AssetServer>)
                    .run_if(resource_exists::<bevy_asset::Assets<StandardMaterial>>)
                    .run_if(resource_exists::<bevy_asset::Assets<bevy_image::Image>>),
            );
    }
}
