//! Parts that the demo, the gallery and the tests share: scenes, stage, camera, panel, scripts, pictures.

#![allow(dead_code, reason = "each of them uses a part")]

pub mod actor;
pub mod apply;
pub mod ask;
pub mod camera;
pub mod character;
pub mod clock;
pub mod compare;
pub mod crates;
pub mod detail;
pub mod fan;
pub mod gamepad;
pub mod garment;
pub mod graphics;
pub mod hand;
pub mod help;
pub mod low;
pub mod moving;
pub mod notices;
pub mod offscreen;
pub mod panel;
pub mod photo;
pub mod plot;
pub mod props;
pub mod scene_assets;
pub mod scene_list;
pub mod scenes;
pub mod script;
pub mod settings;
pub mod settings_file;
pub mod shortcuts;
pub mod stage;
pub mod status;
pub mod thumbnails;
pub mod touch;
pub mod window;

use bevy::{app::PluginGroupBuilder, prelude::*};
use tailorbird::prelude::*;

/// Cloth with fine textures, which pointer and keys move.
pub fn cloth_plugins() -> PluginGroupBuilder {
    ClothPlugins::default()
        .set(ClothFabricPlugin::from_folder("textures"))
        .add(ClothDragPlugin)
        .add(ClothSphereControlsPlugin)
}
