//! Sampling of poses at the times of steps: of entities that hold cloth, carry it, push it or blow at it.
//!
//! Cloth steps at a fixed rate. Games move things in `FixedUpdate` and in physics engines, step by step; and in `Update` and
//! `PostUpdate`, as all animation is, frame by frame. Both may be at any rate, and one may be above the other in the hierarchy: a
//! bone that is animated in each frame, on a character that physics moves. **The rule**:
//!
//! - **An entity that the fixed loop moves is taken as it is**, without delay. It is recognised by a `Transform` that changes between the
//!   start of the fixed loop's step and that of cloth.
//! - **An entity that is moved between frames is sampled a frame late**, evenly over the steps: its pose between the frames on both sides
//!   of that moment, on a curve without kinks. With one step at the end of each frame, that is its present pose.
//! - **An entity that moved while cloth did not simulate, or hopped, carries cloth along**; its motion is not felt.
//!
//! Translation, rotation and scale of each entity are judged by themselves: a character that runs in `FixedUpdate` and looks round in
//! `Update` is both. Each parent is judged by itself, too.
//!
//! ```text
//! frame            N−1              N                N+1
//! Update           ● P₀             ● P₁             ● P₂             sets where a hand is
//!                  │                │                │
//! time  ───────────┼────────────────┼────────────────┼──────────────▶
//!                  t₀    s₁   s₂    t₁   s₃    s₄    t₂
//!                        │    │          │     │
//! steps run in frame     └─N──┘          └─N+1─┘     P₁ is known to those of frame N+1, P₂ to nobody yet
//! see the hand at  s₁−d, s₂−d            s₃−d, s₄−d  on the way from P₀ to P₁, where d is the length of a frame
//! ```
//!
//! The delay d is the length of the longest of the last 32 frames, so that varying frames do not make sampled motion vary in speed. It
//! grows at once, and shrinks within a quarter of a second. A frame of more than 0.1 s that takes
//! three times as long as the one before (an app that was suspended, a level that was loaded) is a pause, in which cloth is carried.
//!
//! The poses that physics engines restore at the start of the fixed loop, and ease after it (`TransformInterpolation` of avian), are
//! of the first kind: the step sees the engine's own.
//!
//! # Hops
//!
//! A displacement whose velocity differs from the one before by more than that one's magnitude and
//! [`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed) is a hop: at 60 frames a second half a metre for an
//! entity that stood, at 30 one metre. All but the motion before it is carried. [`ClothSampledMotion::teleport`] tells of a shorter one; it is a component of
//! each cloth, collider and zone, of all holders of a cloth, and of all their parents:
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_transform::components::Transform;
//! # use tailorbird_cloth::prelude::*;
//! fn climb(mut hands: Query<(&mut Transform, &mut ClothSampledMotion)>) {
//!     for (mut transform, mut motion) in &mut hands {
//!         transform.translation.y += 0.3;
//!         motion.teleport();
//!     }
//! }
//!
//! fn tell(mut teleports: MessageReader<ClothMotionTeleported>) {
//!     for teleport in teleports.read() {
//!         println!("{} was put elsewhere", teleport.entity);
//!     }
//! }
//! ```
//!
//! # Blows
//!
//! Motion below that may still start or stop too suddenly for cloth to follow. If one holder has all of a cloth (its entity, or the target of
//! its attachments), it pulls with at most 150 m/s²; the displacement beyond carries the cloth. Otherwise a holder that stood and moves at 8
//! to 29 m/s from one step to the next would stretch single edges of a cape by 50 to 120 % for a moment.
//!
//! A change of parents is a hop as well. A world whose origin is shifted hops as a whole, which nobody feels.

mod blow;
mod clock;
mod curve;
mod hop;
mod poses;
mod sample;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use bevy_transform::components::Transform;

pub(crate) use blow::excess;
pub use clock::ClothFrameClock;
use clock::DEPTH;
pub(crate) use clock::FrameKind;
use hop::take_along;
pub use hop::{ClothHopDetector, ClothMotionTeleported};
pub use poses::ClothSampledPoses;
pub(crate) use poses::SampledPose;
pub(crate) use sample::{
    FixedLoopBegins, FixedLoopEnds, begin_fixed_step, end_fixed_step, pass_on_teleports,
    sample_motion, sample_parents, see_frame,
};

/// Number of steps without motion by the fixed loop after which an entity counts as moved between frames.
pub(crate) const LAPSE: u8 = 15;

/// Motion of an entity, as cloth sees it. On all entities that hold, carry, push or blow at cloth, and on their parents. See the
/// [module](self).
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothSampledMotion {
    /// Transforms in the last frames, the last one first.
    #[reflect(ignore)]
    frames: [Transform; DEPTH],
    /// Transform at the start of the step.
    #[reflect(ignore)]
    from: Transform,
    /// Transform at its end.
    #[reflect(ignore)]
    now: Transform,
    /// Transform when this step of the fixed loop began.
    #[reflect(ignore)]
    began: Transform,
    /// Number of steps for which translation, rotation and scale still count as moved by the fixed loop.
    fixed: [u8; 3],
    hops: ClothHopDetector,
    parent: Option<Entity>,
    frame: u64,
    step: u64,
    asked: bool,
    /// True if it hopped since the last step.
    hopped: bool,
    /// True if it was put elsewhere before this step.
    teleported: bool,
}

impl ClothSampledMotion {
    /// The entity is put elsewhere: wherever it goes until the next step carries what cloth it holds, and is not felt.
    pub fn teleport(&mut self) {
        self.asked = true;
    }

    /// The entity's own scale at both ends of the step.
    pub(crate) fn scales(&self) -> [Vec3; 2] {
        [self.from.scale, self.now.scale]
    }

    /// Begins to look at it: nothing of what was before is felt.
    fn restart(&mut self, place: &Transform, parent: Option<Entity>) {
        *self = Self {
            frames: [*place; DEPTH],
            from: *place,
            now: *place,
            began: *place,
            parent,
            frame: self.frame,
            step: self.step,
            asked: self.asked,
            ..Self::default()
        };
    }

    /// Takes what is known along where it was put elsewhere.
    fn take_along(&mut self, ends: [&Transform; 2]) {
        for frame in &mut self.frames {
            take_along(frame, ends);
        }
        take_along(&mut self.now, ends);
    }

    /// Motion from one frame to the next, without that of the fixed loop.
    fn moved_between(&self, [from, to]: [&Transform; 2]) -> Transform {
        let [translation, rotation, scale] = self.fixed.map(|steps| steps > 0);
        Transform {
            translation: if translation { from } else { to }.translation,
            rotation: if rotation { from } else { to }.rotation,
            scale: if scale { from } else { to }.scale,
        }
    }

    fn see(&mut self, place: &Transform, replaces: bool) {
        if !replaces {
            self.frames.rotate_right(1);
        }
        self.frames[0] = *place;
    }

    /// Notes which parts are others than when this step of the fixed loop began.
    fn note_moves(&mut self, place: &Transform) {
        for (fixed, moved) in self.fixed.iter_mut().zip([
            place.translation != self.began.translation,
            place.rotation != self.began.rotation,
            place.scale != self.began.scale,
        ]) {
            if moved {
                *fixed = LAPSE;
            }
        }
    }
}
