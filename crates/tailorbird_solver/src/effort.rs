//! Whether a cloth is asked for more than its fabric has.
//!
//! Posts that stand too far apart, a body that is put into a curtain: no number of substeps makes that right. While many edges are longer
//! than the fabric lets them be, its lines give way (`solve/give.rs`), and what moves by their pull moves slowly, as seen from what holds
//! it, so that stretch comes back without becoming speed (`solve/slowing.rs`).

use bevy_math::Isometry3d;
use bevy_reflect::prelude::*;

use crate::kernels::contact::Touch;

/// Whether more is asked of a cloth than its fabric has, and for how long, as was seen at the end of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct Effort {
    /// The part of the edges that is longer than the fabric lets them be [-].
    pub strained: f32,
    /// For how many steps it has been strained.
    steps: u32,
    /// Whether it is asked for more than the fabric has.
    pub is_asked: bool,
    /// Whether it has been so for more than a moment.
    is_told: bool,
    /// Whether the fabric gives way, and moves slowly: it is, or has not recovered from it.
    pub recovers: bool,
    /// For how many steps it goes on to settle after it has recovered.
    settles: u32,
    /// Whether what touches it has drawn an edge far out.
    pub drawn_out: bool,
    /// How fast what else drives it may make it in this step: air, forces, its own frame [m/s].
    pub driven: f32,
    /// How fast what touches it goes at most in this step [m/s].
    pub struck: f32,
    /// For how long what holds, touches and drives it has stood still \[s\].
    still: f32,
    /// The same, and since strain last came back \[s\].
    lull: f32,
    /// How many more times as many substeps it wants [-].
    more: f32,
    /// How many particles are held, and how many colliders touch it.
    around: [usize; 2],
    /// The least that was seen of the part that is strained and of the longest edge [-], since anything else moved.
    least: [f32; 2],
}

/// Edges that are longer than at rest by more than this, and than the material lets them be, are strained [-].
pub const STRAIN: f32 = 0.03;

/// A cloth of whose edges more than this part is strained is asked for more than the fabric has [-].
const STRAINED: f32 = 0.05;

/// And so is one that something is inside of, and of which more than this part is [-]: few edges touch it, however hard it draws them out.
const STRAINED_INSIDE: f32 = 0.005;

/// What is strained stays so until fewer of its edges are than this part [-], and where something is inside of it, it has been granted much, or is
/// a mesh, until fewer are than that. What is too short for its pins in some place alone moves as it likes elsewhere.
const STILL_STRAINED: [f32; 2] = [0.03, 0.01];

/// A single edge that is longer than the first of these times its length counts as well, and what is strained stays so until none is longer
/// than the second [-]: anywhere, and where something is inside of it, or touches a mesh, whose edges share less evenly what they bear at
/// once.
const LONG: [[f32; 2]; 2] = [[2.0, 1.5], [1.35, 1.2]];

/// A single edge that is longer than this many times its length counts at once [-].
const TORN: f32 = 8.0;

/// What has been strained for so many steps is granted what it is asked for: what is put to its pins is whole before that.
const LASTS: u32 = 6;

/// And is told, and logged, after so many.
const TOLD: u32 = 30;

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

/// What holds, touches and drives a cloth stands still where it is slower than this [m/s].
const STILL: f32 = 0.05;

/// A cloth of whose edges more than this part is too long, and which a storm drives, takes more substeps [-].
const STRETCHED: f32 = 0.005;

/// And so does one that is strained by what touches it from outside and goes faster than this [m/s].
const STRUCK: f32 = 2.0;

/// How many more times as many it takes at most, more in each step in which it wants them, there in a storm and here where it is struck,
/// and fewer in each in which it does not [-].
const MOST_MORE: f32 = 3.0;
const RISE: f32 = 0.1;
const STRUCK_RISE: f32 = 0.5;
const FALL: f32 = 0.005;

/// What has recovered settles for so many steps.
const SETTLES: u32 = 60;

/// After so many steps of those it moves twice as fast.
const LET_GO: f32 = 6.0;

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
        if self.is_told { self.strained } else { 0.0 }
    }

    /// Whether a mesh is asked for more than it has.
    #[cfg(test)]
    pub fn asking(is_asked: bool) -> Self {
        Self {
            steps: if is_asked { LASTS } else { 0 },
            is_asked,
            ..Self::default()
        }
    }

    /// How many more times as many substeps as at rest it wants: for a storm that stretches it, for a blow, for a mesh that is asked for
    /// more than it has [-].
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

    /// Whether it has been strained for more than a moment.
    pub fn lasts(self) -> bool {
        self.steps >= LASTS
    }

    /// Whether it recovers, or has just done so: what is farther from a pin than it reaches comes back slowly.
    pub fn settles(self) -> bool {
        self.settles > 0
    }

    /// Whether what is asked for stays the same.
    pub fn stands(self) -> bool {
        self.still > STANDS
    }

    /// Sees at the end of a step how long the edges are. What has been granted something recovers until that is taken back.
    pub fn see(&mut self, seen: Seen, touch: Touch) {
        let Seen {
            strained,
            longest,
            granted,
            is_mesh,
        } = seen;
        self.strained = strained;
        // What a storm stretches has not been asked for what it has not got.
        let blown = self.driven > STORM;
        self.driven = 0.0;
        self.drawn_out = longest.times > DRAWN_OUT.times && longest.part > DRAWN_OUT.part;
        let torn = longest.times > TORN;
        let long = LONG[usize::from(touch.overlaps || is_mesh && touch.any)];
        let still = STILL_STRAINED[usize::from(touch.overlaps || granted || is_mesh)];
        let (most, long) = if self.recovers {
            (still, long[1])
        } else if touch.overlaps {
            (STRAINED_INSIDE, long[0])
        } else {
            (STRAINED, long[0])
        };
        self.steps = if !blown && (strained > most || longest.times > long) || torn {
            self.steps + 1
        } else {
            0
        };
        let moment = match (touch.overlaps || torn, touch.any) {
            (true, _) => MOMENTS[0],
            (false, true) => MOMENTS[1],
            (false, false) => MOMENTS[2],
        };
        self.recovers = self.steps >= moment || granted;
        self.settles = if self.recovers {
            SETTLES
        } else {
            self.settles.saturating_sub(1)
        };
        self.is_asked = self.recovers && !blown;
        self.is_told = self.recovers && (self.is_told || self.steps >= TOLD);
        let stormy = blown && strained > STRETCHED && !self.recovers;
        let struck = self.is_strained() && self.struck > STRUCK && !touch.overlaps;
        self.struck = 0.0;
        let change = if struck {
            STRUCK_RISE
        } else if stormy || is_mesh && self.is_asked {
            RISE
        } else {
            -FALL
        };
        self.more = (self.more + change).clamp(0.0, MOST_MORE);
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
    pub fn pass(&mut self, seconds: f32, speed: f32, around: [usize; 2]) {
        if speed > STILL || around != self.around {
            (self.still, self.lull, self.least) = (0.0, 0.0, [f32::INFINITY; 2]);
        } else {
            self.still += seconds;
            self.lull += seconds;
        }
        self.around = around;
    }

    /// Which part of its speed is left in a lull [-].
    pub fn lulled(self) -> f32 {
        let halvings = (self.lull - LULL).max(0.0) / (0.5 * LULL);
        (-halvings).exp2().max(LEAST)
    }

    /// How fast what is strained moves by itself at most [m/s].
    pub fn speed(self) -> f32 {
        // What has recovered is let go by and by.
        let since = if self.recovers {
            0
        } else {
            SETTLES - self.settles
        };
        SPEED * self.lulled() * (since as f32 / LET_GO).exp2()
    }
}

/// What is seen at the end of a step.
#[derive(Clone, Copy)]
pub struct Seen {
    /// The part of the edges that is longer than the fabric lets them be [-].
    pub strained: f32,
    pub longest: Longest,
    /// Whether it has been granted so much that it is slowed until that is taken back.
    pub granted: bool,
    /// Whether it is no sheet: its lines are short, and contradict one another.
    pub is_mesh: bool,
}

/// How long the longest strained edge is.
#[derive(Clone, Copy)]
pub struct Longest {
    /// As a multiple of its length at rest [-].
    pub times: f32,
    /// As a part of what the cloth is large [-].
    pub part: f32,
}
