//! Colliders of all shapes, against physics.

#![cfg(test)]

mod bad_input;
mod bodies;
mod custom;
mod drops;
mod random;
mod runners;
mod shapes;
