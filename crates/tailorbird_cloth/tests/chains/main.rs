//! The chain solver against physics: elasticity, conservation, the same bits everywhere, what stretches, what survives.
//!
//! Every bound comes from theory with a tolerance, or is a promise about quality with a margin of 2; none is a recorded output.

#![cfg(test)]

mod bar;
mod bits;
mod conservation;
mod elastica;
mod extreme;
mod irregular;
mod locking;
mod memory;
mod meshes;
mod stretch;
mod substeps;

#[path = "../../../tailorbird_solver/src/topology/test_meshes.rs"]
mod test_meshes;
