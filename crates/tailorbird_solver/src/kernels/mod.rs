//! The arithmetic: pure functions over slices, one file for each equation.

pub mod aerodynamics;
pub mod ball;
pub mod bend;
pub mod breeze;
pub mod capsule;
pub mod cells;
pub mod contact;
pub mod cuboid;
pub mod cylinder;
pub mod distance;
pub mod edges;
pub mod half_space;
pub mod hinge;
pub mod lanes;
pub mod lattice;
pub mod limit;
pub mod line;
pub mod lines;
pub mod mesh;
pub mod normals;
#[cfg(test)]
mod oracle;
pub mod packed;
#[cfg(test)]
mod parity;
pub mod patches;
pub mod planes;
pub mod range;
pub mod recovery;
pub mod rigid;
pub mod rigid_motion;
pub mod ring;
#[cfg(test)]
mod ring_tests;
pub mod row;
pub mod share;
pub mod shear;
pub mod solid;
pub mod sphere;
pub mod spring;
pub mod squeeze;
pub mod terrain;
pub mod tether;
pub mod tile;
pub mod vectors;
pub mod verlet;
pub mod viscosity;
