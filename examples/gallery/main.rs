//! Draws every scene to a still and an animation, and compares the stills with stored ones.
//!
//! `cargo run --example gallery -- DIR`; `--help` lists the rest. The README's pictures are made with
//! `cargo run --example gallery -- --fine assets/pictures/gallery`.

#[path = "../common/mod.rs"]
mod common;

mod animation;
mod compare;
mod difference;
mod draw;
mod shots;
mod shrink;

use std::{path::PathBuf, process::ExitCode};

use bevy::prelude::*;
use clap::Parser;
use common::scenes::SceneKind;
use compare::compare;
use draw::{DrawError, Gallery};

/// Draws every scene to a still and an animation.
#[derive(Parser)]
#[command(name = "gallery")]
struct Arguments {
    /// The folder for the pictures; it is made if it does not exist
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// curtain, flag, tablecloth, ball, cape, banner, garment, crates or fan; again for more of them [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<SceneKind>,
    /// Width and height [pixels]
    #[arg(long, value_parser = size, value_name = "WxH", default_value = "640x360")]
    size: UVec2,
    /// Stills alone
    #[arg(long)]
    no_animations: bool,
    /// Smooth edges: draws twice as wide and high, and shrinks; takes three times as long
    #[arg(long)]
    fine: bool,
    /// Compares the stills with those in this folder, and fails where they look otherwise
    #[arg(long, value_name = "DIR")]
    compare: Option<PathBuf>,
    /// Draws nothing: compares what lies in DIR
    #[arg(long, requires = "compare")]
    only_compare: bool,
    /// Takes the pictures this much later, to try whether a comparison fails [s]
    #[arg(long, value_parser = seconds, value_name = "SECONDS", default_value = "0")]
    later: f32,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut scenes = arguments.scenes.clone();
    if scenes.is_empty() {
        scenes.extend(SceneKind::ALL);
    }
    if !arguments.only_compare
        && let Err(error) = draw(&arguments, &scenes)
    {
        eprintln!("gallery: {error}");
        return ExitCode::FAILURE;
    }
    match &arguments.compare {
        Some(stored) => compare_all(&arguments, &scenes, stored),
        None => ExitCode::SUCCESS,
    }
}

fn draw(arguments: &Arguments, scenes: &[SceneKind]) -> Result<(), DrawError> {
    let gallery = Gallery {
        dir: arguments.dir.clone(),
        size: arguments.size,
        animated: !arguments.no_animations,
        fine: arguments.fine,
        later: arguments.later,
    };
    for &scene in scenes {
        for file in gallery.draw(scene)? {
            println!("{}: {} bytes", file.path.display(), file.bytes);
        }
    }
    Ok(())
}

/// All of them, also where one fails.
fn compare_all(arguments: &Arguments, scenes: &[SceneKind], stored: &std::path::Path) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for scene in scenes {
        match compare(scene.name(), &arguments.dir, stored) {
            Ok(found) => println!("{scene}: {found}: as stored"),
            Err(error) => {
                eprintln!("gallery: {error}");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}

fn seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if (0.0..=60.0).contains(&value) => Ok(value),
        _ => Err("this is a time from 0 to 60 [s]".into()),
    }
}

fn size(text: &str) -> Result<UVec2, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (64..=4096).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some(UVec2::new(side(width)?, side(height)?)))
        .ok_or_else(|| "a size is two numbers from 64 to 4096, as 640x360".into())
}
