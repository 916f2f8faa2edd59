//! A cloth in a step: what its stages read and write.

use crate::{
    coefficients::{Coefficients, Method},
    contact::{Colliders, Layers},
    frame::Frame,
    holds::Holds,
    limits::MotionLimits,
    particles::Particles,
    reaction::PinForces,
    solve,
    substep::Substep,
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

/// A stage of a substep.
pub type Stage = fn(&Substep, &Colliders, &mut Cloth);

/// The stages of a substep, in their order.
pub const STAGES: [(&str, Stage); 6] = [
    ("advance", |substep, _, cloth| cloth.advance(substep)),
    ("integrate", |substep, _, cloth| {
        solve::integrate(substep, cloth);
    }),
    ("find contacts", |substep, colliders, cloth| {
        colliders.approach(substep, cloth);
    }),
    ("solve", |substep, _, cloth| solve::solve(substep, cloth)),
    ("collide", |substep, colliders, cloth| {
        colliders.collide_all(substep, cloth);
    }),
    ("calm", |substep, _, cloth| solve::calm(substep, cloth)),
];

impl Cloth<'_> {
    /// All stages of a substep.
    pub fn substep(&mut self, substep: &Substep, colliders: &Colliders) {
        for (_, stage) in STAGES {
            stage(substep, colliders, self);
        }
    }

    /// Moves the frame on by one substep, and with it what is held by others.
    pub fn advance(&mut self, substep: &Substep) {
        self.frame.advance(substep, self.particles);
        if let Some(limits) = self.limits {
            limits.advance(substep, self.particles);
        }
        self.holds.advance(substep, self.frame, self.particles);
    }
}
