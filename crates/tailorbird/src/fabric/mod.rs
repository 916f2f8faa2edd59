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
//!     commands.spawn((shape.clone(), Fabric::Silk.bundle()));
//!     // Looks like lace, and moves like leather.
//!     commands.spawn((shape, ClothLook::new(Fabric::Lace), ClothMaterial::leather()));
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

use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::AssetServer;
use bevy_camera::visibility::VisibilitySystems;
use bevy_color::Color;
use bevy_ecs::prelude::*;
use bevy_material::AlphaMode;
use bevy_math::Vec2;
use bevy_pbr::StandardMaterial;
use bevy_reflect::prelude::*;
use tailorbird_cloth::prelude::*;

pub use library::FabricLibrary;
use library::{dress_cloths, load_textures};
pub use mipmaps::{Texels, with_mipmaps};

/// A fabric with a name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
pub enum Fabric {
    /// [`ClothMaterial::silk`]: a satin that shines.
    Silk,
    /// [`ClothMaterial::cotton`]: plain weave.
    #[default]
    Cotton,
    /// [`ClothMaterial::denim`]: blue twill.
    Denim,
    /// [`ClothMaterial::canvas`]: plain weave of thick yarns.
    Canvas,
    /// [`ClothMaterial::leather`]: grained.
    Leather,
    /// [`ClothMaterial::rubber`]: dull black.
    Rubber,
    /// [`ClothMaterial::lace`]: flowers on a net, with holes.
    Lace,
}

impl Fabric {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Silk,
        Self::Cotton,
        Self::Denim,
        Self::Canvas,
        Self::Leather,
        Self::Rubber,
        Self::Lace,
    ];

    /// Its name, in lower case: that of its textures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Silk => "silk",
            Self::Cotton => "cotton",
            Self::Denim => "denim",
            Self::Canvas => "canvas",
            Self::Leather => "leather",
            Self::Rubber => "rubber",
            Self::Lace => "lace",
        }
    }

    /// The fabric of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fabric| fabric.name() == name)
    }

    /// Material for the simulation.
    pub const fn physics(self) -> ClothMaterial {
        match self {
            Self::Silk => ClothMaterial::silk(),
            Self::Cotton => ClothMaterial::cotton(),
            Self::Denim => ClothMaterial::denim(),
            Self::Canvas => ClothMaterial::canvas(),
            Self::Leather => ClothMaterial::leather(),
            Self::Rubber => ClothMaterial::rubber(),
            Self::Lace => ClothMaterial::lace(),
        }
    }

    /// Material and look, for the entity of a cloth.
    pub fn bundle(self) -> impl Bundle {
        (self.physics(), ClothLook::new(self))
    }

    /// Surface material without textures: a fabric with a colour of its own has the mean of its texture.
    fn surface(self, dye: Color, textured: bool) -> StandardMaterial {
        let (roughness, reflectance, through) = match self {
            Self::Silk => (0.5, 0.4, 0.3),
            Self::Cotton => (1.0, 0.3, 0.2),
            Self::Denim => (1.0, 0.25, 0.0),
            Self::Canvas => (1.0, 0.3, 0.08),
            Self::Leather => (0.55, 0.5, 0.0),
            Self::Rubber => (0.7, 0.5, 0.0),
            Self::Lace => (1.0, 0.3, 0.35),
        };
        // Textures have the roughness of each place.
        let perceptual_roughness = if textured { 1.0 } else { roughness };
        let base_color = match self {
            _ if textured => dye,
            Self::Denim => Color::srgb(0.16, 0.23, 0.38),
            Self::Leather => Color::srgb(0.38, 0.24, 0.15),
            Self::Rubber => Color::srgb(0.19, 0.19, 0.19),
            _ => dye,
        };
        StandardMaterial {
            base_color,
            perceptual_roughness,
            reflectance,
            metallic: 0.0,
            diffuse_transmission: through,
            alpha_mode: if textured && self.has_holes() {
                AlphaMode::AlphaToCoverage
            } else {
                AlphaMode::Opaque
            },
            double_sided: true,
            cull_mode: None,
            ..StandardMaterial::default()
        }
    }

    /// Returns whether its texture has holes.
    const fn has_holes(self) -> bool {
        matches!(self, Self::Lace)
    }

    /// The side of one tile of its textures \[m\].
    pub const fn tile(self) -> f32 {
        match self {
            Self::Silk => 0.06,
            Self::Lace => 0.25,
            _ => 0.1,
        }
    }
}

/// Look of a cloth: on the entity of a [`Cloth`] it gives it a `MeshMaterial3d<StandardMaterial>`, in place of one that is there.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothLook {
    /// Fabric of the cloth.
    pub fabric: Fabric,
    /// Factor of the fabric's own colour.
    pub dye: Color,
    /// True if it has the textures of its fabric.
    pub textured: bool,
    /// Length of a unit of the texture coordinates on the cloth \[m\]. By default the size of a grid, and 1 m for any other mesh.
    pub uv_size: Option<Vec2>,
}

impl ClothLook {
    /// Look of a fabric, undyed.
    pub fn new(fabric: Fabric) -> Self {
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
        Self::new(Fabric::default())
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
            .insert_resource(FabricLibrary::new(folder))
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
