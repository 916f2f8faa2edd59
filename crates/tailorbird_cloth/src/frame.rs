//! The rigid frame that a cloth's particles live in.
//!
//! ![A banner on a boat that pitches and rolls](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/banner.gif)

mod prepare;
mod split;

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3, Vec3A};
use bevy_reflect::prelude::*;
use tailorbird_solver::frame::Frame;

pub use prepare::{advance_frames, prepare_frames};
pub(crate) use split::split;
pub use split::split_mirrored;

use crate::{
    inertia::{ClothInertia, ClothTeleportMode},
    sampling::excess,
};

/// The rigid frame that a cloth's particles live in: translation and rotation of the entity. Scale is part of the rest
/// shape instead.
///
/// If the entity moves, the frame moves with it, evenly over the substeps, and pins with the frame. Free particles
/// keep their place in the world: they are expressed in the moved frame. So a cloth far from the world's origin is
/// as precise as one at it.
#[derive(Component, Clone, Copy, Debug, Reflect)]
#[reflect(Component, Default)]
pub struct ClothFrame {
    /// Pose, and path in this step.
    pub(crate) frame: Frame,
    pub(crate) scale: Vec3,
    pub(crate) placed: bool,
    /// The last valid one.
    inertia: ClothInertia,
    /// Part of the velocity in the last step that was felt [m/s].
    velocity: Vec3,
    /// True if the cloth goes where its entity goes, and feels nothing of it.
    pub(crate) carries: bool,
    asked: Option<ClothTeleportMode>,
    teleported: Option<ClothTeleportMode>,
}

impl Default for ClothFrame {
    fn default() -> Self {
        Self {
            frame: Frame::default(),
            scale: Vec3::ONE,
            placed: false,
            inertia: ClothInertia::default(),
            velocity: Vec3::ZERO,
            carries: false,
            asked: None,
            teleported: None,
        }
    }
}

impl Deref for ClothFrame {
    type Target = Frame;

    fn deref(&self) -> &Frame {
        &self.frame
    }
}

impl ClothFrame {
    /// The entity's scale, which is part of the rest shape.
    pub fn scale(&self) -> Vec3 {
        self.scale
    }

    /// The entity is put elsewhere, and its cloth with it: wherever the entity goes until the next step, the cloth does not
    /// feel it. So with its parents, and with whatever else hangs on those.
    /// [`ClothTeleported`](crate::inertia::ClothTeleported) tells when that is done. What holds the cloth without being a parent is told by
    /// [`ClothSampledMotion::teleport`](crate::sampling::ClothSampledMotion::teleport).
    pub fn teleport(&mut self, mode: ClothTeleportMode) {
        self.asked = Some(mode);
    }

    /// Returns whether [`Self::teleport`] was called since the last step.
    pub(crate) fn is_asked(&self) -> bool {
        self.asked.is_some()
    }

    /// Teleport of the cloth in this step, if there was one.
    pub(crate) fn take_teleport(&mut self) -> Option<ClothTeleportMode> {
        self.teleported.take()
    }

    /// Start of the step for a holder: a cloth that its entity carries was put elsewhere with it, whatever its holder did.
    pub(crate) fn start_for(&self, start: Isometry3d, end: Isometry3d) -> Isometry3d {
        match self.frame.jump {
            Some(jump) if self.carries => jump * start,
            _ => self.start_of(start, end),
        }
    }

    /// Takes over a scale that differs by more than the rounding of a scale that is read back from a rotated matrix.
    fn set_scale(&mut self, scale: Vec3) {
        const ROUNDING: f32 = 1e-5;
        let most = ROUNDING * scale.abs().max_element();
        if !self.placed || !scale.abs_diff_eq(self.scale, most) {
            self.scale = scale;
        }
    }

    /// Goes from one place to another within a step of this length \[s\], for the world and for the cloth; infinite where the cloth
    /// does not simulate. `holds` is whether it holds the cloth. What it is from where the last step ended to where this one starts carries the cloth.
    fn place(
        &mut self,
        [from, to]: [Isometry3d; 2],
        (teleported, holds): (bool, bool),
        seconds: [f32; 2],
    ) {
        let [world_seconds, seconds] = seconds;
        let inertia = self.inertia;
        let seen = if self.placed { self.frame.end } else { to };
        (self.frame.start, self.frame.end) = (if self.placed { from } else { to }, to);
        self.placed = true;
        self.frame.taken = None;
        let asked = self.asked.take();
        let far = from != to && inertia.is_teleport(from, to, world_seconds);
        let mode = asked.or_else(|| (far || teleported).then_some(inertia.teleport));
        if mode.is_some() {
            self.teleported = mode;
        }
        if asked.is_some() || far || self.carries || world_seconds.is_infinite() {
            self.frame.start = to;
        }
        if world_seconds.is_finite() {
            let turn = self.frame.start.rotation * seen.rotation.inverse();
            // What is carried has its velocity all the same.
            let began = if self.carries { from } else { self.frame.start };
            let displacement = Vec3::from(to.translation - began.translation);
            let (excess, velocity) = excess(turn * self.velocity, displacement, world_seconds);
            let holds = holds && !self.carries;
            self.velocity = if asked.is_some() || far {
                turn * self.velocity
            } else if holds {
                velocity
            } else {
                displacement / world_seconds
            };
            if holds && self.frame.start != to {
                self.frame.start.translation += Vec3A::from(excess);
            }
        }
        self.frame.jump = (self.frame.start != seen).then(|| self.frame.start * seen.inverse());
        self.frame.felt = inertia.felt(self.frame.start, to, world_seconds, seconds);
        self.frame.current = self.frame.start;
        self.frame.offset = Vec3::ZERO;
    }
}
