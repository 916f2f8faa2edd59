//! A cloth in a step: data that its stages read and write.

use crate::{
    coefficients::{Coefficients, Method},
    contact::colliders::Layers,
    frame::Frame,
    holds::Holds,
    limits::MotionLimits,
    particles::Particles,
    reaction::PinForces,
    tethers::Tethers,
    topology::Topology,
};

/// A cloth in a step: data that its stages read and write.
pub struct ClothData<'a> {
    /// Topology, computed once from the rest shape.
    pub topology: &'a Topology,
    /// Coefficients of the material.
    pub coefficients: &'a Coefficients,
    /// Method that solves the constraints.
    pub method: Method,
    /// Layers, which decide what colliders it meets.
    pub layers: Layers,
    /// Largest distances from pins.
    pub tethers: &'a Tethers,
    /// Attachments.
    pub holds: &'a mut Holds,
    /// Motion constraints, if there are any.
    pub limits: Option<&'a MotionLimits>,
    /// Forces on its holders, if they are measured.
    pub forces: Option<&'a mut PinForces>,
    /// Frame of the particles' coordinates.
    pub frame: &'a mut Frame,
    /// Its particles.
    pub particles: &'a mut Particles,
}
