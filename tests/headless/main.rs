//! The tests of everything that needs no picture: one module per behaviour, each opening with its contract.
//!
//! They step time by hand ([`world`]) and assert what physics says. What rounding adds to it is bounded from the size
//! of a unit in the last place, not from what the code printed once.
#![cfg(test)]

#[path = "../../examples/common/mod.rs"]
mod common;

mod bad_input;
mod catenary;
mod demo;
mod demo_hands;
mod detail;
mod determinism;
mod drag;
mod drawn;
mod drawn_holds;
mod fabric;
mod forces;
mod frame_rate;
mod free_fall;
mod friction;
mod game;
mod garment;
mod golden;
mod grab;
mod half_space;
mod lifecycle;
mod mesh;
mod mesh_cloth;
mod mesh_parts;
mod mesh_sources;
mod momentum;
mod moving_frame;
mod panel;
mod panel_window;
mod pendulum;
mod pins;
mod rebuild;
mod resting_energy;
mod scenes;
mod schedule;
mod settings;
mod settings_file;
mod smooth_motion;
mod sphere;
mod sphere_keys;
mod symmetry;
mod wind;
mod world;
