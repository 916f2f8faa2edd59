//! What the examples share, and the tests with them: scenes, stage, fabrics, camera, panel, scripts, pictures.

#![allow(dead_code, reason = "each example and each test uses a part")]

pub mod actor;
pub mod apply;
pub mod camera;
pub mod fabric;
pub mod graphics;
pub mod help;
pub mod mipmaps;
pub mod offscreen;
pub mod panel;
pub mod plot;
pub mod scenes;
pub mod script;
pub mod settings;
pub mod shortcuts;
pub mod stage;
pub mod status;
pub mod window;
