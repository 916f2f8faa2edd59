//! What the examples share, and the tests with them: scenes, stage, camera, panel, scripts, pictures.

#![allow(dead_code, reason = "each example and each test uses a part")]

pub mod actor;
pub mod apply;
pub mod camera;
pub mod character;
pub mod crates;
pub mod garment;
pub mod graphics;
pub mod help;
pub mod moving;
pub mod offscreen;
pub mod panel;
pub mod plot;
pub mod props;
pub mod scenes;
pub mod script;
pub mod settings;
pub mod shortcuts;
pub mod stage;
pub mod status;
pub mod window;

use std::process::ExitCode;

use bevy::prelude::*;
use tailorbird::prelude::*;

/// Opens a window with one scene, without a panel.
pub fn play(name: &str, scene: scenes::SceneKind) -> ExitCode {
    if let Err(message) = graphics::check_driver() {
        eprintln!("{name}: {message}");
        return ExitCode::FAILURE;
    }
    App::new()
        .add_plugins((
            DefaultPlugins.set(garment::gltf()),
            ClothPlugins::default(),
            apply::DemoPlugin {
                settings: settings::DemoSettings::of(scene),
                ..default()
            },
            window::ExitAfterFrames,
        ))
        .run();
    ExitCode::SUCCESS
}
