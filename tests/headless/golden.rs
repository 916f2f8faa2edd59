//! The bits of all cloth of each scene of the demo, written down: a change of the code that is to change no behaviour changes none of them.
//!
//! `GOLDEN=write` writes them anew, for a change that means to.

use std::{env, fmt::Write, fs, path::Path};

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::{
    common::scenes::{SceneCloth, SceneKind},
    demo::{all, demo},
    game::*,
};

/// A line for each scene: its hash, and its name.
const FILE: &str = "tests/headless/golden.txt";

/// Frames of 1/60 s.
const FRAMES: usize = 240;

/// FNV-1a, 64 bits, of all coordinates.
fn hash(app: &mut App) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for cloth in all::<With<SceneCloth>>(app) {
        for place in get::<ClothParticles>(app, cloth).positions() {
            for byte in place.to_array().map(f32::to_le_bytes).as_flattened() {
                hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    hash
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
        writeln!(now, "{:016x} {scene}", hash(&mut app)).expect("a line");
    }
    if env::var("GOLDEN").is_ok_and(|what| what == "write") {
        fs::write(path, now).expect("written");
        return;
    }
    let golden = fs::read_to_string(path).expect("the file");
    assert_eq!(now, golden, "other bits (`GOLDEN=write` writes them down)");
}
