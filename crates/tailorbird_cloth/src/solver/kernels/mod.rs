//! The arithmetic: pure functions over slices, one file for each equation.

pub mod aerodynamics;
pub(crate) mod cells;
pub mod contact;
pub mod distance;
pub mod half_space;
pub mod hinge;
pub(crate) mod lanes;
pub(crate) mod lattice;
pub(crate) mod limit;
pub(crate) mod line;
pub(crate) mod mesh;
pub mod normals;
pub mod packed;
#[cfg(test)]
mod parity;
pub mod range;
pub mod rigid;
pub mod rigid_motion;
pub(crate) mod shear;
pub mod sphere;
pub mod spring;
pub(crate) mod squeeze;
pub(crate) mod tether;
pub mod times;
pub(crate) mod vectors;
pub mod verlet;
pub(crate) mod viscosity;
