//! Crates and a ball, bodies of the physics engine avian, fall on a sheet that carries them. Drag the sheet with the left mouse button,
//! turn the camera with the right one.

mod common;

use std::process::ExitCode;

use common::scenes::SceneKind;

fn main() -> ExitCode {
    common::play("crates", SceneKind::Crates)
}
