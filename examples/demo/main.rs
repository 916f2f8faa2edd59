//! A curtain, a flag, a tablecloth, a sheet over a ball, a cape, a banner, a skirt, crates, a silk curtain before a fan: drag them, pin them, blow at them.
//!
//! `cargo run --example demo` opens a window with a panel of sliders; `--help` lists the rest. Without a display it
//! draws pictures to ./out instead.

#[path = "../common/mod.rs"]
mod common;

use std::{fs, path::PathBuf, process::ExitCode};

use bevy::prelude::*;
use clap::Parser;
use common::{
    apply::DemoPlugin,
    ask::SettingsPath,
    detail::{Detail, Start, Wishes},
    garment,
    graphics::{Adapter, check_driver, has_display},
    help,
    offscreen::{self, OffscreenOptions},
    scenes::SceneKind,
    script::{self, Script},
    settings::DemoSettings,
    settings_file,
    stage::StagePlugin,
    window::{ExitAfterFrames, PanelPlugin},
};

/// Real-time cloth: a curtain, a flag, a tablecloth, a sheet over a ball, a cape, a banner, a skirt, crates and a silk curtain before a fan.
#[derive(Parser)]
#[command(after_help = after_help())]
struct Arguments {
    /// curtain, flag, tablecloth, ball, cape, banner, garment, crates or fan
    #[arg(long)]
    scene: Option<SceneKind>,
    /// Particles along the longer side of the cloth [default: 128; 48 in a window without a graphics card]
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=512))]
    resolution: Option<u32>,
    /// Settings to begin with, as F5 saves them; F5 and F9 save to and load from this file
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Draws to PNG files in this folder instead of a window
    #[arg(long, value_name = "DIR")]
    offscreen: Option<PathBuf>,
    /// With --offscreen: how much is played [s]
    #[arg(long, value_parser = seconds, default_value = "7")]
    seconds: f32,
    /// With --offscreen: the time between two pictures [s]
    #[arg(long, value_parser = seconds, default_value = "0.25")]
    every: f32,
    /// With --offscreen: what happens, instead of the scene's own script
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Everything, even in a window without a graphics card, where it is slow; in pictures, smooth edges
    #[arg(long)]
    fine: bool,
    /// Width and height [pixels] [default: 1280x720; 800x450 in a window without a graphics card]
    #[arg(long, value_parser = size, value_name = "WxH")]
    size: Option<UVec2>,
}

fn after_help() -> String {
    format!("In the window:\n{}\n{}", help::text(), script::FORMAT)
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("demo: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: Arguments) -> Result<ExitCode, String> {
    let adapter = check_driver()?;
    if arguments.offscreen.is_none() && !has_display() {
        eprintln!("demo: there is no display; drawing pictures to ./out instead");
        arguments.offscreen = Some("out".into());
    }
    match arguments.offscreen.take() {
        Some(dir) => draw(&arguments, dir),
        None => play(&arguments, adapter),
    }
}

/// Opens the window.
fn play(arguments: &Arguments, adapter: Adapter) -> Result<ExitCode, String> {
    let wishes = Wishes {
        fine: arguments.fine,
        size: arguments.size,
        resolution: arguments.resolution,
        from_file: arguments.settings.is_some(),
    };
    let Start {
        detail,
        size,
        settings,
    } = Start::new(adapter, wishes, settings(arguments, arguments.scene)?);
    let path = arguments.settings.clone();
    let path = path.map_or_else(SettingsPath::default, SettingsPath);
    let exit = App::new()
        .insert_resource(path)
        .add_plugins(
            DefaultPlugins
                .set(WindowPlugin {
                    primary_window: Some(Window {
                        title: "Tailorbird".into(),
                        resolution: (size.x, size.y).into(),
                        ..default()
                    }),
                    ..default()
                })
                .set(garment::gltf()),
        )
        .add_plugins((
            common::cloth_plugins(),
            DemoPlugin {
                settings,
                stage: StagePlugin {
                    fine: arguments.fine,
                    detail,
                    ..default()
                },
            },
            PanelPlugin,
            ExitAfterFrames,
        ))
        .run();
    Ok(match exit {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    })
}

/// Draws one scene, that of the settings, or all of them.
fn draw(arguments: &Arguments, dir: PathBuf) -> Result<ExitCode, String> {
    let script = match &arguments.script {
        Some(path) => Some(read(path)?),
        None => None,
    };
    let scenes = match (arguments.scene, &arguments.settings) {
        (None, None) => SceneKind::ALL.map(Some).into(),
        (scene, _) => vec![scene],
    };
    for scene in scenes {
        let settings = settings(arguments, scene)?;
        let scene = settings.scene;
        let pictures = offscreen::draw(&OffscreenOptions {
            dir: dir.clone(),
            seconds: arguments.seconds,
            every: arguments.every,
            size: arguments.size.unwrap_or(Detail::Full.size()),
            fine: arguments.fine,
            settings,
            script: script.clone().unwrap_or_else(|| Script::of(scene)),
        });
        let pictures = pictures.map_err(|error| error.to_string())?;
        println!("{scene}: {} pictures in {}", pictures.len(), dir.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Settings from the command line; a scene that it names comes with its own material, wind and ball.
fn settings(arguments: &Arguments, scene: Option<SceneKind>) -> Result<DemoSettings, String> {
    let mut settings = match &arguments.settings {
        Some(file) => settings_file::load(file).map_err(|error| error.to_string())?,
        None => DemoSettings::default(),
    };
    if let Some(scene) = scene {
        settings.show(scene);
    }
    if let Some(resolution) = arguments.resolution {
        settings.resolution = resolution;
    }
    Ok(settings)
}

fn read(path: &PathBuf) -> Result<Script, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    text.parse()
        .map_err(|error| format!("{}: {error}", path.display()))
}

fn seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value > 0.0 && value <= 3600.0 => Ok(value),
        _ => Err("a time is above 0 and at most 3600 [s]".into()),
    }
}

fn size(text: &str) -> Result<UVec2, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (16..=8192).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some(UVec2::new(side(width)?, side(height)?)))
        .ok_or_else(|| "a size is two numbers from 16 to 8192, as 1280x720".into())
}
