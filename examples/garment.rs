//! A skirt from a glTF file (`assets/garments/skirt.gltf`, made by `cargo xtask garment`): a waistband of denim and panels of cotton
//! are two meshes with materials of their own and become one cloth, held by what is painted on it (`_CLOTH_PIN`).
//!
//! Drag it with the left mouse button, turn the camera with the right one; the arrow keys, Page Up and Page Down move the figure
//! under it.

mod common;

use std::process::ExitCode;

use common::scenes::SceneKind;

fn main() -> ExitCode {
    common::play("garment", SceneKind::Garment)
}
