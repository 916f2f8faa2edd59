#![cfg(test)]
//! Tests that need a graphics driver: pictures, and picking by depth. A software driver does.
//!
//! Without a driver each test says so and is skipped; with `TAILORBIRD_REQUIRE_GPU` set it fails instead. The file
//! named by `TAILORBIRD_SKIP_LOG` gets a line for each test that was skipped.

#[path = "../../examples/common/mod.rs"]
mod common;

mod depth_picking;
mod device_loss;
mod light;
mod motion;
mod offscreen;
mod pictures;
mod unseen;
mod writes;
