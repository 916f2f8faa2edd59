//! Headless system tests.
#![cfg(test)]

mod drag;
mod game;
mod mesh;
mod sphere_keys;
