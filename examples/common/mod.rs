//! What the examples share, and the tests with them: scenes, stage, camera, panel, scripts, pictures.

#![allow(dead_code, reason = "each example and each test uses a part")]

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
pub mod saved;
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

use std::process::ExitCode;

use bevy::{app::PluginGroupBuilder, prelude::*};
use tailorbird::prelude::*;

/// Cloth with fine textures, which pointer and keys move.
pub fn cloth_plugins() -> PluginGroupBuilder {
    ClothPlugins::default()
        .set(ClothFabricPlugin::from_folder("textures"))
        .add(ClothDragPlugin)
        .add(SphereControlsPlugin)
}

/// Opens a window with one scene, without a panel.
pub fn play(name: &str, scene: scenes::SceneKind) -> ExitCode {
    if let Err(message) = graphics::check_driver() {
        eprintln!("{name}: {message}");
        return ExitCode::FAILURE;
    }
    App::new()
        .add_plugins((
            DefaultPlugins.set(garment::gltf()),
            cloth_plugins(),
            apply::DemoPlugin {
                settings: settings::DemoSettings::of(scene),
                ..default()
            },
            window::ExitAfterFrames,
        ))
        .run();
    ExitCode::SUCCESS
}
