//! The arithmetic: pure functions over slices, one file for each equation.

pub mod aerodynamics;
pub(crate) mod ball;
pub(crate) mod breeze;
pub(crate) mod capsule;
pub(crate) mod cells;
pub mod contact;
pub(crate) mod cuboid;
pub(crate) mod cylinder;
pub mod distance;
pub(crate) mod edges;
pub mod half_space;
pub mod hinge;
pub(crate) mod interleave;
#[cfg(test)]
mod interleave_tests;
pub(crate) mod lanes;
pub(crate) mod lattice;
pub(crate) mod limit;
pub(crate) mod line;
pub(crate) mod lines;
pub(crate) mod mesh;
pub mod normals;
#[cfg(test)]
mod oracle;
pub mod packed;
#[cfg(test)]
mod parity;
pub(crate) mod patches;
pub(crate) mod planes;
pub mod range;
pub(crate) mod recovery;
pub mod rigid;
pub mod rigid_motion;
pub(crate) mod ring;
#[cfg(test)]
mod ring_tests;
pub(crate) mod row;
pub(crate) mod share;
pub(crate) mod shear;
pub mod solid;
pub mod sphere;
pub mod spring;
pub(crate) mod squeeze;
pub(crate) mod terrain;
pub(crate) mod tether;
pub(crate) mod tile;
pub mod times;
pub(crate) mod vectors;
pub mod verlet;
pub(crate) mod viscosity;
