//! The arithmetic: pure functions over slices, one file for each equation.

pub mod aerodynamics;
pub mod contact;
pub mod distance;
pub mod half_space;
pub mod normals;
pub mod rigid;
pub mod sphere;
pub mod verlet;
