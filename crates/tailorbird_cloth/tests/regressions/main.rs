//! A test for each bug that cloth in other engines had, named after it. Those that colliders can have are here; a table of all:
//!
//! | bug | where its test is |
//! | --- | --- |
//! | a velocity spike when a kinematic vertex or backstop is applied only in the first substep | `input` for pins and colliders; `holding/regressions` for attachments, targets and backstops |
//! | velocity growing without end on a resting contact | `contacts` for colliders; `holding/regressions` for backstops; `headless/resting_energy` for ten minutes |
//! | the last motion replayed when no new input comes | `input` for colliders; `holding/regressions` for attachments and targets |
//! | a mesh without edges or a constraint with two equal vertices hangs or asserts | `broken_meshes` |
//! | a force given per body applied per vertex | `headless/forces`: an impulse; `contacts`: what bodies get back from many particles |
//! | sensors taking a contact slot | there are no slots, and sensors never become colliders: `filters` in the suite of `tailorbird_bridge`, with either engine |
//! | double-sided faces | `meshes` for what moves; `headless/mesh_parts` for what is drawn |
//! | the cloth vanishing after an extreme move | `input` for entities and colliders; `chains/extreme` for pins, gravity and time; `headless/mesh_parts` for what is drawn |
//! | split vertices at UV seams opening up | `headless/mesh_cloth`, `headless/garment` |
//! | mesh LOD swapping the simulated mesh | not possible: what is simulated is taken from a mesh once, and there are no levels of detail |
//! | very low mass per particle exploding | `contacts` for colliders and bodies; `broken_meshes` for constraints |
//! | a fixed contact buffer overflowing silently | `contacts` |
//! | self-collision on by default costing ten times the frame | not possible: cloth does not collide with itself in this version |
//! | motion depending on dt² in `Update` | `input`; `headless/frame_rate` for fixed steps |
//! | results depending on `HashMap` order | `contacts` for colliders; `broken_meshes` for topology, `headless/determinism` for crowds |
//! | the mesh asset replaced each frame (flicker) | `headless/mesh`: the asset of the game stays, the cloth's own is written |
//! | textures lost after a tear | not possible: cloth does not tear in this version |
//! | culled at the rest pose's box | `headless/mesh`, `headless/mesh_parts` |
//!
//! `headless` is the test of the workspace, the others are those of this crate.

#![cfg(test)]

mod contacts;
mod input;
mod meshes;
