//! Forces from outside.

mod apply;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

pub use apply::apply_forces;

use crate::error::ClothErrorKind;

/// Forces that a game puts on a cloth. They act during the next step and are forgotten after it, so what lasts is
/// added in each step (in `FixedUpdate`, say).
///
/// Everything is in world axes. Pinned particles do not feel them.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothForces {
    forces: Vec<(u32, Vec3)>,
    accelerations: Vec<(u32, Vec3)>,
    impulses: Vec<Impulse>,
}

#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
struct Impulse {
    point: Vec3,
    impulse: Vec3,
    radius: f32,
}

impl Impulse {
    fn error(&self) -> Option<ClothErrorKind> {
        ClothErrorKind::vector("ClothForces.impulse", self.impulse)
            .or_else(|| ClothErrorKind::vector("ClothForces.impulse point", self.point))
            .or_else(|| ClothErrorKind::limit("ClothForces.impulse radius", self.radius, "m"))
    }
}

impl ClothForces {
    /// Pushes a particle with a force \[N\] for one step.
    pub fn add_force(&mut self, particle: u32, force: Vec3) {
        self.forces.push((particle, force));
    }

    /// Accelerates a particle [m/s²] for one step, whatever its mass.
    pub fn add_acceleration(&mut self, particle: u32, acceleration: Vec3) {
        self.accelerations.push((particle, acceleration));
    }

    /// Gives an impulse [N s] at a point of the world \[m\]: shared among the free particles within `radius` \[m\] of it,
    /// most to the nearest; all to the nearest one where none is as near.
    pub fn add_impulse_at_point(&mut self, impulse: Vec3, point: Vec3, radius: f32) {
        self.impulses.push(Impulse {
            point,
            impulse,
            radius,
        });
    }

    /// Returns whether no force acts.
    pub fn is_empty(&self) -> bool {
        self.forces.is_empty() && self.accelerations.is_empty() && self.impulses.is_empty()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.forces.clear();
        self.accelerations.clear();
        self.impulses.clear();
    }
}
