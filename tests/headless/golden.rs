//! The bits of all cloth of each scene of the demo, written down.

use std::{fmt::Write, path::Path};

use bevy::prelude::*;
use tailorbird::prelude::*;
use tailorbird_test::{golden, hash};

use crate::{
    common::scenes::{SceneCloth, SceneKind},
    demo::{all, demo},
    game::*,
};

/// A line for each scene: its hash, and its name.
const FILE: &str = "tests/headless/golden.txt";

/// Frames of 1/60 s.
const FRAMES: usize = 240;

/// Of all cloth of the scene.
fn bits(app: &mut App) -> u64 {
    let cloths = all::<With<SceneCloth>>(app);
    hash(
        cloths
            .iter()
            .map(|cloth| get::<ClothParticles>(app, *cloth)),
    )
}

#[test]
#[cfg_attr(
    not(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")),
    ignore = "sines and powers of another `libm` have other bits"
)]
fn scenes_have_the_bits_that_are_written_down() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let mut now = String::new();
    for scene in SceneKind::ALL {
        let mut app = demo(scene);
        // What is loaded comes when it does; from there on all begins anew.
        wait(&mut app, |app| {
            !all::<(With<SceneCloth>, With<ClothParticles>)>(app).is_empty()
        });
        tap(&mut app, KeyCode::KeyR);
        frames(&mut app, FRAMES);
        writeln!(now, "{:016x} {scene}", bits(&mut app)).expect("a line");
    }
    golden::check(&path, &now);
}
