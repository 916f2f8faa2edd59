//! Strain beyond the fabric: when a cloth is asked for more than its fabric has.
//!
//! Posts that stand too far apart, a body that is put into a curtain: no number of substeps makes that right. While many edges are longer
//! than the fabric allows, its lines give way (`solve/give.rs`). What their pull moves is slow, as seen from the holders of the cloth, so
//! that stretch comes back without becoming speed (`solve/slowing.rs`).

use bevy_math::Isometry3d;
use bevy_reflect::prelude::*;

use crate::kernels::contact::Touch;

/// Strain of a cloth beyond its fabric, and its duration, as found at the end of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct Effort {
    /// Part of the edges that is longer than the fabric allows [-].
    pub strained: f32,
    /// Number of steps for which the cloth has been strained.
    steps: u32,
    /// True while it is asked for more than the fabric has.
    pub is_asked: bool,
    /// True once it has been so for more than a moment.
    is_told: bool,
    /// True while the fabric gives way and moves slowly: it is strained, or has not recovered from that.
    pub recovers: bool,
    /// Number of steps for which it goes on to come to rest after it has recovered.
    slowed: u32,
    /// True if a collider has drawn an edge far out.
    pub drawn_out: bool,
    /// Speed that other causes may give the cloth in this step: air, forces, its own frame [m/s].
    pub driven: f32,
    /// Largest speed of a collider that touches it in this step [m/s].
    pub struck: f32,
    /// Time for which holders, colliders and other causes of motion have stood still \[s\].
    standstill: f32,
    /// The same time, but counted anew when strain falls \[s\].
    lull: f32,
    /// Additional substeps that it needs, as a multiple of their number [-].
    more: f32,
    /// Number of held particles, and of colliders that touch the cloth.
    contacts: [usize; 2],
    /// Least values of the strained part and of the longest edge [-], since anything else moved.
    least: [f32; 2],
}

/// Strain above which an edge is strained, beyond the stretch that the material allows [-].
pub const STRAIN: f32 = 0.03;

/// Part of the edges that must be strained for a cloth to be asked for more than the fabric has [-].
const STRAINED: f32 = 0.05;

/// The same part where a body is inside the cloth [-]: few edges touch it, however hard it draws them out.
const STRAINED_INSIDE: f32 = 0.005;

/// Part of the edges below which a strained cloth is no longer strained [-]; the second value holds where a body is inside it, it has been
/// granted much, or it is a mesh. A cloth that is too short for its pins in one place alone moves freely elsewhere.
const STILL_STRAINED: [f32; 2] = [0.03, 0.01];

/// Length of a single edge, as a multiple of its rest length, above which the cloth counts as strained, and below which it no longer does
/// [-]: in general, and where a body is inside it or touches a mesh, whose edges share tension less evenly.
const LONG: [[f32; 2]; 2] = [[2.0, 1.5], [1.35, 1.2]];

/// Length of a single edge, as a multiple of its rest length, above which the cloth counts as strained at once [-].
const TORN: f32 = 8.0;

/// Number of strained steps after which a cloth is granted its demand: a cloth that is put to its pins is whole before that.
const LASTS: u32 = 6;

/// Number of strained steps after which a cloth is reported, and logged.
const TOLD: u32 = 30;

/// Speed of air, forces or a frame above which they stretch cloth by themselves [m/s].
const STORM: f32 = 5.0;

/// Length of an edge above which it is drawn far out: as a multiple of its rest length, and as a part of the size of the cloth [-].
const DRAWN_OUT: Longest = Longest {
    times: 4.0,
    part: 0.05,
};

/// Number of strained steps before a cloth gives way: where a body is inside it or it is torn, where a collider touches it, and where
/// nothing does. A cloth that is jerked, or hit, is strained for a moment, and rightly so.
const MOMENTS: [u32; 3] = [1, 6, 60];

/// Largest speed of a strained cloth by its own motion, as seen from its holders; twice that while constraints move it [m/s].
const SPEED: f32 = 1.0;

/// Speed below which holders, colliders and other causes of motion stand still [m/s].
const STILL: f32 = 0.05;

/// Part of the edges of a cloth driven by a storm that must be too long for it to take more substeps [-].
const STRETCHED: f32 = 0.005;

/// Speed of a collider that touches a strained cloth from outside, above which the cloth takes more substeps [m/s].
const STRUCK: f32 = 2.0;

/// Additional substeps, as multiples of their number [-]: the most, the rise in each step of a storm, the rise in each step in which the
/// cloth is struck, and the fall in each other step.
const MOST_MORE: f32 = 3.0;
const RISE: f32 = 0.1;
const STRUCK_RISE: f32 = 0.5;
const FALL: f32 = 0.005;

/// Number of steps for which a cloth goes on to come to rest after it has recovered.
const SLOWED: u32 = 60;

/// Number of those steps after which it may move twice as fast.
const LET_GO: f32 = 6.0;

/// Time after which a standstill counts as lasting \[s\].
const STANDS: f32 = 0.75;

/// Time of a standstill \[s\] after which a strained cloth moves by half as much after each half of this time.
const LULL: f32 = 0.5;

/// Ratio to its least value so far below which strain counts as falling, so that the cloth is not slowed as in a lull [-].
const BETTER: f32 = 0.98;

/// Least part of the speed that is left to a strained cloth in a lull [-].
const LEAST: f32 = 0.02;

impl Effort {
    /// Part of the edges that is strained and stays so [-].
    pub fn unmet(self) -> f32 {
        if self.is_told { self.strained } else { 0.0 }
    }

    /// Effort of a mesh that is, or is not, asked for more than it has.
    #[cfg(test)]
    pub fn asking(is_asked: bool) -> Self {
        Self {
            steps: if is_asked { LASTS } else { 0 },
            is_asked,
            ..Self::default()
        }
    }

    /// Additional substeps that the cloth needs, as a multiple of their number at rest: for a storm that stretches it, for a blow, for a
    /// mesh that is asked for more than it has [-].
    pub fn more_substeps(self) -> f32 {
        self.more
    }

    /// Part of the edges that is too long though the cloth is asked for no more than the fabric has [-].
    pub fn stretched(self) -> f32 {
        if self.recovers || self.strained <= STRETCHED {
            0.0
        } else {
            self.strained
        }
    }

    /// Returns whether it is strained now.
    pub fn is_strained(self) -> bool {
        self.steps > 0
    }

    /// Returns whether it has been strained for more than a moment.
    pub fn lasts(self) -> bool {
        self.steps >= LASTS
    }

    /// Returns whether it recovers, or has just done so: a particle that is farther from a pin than its tether allows comes back slowly.
    pub fn is_slowed(self) -> bool {
        self.slowed > 0
    }

    /// Returns whether its demand stays the same.
    pub fn stands(self) -> bool {
        self.standstill > STANDS
    }

    /// Updates the state from the lengths of the edges at the end of a step. A cloth that has been granted something recovers until that is
    /// taken back.
    pub fn update(&mut self, survey: EdgeSurvey, touch: Touch) {
        let EdgeSurvey {
            strained,
            longest,
            granted,
            is_mesh,
        } = survey;
        self.strained = strained;
        // A cloth that a storm stretches is not asked for more than it has.
        let blown = self.driven > STORM;
        self.driven = 0.0;
        self.drawn_out = longest.times > DRAWN_OUT.times && longest.part > DRAWN_OUT.part;
        let torn = longest.times > TORN;
        let long = LONG[usize::from(touch.overlaps || is_mesh && touch.any)];
        let ended = STILL_STRAINED[usize::from(touch.overlaps || granted || is_mesh)];
        let (most, long) = if self.recovers {
            (ended, long[1])
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
        self.slowed = if self.recovers {
            SLOWED
        } else {
            self.slowed.saturating_sub(1)
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
            (self.standstill, self.lull, self.least) = (0.0, 0.0, [f32::INFINITY; 2]);
        }
        for (least, now) in self.least.iter_mut().zip([strained, longest.times]) {
            // Strain that falls is not slowed.
            if now < BETTER * *least {
                (*least, self.lull) = (now, 0.0);
            }
        }
    }

    /// Adds the motion of the cloth's frame in so many seconds. A rotation counts as the displacement of a point one metre from its axis.
    pub fn carried(&mut self, [start, end]: [Isometry3d; 2], seconds: f32) {
        let turned = start.rotation.angle_between(end.rotation);
        let distance = start.translation.distance(end.translation);
        self.driven += (distance + turned) / seconds;
    }

    /// Counts the time for which holders, colliders and other causes of motion stand still; `speed` is the largest of theirs [m/s].
    pub fn pass(&mut self, seconds: f32, speed: f32, contacts: [usize; 2]) {
        if speed > STILL || contacts != self.contacts {
            (self.standstill, self.lull, self.least) = (0.0, 0.0, [f32::INFINITY; 2]);
        } else {
            self.standstill += seconds;
            self.lull += seconds;
        }
        self.contacts = contacts;
    }

    /// Part of its speed that is left to a strained cloth in a lull [-].
    pub fn lulled(self) -> f32 {
        let halvings = (self.lull - LULL).max(0.0) / (0.5 * LULL);
        (-halvings).exp2().max(LEAST)
    }

    /// Largest speed of a strained cloth by its own motion [m/s].
    pub fn speed(self) -> f32 {
        // A cloth that has recovered is let go by and by.
        let since = if self.recovers {
            0
        } else {
            SLOWED - self.slowed
        };
        SPEED * self.lulled() * (since as f32 / LET_GO).exp2()
    }
}

/// Survey of the edges at the end of a step.
#[derive(Clone, Copy)]
pub struct EdgeSurvey {
    /// Part of the edges that is longer than the fabric allows [-].
    pub strained: f32,
    pub longest: Longest,
    /// True if it has been granted so much that it is slowed until that is taken back.
    pub granted: bool,
    /// True for a cloth that is no sheet: its lines are short, and contradict one another.
    pub is_mesh: bool,
}

/// Length of the longest strained edge.
#[derive(Clone, Copy)]
pub struct Longest {
    /// Multiple of its rest length [-].
    pub times: f32,
    /// Part of the size of the cloth [-].
    pub part: f32,
}
