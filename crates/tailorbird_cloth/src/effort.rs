//! What a cloth does about being asked for more than its fabric has.
//!
//! Posts that stand too far apart, a body that is put into a curtain: no number of substeps makes that right. What is bounded is what comes
//! of it. While many edges are longer than the fabric lets them be, the cloth takes more substeps, which bear more tension;
//! what is longer than it should be comes back at a stated rate, without getting velocity of it; and what trembles
//! between the things that hold it is calmed.

use bevy_reflect::prelude::*;

use crate::{particles::ClothParticles, solver::kernels::contact::Contacts, topology::Topology};

/// How it stands with what a cloth is asked for, as was seen at the end of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub(crate) struct Effort {
    /// The part of the edges that is longer than the fabric lets them be [-].
    pub strained: f32,
    /// Which of [`FACTORS`] it takes.
    level: usize,
    /// For how many steps it has been short of substeps, or had more than it needs.
    since: u32,
    /// For how many steps it has been strained.
    steps: u32,
    /// Whether what is strained comes back at its rate.
    pub recovers: bool,
}

/// Edges that are longer than at rest by more than this, and than the material lets them be, are strained [-].
pub(crate) const STRAIN: f32 = 0.01;

/// A cloth of whose edges more than this part is strained is asked for more than the fabric has [-].
const STRAINED: f32 = 0.05;

/// And stays so until fewer are than this part [-].
const STILL_STRAINED: f32 = 0.01;

/// What is jerked, or hit, is strained for a moment, and rightly so: it has to be strained for so many steps before it recovers at a rate,
/// where something is inside of it, where something touches it, and where nothing does.
const MOMENTS: [u32; 3] = [1, 6, 30];

/// How many times as many substeps as at rest.
const FACTORS: [f32; 4] = [1.0, 1.5, 2.25, 3.0];

/// Where more than the first part of the edges is strained, it takes the next of [`FACTORS`] after so many steps; where less than the
/// second part is, it goes back.
const SHORT: (f32, u32) = (0.02, 2);
const AMPLE: (f32, u32) = (0.005, 60);

/// How fast a line of edges that are too long comes back as a whole, at least [m/s].
pub(crate) const SPEED: f32 = 1.0;

/// Rate at which edges that are too long come back [1/s]: twice that where they are much too long.
pub(crate) const RATE: f32 = 8.0;

/// Rate at which the motion of what is strained decays, as seen from what holds it [1/s].
const CALMED: f32 = 3.0;

impl Effort {
    /// How many times as many substeps as at rest.
    pub fn factor(self) -> f32 {
        FACTORS[self.level]
    }

    /// Which part of the edges is strained and stays so [-].
    pub fn unmet(self) -> f32 {
        if self.recovers { self.strained } else { 0.0 }
    }

    /// Sees at the end of a step which part of the edges is strained, and whether any is longer than twice its length.
    ///
    /// The number of substeps goes up and down in few steps that last, as each change is a small jolt to what lies still.
    pub fn see(&mut self, strained: f32, torn: bool, contacts: &Contacts) {
        self.strained = strained;
        let most = if self.recovers {
            STILL_STRAINED
        } else {
            STRAINED
        };
        self.steps = if strained > most || torn {
            self.steps + 1
        } else {
            0
        };
        let moment = match (contacts.overlaps, contacts.any) {
            (true, _) => MOMENTS[0],
            (false, true) => MOMENTS[1],
            (false, false) => MOMENTS[2],
        };
        self.recovers = self.steps >= moment;
        let (up, down) = (strained > SHORT.0, strained < AMPLE.0);
        self.since = if up || down { self.since + 1 } else { 0 };
        if up && self.since >= SHORT.1 && self.level + 1 < FACTORS.len() {
            (self.level, self.since) = (self.level + 1, 0);
        } else if down && self.since >= AMPLE.1 && self.level > 0 {
            (self.level, self.since) = (self.level - 1, 0);
        }
    }
}

impl ClothParticles {
    /// Slows what is strained between things that hold it, as seen from them, during a substep.
    pub(crate) fn calm_strained(&mut self, seconds: f32) {
        if !self.effort.recovers {
            return;
        }
        let Self {
            position,
            previous_position,
            inv_mass,
            ..
        } = self;
        let held = inv_mass.iter().enumerate().filter(|(_, w)| **w == 0.0);
        let (mut way, mut count) = (bevy_math::Vec3::ZERO, 0.0);
        for (i, _) in held {
            way += position.get(i) - previous_position.get(i);
            count += 1.0;
        }
        if count == 0.0 {
            return;
        }
        let (way, part) = (way / count, 1.0 - (-CALMED * seconds).exp());
        for (i, w) in inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let moved = position.get(i) - previous_position.get(i) - way;
                previous_position.set(i, previous_position.get(i) + part * moved);
            }
        }
    }

    /// A sheet in a perfect plane that something presses within that plane would stand as a board: pushes its particles out of it, each
    /// by its own part of 10 µm.
    pub(crate) fn disturb(&mut self, topology: &Topology) {
        const FLAT: f32 = 1e-4;
        const PUSH: f32 = 1e-5;
        let Self {
            position,
            previous_position,
            inv_mass,
            contacts,
            ..
        } = self;
        let flat = topology.flat && position.z.iter().all(|z| z.abs() < FLAT);
        if !flat || !contacts.any {
            return;
        }
        let normal = &contacts.normal;
        let sideways = |i: usize| normal.x[i].hypot(normal.y[i]) > normal.z[i].abs();
        if !(0..normal.len()).any(sideways) {
            return;
        }
        for (i, w) in inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let push = PUSH * crate::numbers::unit_of(i as u32);
                position.z[i] += push;
                previous_position.z[i] += push;
            }
        }
    }
}
