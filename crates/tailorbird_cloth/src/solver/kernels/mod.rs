//! The arithmetic: pure functions over slices, one file for each equation.

pub mod aerodynamics;
pub(crate) mod cells;
pub mod contact;
pub mod distance;
pub mod half_space;
pub mod hinge;
pub(crate) mod lanes;
pub(crate) mod lattice;
pub(crate) mod line;
pub(crate) mod mesh;
pub mod normals;
pub mod packed;
pub mod range;
pub mod rigid;
pub mod sphere;
pub(crate) mod tether;
#[cfg(test)]
mod times;
pub mod verlet;
pub(crate) mod viscosity;
