//! Colliders of all shapes, against physics.

#![cfg(test)]

#[path = "../chains/scene.rs"]
#[expect(dead_code, reason = "shared with the test `chains`")]
mod scene;

mod bad_input;
mod bodies;
mod custom;
mod drops;
mod random;
mod runners;
mod shapes;
