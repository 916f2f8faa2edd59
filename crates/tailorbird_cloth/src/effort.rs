//! Whether a cloth is asked for more than its fabric has, and how what is strained is slowed.
//!
//! Posts that stand too far apart, a body that is put into a curtain: no number of substeps makes that right. While many edges are longer
//! than the fabric lets them be, its lines give way (`solver/give.rs`), and what moves by their pull moves slowly, as seen from what holds
//! it, so that stretch comes back without becoming speed.

use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;

use crate::{
    particles::ClothParticles,
    solver::kernels::{contact::Contacts, rigid_motion::RigidMotion},
    topology::Topology,
};

/// How it stands with what a cloth is asked for, as was seen at the end of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub(crate) struct Effort {
    /// The part of the edges that is longer than the fabric lets them be [-].
    pub strained: f32,
    /// For how many steps it has been strained.
    steps: u32,
    /// Whether it is asked for more than the fabric has.
    pub is_asked: bool,
    /// Whether the fabric gives way, and moves slowly: it is, or has not recovered from it.
    pub recovers: bool,
    /// For how many steps it goes on to settle after it has recovered.
    settles: u32,
    /// Whether what touches it has drawn an edge far out.
    pub drawn_out: bool,
    /// How fast what else drives it may make it in this step: air, forces, its own frame [m/s].
    pub driven: f32,
    /// For how long what holds, touches and drives it has stood still \[s\].
    still: f32,
    /// The same, and since strain last came back \[s\].
    lull: f32,
    /// How many more times as many substeps it wants for a storm [-].
    more: f32,
    /// How many particles are held, and how many colliders touch it.
    around: [usize; 2],
    /// The least that was seen of the part that is strained and of the longest edge [-], since anything else moved.
    least: [f32; 2],
}

/// Edges that are longer than at rest by more than this, and than the material lets them be, are strained [-].
pub(crate) const STRAIN: f32 = 0.03;

/// A cloth of whose edges more than this part is strained is asked for more than the fabric has [-].
const STRAINED: f32 = 0.05;

/// What is strained stays so until fewer of its edges are than this part [-].
const STILL_STRAINED: f32 = 0.01;

/// A single edge that is longer than the first of these times its length counts as well, and what is strained stays so until none is longer
/// than the second [-]: anywhere, and on a mesh that something touches, whose edges share less evenly what they bear at once.
const LONG: [[f32; 2]; 2] = [[2.0, 1.5], [1.35, 1.2]];

/// A single edge that is longer than this many times its length counts at once [-].
const TORN: f32 = 8.0;

/// Air, forces and a frame that are faster than this stretch cloth by themselves [m/s].
const STORM: f32 = 5.0;

/// An edge is drawn far out that is longer than so many times its length, and than this part of what the cloth is large [-].
const DRAWN_OUT: Longest = Longest {
    times: 4.0,
    part: 0.05,
};

/// What is jerked, or hit, is strained for a moment, and rightly so: it has to be strained for so many steps before it gives way, where
/// something is inside of it or it is torn, where something touches it, and where nothing does.
const MOMENTS: [u32; 3] = [1, 6, 60];

/// How fast what is strained moves by itself, as seen from what holds it, at most; twice that while constraints move it [m/s].
const SPEED: f32 = 1.0;

/// What is farther apart than the cloth is large, times this, comes back faster [-]: no hand or post draws it out so far.
const FAR: f32 = 1.5;

/// The rate at which what is farther apart than that comes back [1/s].
const RATE: f32 = 8.0;

/// Rate at which the motion of what is strained decays, as seen from what holds it [1/s].
const CALMED: f32 = 3.0;

/// What holds, touches and drives a cloth stands still where it is slower than this [m/s].
const STILL: f32 = 0.05;

/// A cloth of whose edges more than this part is too long, and which a storm drives, takes more substeps [-].
const STRETCHED: f32 = 0.005;

/// How many more times as many it takes at most, more in each step in which it is stretched, and fewer in each in which it is not [-].
const MOST_MORE: f32 = 3.0;
const RISE: f32 = 0.1;
const FALL: f32 = 0.005;

/// What has recovered and touches nothing settles for so many steps.
const SETTLES: u32 = 60;

/// What has been still for this long stands \[s\].
const STANDS: f32 = 0.75;

/// Where all of that has stood still for this long \[s\], what is strained moves by half as much after each half of this time.
const LULL: f32 = 0.5;

/// Strain that falls below this part of what it was comes back, and is not slowed as in a lull [-].
const BETTER: f32 = 0.98;

/// The least part of its speed that is left of what is strained in a lull [-].
const LEAST: f32 = 0.02;

impl Effort {
    /// Which part of the edges is strained and stays so [-].
    pub fn unmet(self) -> f32 {
        if self.recovers { self.strained } else { 0.0 }
    }

    /// Whether a mesh is asked for more than it has.
    #[cfg(test)]
    pub fn asking(is_asked: bool) -> Self {
        Self {
            steps: u32::from(is_asked),
            is_asked,
            ..Self::default()
        }
    }

    /// How many more times as many substeps as at rest it wants for a storm that stretches it [-].
    pub fn more_substeps(self) -> f32 {
        self.more
    }

    /// Which part of the edges is too long though nothing is asked that the fabric has not [-].
    pub fn stretched(self) -> f32 {
        if self.recovers || self.strained <= STRETCHED {
            0.0
        } else {
            self.strained
        }
    }

    /// Whether it is strained now.
    pub fn is_strained(self) -> bool {
        self.steps > 0
    }

    /// Whether it recovers, or has just done so and touches nothing: what is farther from a pin than it reaches comes back slowly.
    pub fn settles(self) -> bool {
        self.settles > 0
    }

    /// Whether what is asked for stays the same.
    pub fn stands(self) -> bool {
        self.still > STANDS
    }

    /// Sees at the end of a step which part of the edges is strained, and how long the longest of those is. A mesh that has
    /// been `granted` something recovers until that is taken back; a sheet is granted nothing.
    pub fn see(
        &mut self,
        strained: f32,
        longest: Longest,
        contacts: &Contacts,
        granted: Option<bool>,
    ) {
        self.strained = strained;
        // What a storm stretches has not been asked for what it has not got.
        let blown = self.driven > STORM;
        self.driven = 0.0;
        self.drawn_out = longest.times > DRAWN_OUT.times && longest.part > DRAWN_OUT.part;
        let torn = longest.times > TORN;
        let long = LONG[usize::from(granted.is_some() && contacts.any)];
        let (most, long) = if self.recovers {
            (STILL_STRAINED, long[1])
        } else {
            (STRAINED, long[0])
        };
        self.steps = if !blown && (strained > most || longest.times > long) || torn {
            self.steps + 1
        } else {
            0
        };
        let moment = match (contacts.overlaps || torn, contacts.any) {
            (true, _) => MOMENTS[0],
            (false, true) => MOMENTS[1],
            (false, false) => MOMENTS[2],
        };
        self.recovers = self.steps >= moment || granted == Some(true);
        self.settles = if self.recovers {
            SETTLES
        } else if contacts.any {
            0
        } else {
            self.settles.saturating_sub(1)
        };
        self.is_asked = self.recovers && !blown;
        self.more = if blown && strained > STRETCHED && !self.recovers {
            MOST_MORE.min(self.more + RISE)
        } else {
            (self.more - FALL).max(0.0)
        };
        if !self.recovers {
            (self.still, self.lull, self.least) = (0.0, 0.0, [f32::INFINITY; 2]);
        }
        for (least, now) in self.least.iter_mut().zip([strained, longest.times]) {
            // What comes back is not held up.
            if now < BETTER * *least {
                (*least, self.lull) = (now, 0.0);
            }
        }
    }

    /// Its frame goes this way in so many seconds. What turns drives along as it does a metre from its axis.
    pub fn carried(&mut self, [start, end]: [Isometry3d; 2], seconds: f32) {
        let turned = start.rotation.angle_between(end.rotation);
        let way = start.translation.distance(end.translation);
        self.driven += (way + turned) / seconds;
    }

    /// What holds, touches and drives the cloth moves at this speed [m/s].
    fn pass(&mut self, seconds: f32, speed: f32, around: [usize; 2]) {
        if speed > STILL || around != self.around {
            (self.still, self.lull, self.least) = (0.0, 0.0, [f32::INFINITY; 2]);
        } else {
            self.still += seconds;
            self.lull += seconds;
        }
        self.around = around;
    }

    /// How fast what is strained moves by itself at most [m/s].
    fn speed(self) -> f32 {
        let halvings = (self.lull - LULL).max(0.0) / (0.5 * LULL);
        SPEED * (-halvings).exp2().max(LEAST)
    }
}

/// How long the longest strained edge is.
#[derive(Clone, Copy)]
pub(crate) struct Longest {
    /// As a multiple of its length at rest [-].
    pub times: f32,
    /// As a part of what the cloth is large [-].
    pub part: f32,
}

/// The longest side of a box around points \[m\]; 0 where there is none.
fn extent(points: impl Iterator<Item = Vec3>) -> f32 {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = points.fold(none, |(low, high), p| (low.min(p), high.max(p)));
    (high - low).max_element().max(0.0)
}

/// What the motion of a strained cloth is seen from.
struct Led {
    /// How most of what holds it moved since the start of the substep, and the whole where nothing does \[m\].
    way: Vec3,
    /// How far what holds or touches it moved \[m\].
    reach: f32,
    /// The same, of what moved farthest of all that holds it \[m\].
    farthest: f32,
    /// How far what holds it is apart \[m\].
    apart: f32,
    /// How many particles are held.
    held: usize,
}

impl ClothParticles {
    fn led(&mut self, out: f32) -> Led {
        let mut scratch = std::mem::take(&mut self.lambda);
        let led = self.led_with(out, &mut scratch);
        self.lambda = scratch;
        led
    }

    fn led_with(&self, out: f32, lengths: &mut Vec<f32>) -> Led {
        let held = self.inv_mass.iter().enumerate().filter(|(_, w)| **w == 0.0);
        let ways =
            (held.clone()).map(|(i, _)| self.position.get(i) - self.previous_position.get(i));
        lengths.clear();
        lengths.extend(ways.clone().map(Vec3::length));
        let farthest = lengths.iter().copied().fold(0.0, f32::max);
        // What is inside of something is pushed out of it.
        let swept = if self.contacts.any {
            self.contacts.swept + out
        } else {
            0.0
        };
        let Some(middle) = lengths.len().checked_sub(1).map(|last| last / 2) else {
            let whole = RigidMotion::of_all(&self.mass, &self.position, &self.previous_position);
            return Led {
                way: whole.displacement,
                // The ground stops what falls.
                reach: whole.displacement.length() + swept,
                farthest: swept,
                apart: 0.0,
                held: 0,
            };
        };
        let (_, &mut middle, _) = lengths.select_nth_unstable_by(middle, f32::total_cmp);
        // What jumps away from the others leads nobody.
        let most = ways.filter(|way| way.length() <= 1.5 * middle);
        let (sum, count) = most.fold((Vec3::ZERO, 0.0), |(sum, count), way| {
            (sum + way, count + 1.0)
        });
        Led {
            way: sum / f32::max(count, 1.0),
            reach: middle.max(swept),
            farthest: farthest.max(swept),
            apart: extent(held.map(|(i, _)| self.position.get(i))),
            held: lengths.len(),
        }
    }

    /// Slows what is strained, as seen from what holds it, during a substep. `out` is how far colliders push \[m\].
    pub(crate) fn calm_strained(&mut self, seconds: f32, out: f32) {
        if !self.effort.recovers {
            return;
        }
        let Led { way, reach, .. } = self.led(out);
        let most = (self.effort.speed() + self.effort.driven) * seconds + reach;
        let part = 1.0 - (-CALMED * seconds).exp();
        for (i, w) in self.inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let before = self.previous_position.get(i);
                let moved = self.position.get(i) - before - way;
                let kept = ((1.0 - part) * moved).clamp_length_max(most);
                self.previous_position.set(i, before + moved - kept);
            }
        }
    }

    /// Takes back what constraints moved what is strained by, beyond what it may move in a substep. `out` is how far colliders push, and `size`
    /// how large the cloth is \[m\].
    pub(crate) fn slow_strained(&mut self, seconds: f32, [out, size]: [f32; 2]) {
        if !self.effort.recovers {
            return;
        }
        let led = self.led(out);
        let around = [led.held, self.contacts.touched];
        let driven = self.effort.driven;
        let fastest = driven.max((led.farthest - out).max(0.0) / seconds);
        self.effort.pass(seconds, fastest, around);
        let mut speed = 2.0 * self.effort.speed() + driven;
        if !self.contacts.any {
            let far = f32::max(FAR * size, led.apart + size);
            speed += RATE * (extent(self.previous_position.iter()) - far).max(0.0);
        }
        let most = speed * seconds + led.reach;
        for (i, w) in self.inv_mass.iter().enumerate() {
            if *w > 0.0 {
                let start = self.previous_position.get(i) + led.way;
                let moved = self.position.get(i) - start;
                if moved.length_squared() > most * most {
                    self.position.set(i, start + moved.clamp_length_max(most));
                }
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
