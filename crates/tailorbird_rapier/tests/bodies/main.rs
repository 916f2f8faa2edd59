//! The bridge with the real engine, headless. What is asked of every bridge stands beside the crate `tailorbird_bridge`.

#![cfg(test)]

#[path = "../../../tailorbird_bridge/suite/ball.rs"]
mod ball;
#[path = "../../../tailorbird_bridge/suite/curtain.rs"]
mod curtain;
mod engine;
#[path = "../../../tailorbird_bridge/suite/filters.rs"]
mod filters;
#[path = "../../../tailorbird_bridge/suite/momentum.rs"]
mod momentum;
#[path = "../../../tailorbird_bridge/suite/rail.rs"]
mod rail;
#[path = "../../../tailorbird_bridge/suite/shapes.rs"]
mod shapes;
#[path = "../../../tailorbird_bridge/suite/terrain.rs"]
mod terrain;
#[path = "../../../tailorbird_bridge/suite/world.rs"]
mod world;
