//! A cloth in a step: what its stages read and write.

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

/// A cloth in a step: what its stages read and write.
pub struct Cloth<'a> {
    /// What is computed once from the rest shape.
    pub topology: &'a Topology,
    /// What it resists with.
    pub coefficients: &'a Coefficients,
    /// How its constraints are solved.
    pub method: Method,
    /// Which colliders it meets.
    pub layers: Layers,
    /// How far particles get from pins.
    pub tethers: &'a Tethers,
    /// What others hold.
    pub holds: &'a mut Holds,
    /// How far particles may get from targets, where some have any.
    pub limits: Option<&'a MotionLimits>,
    /// With which force it pulls at what holds it, where that is measured.
    pub forces: Option<&'a mut PinForces>,
    /// What its particles' coordinates refer to.
    pub frame: &'a mut Frame,
    /// Its particles.
    pub particles: &'a mut Particles,
}
