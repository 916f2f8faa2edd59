//! Motion constraints: how far each particle gets from where an animation wants it. The basis of character cloth.
//!
//! Each particle has a target: its place at rest, or where [`ClothMotionTargets`] puts it in each step, such as where an
//! animated skeleton has it. [`ClothMotionConstraints`] says how far it may get from there:
//!
//! - **Maximum distance**: it stays within a ball around its target. 0 holds it there, as a pin does; infinity leaves it free.
//! - **Backstop**: it stays out of a ball behind its target, which stands for the body below the cloth. The ball's surface lies
//!   `backstop_distance` behind the target, against the target's normal, and the ball has a radius of `backstop_radius`.
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{UVec2, Vec2, Vec3};
//! # use tailorbird_cloth::prelude::*;
//! fn spawn_coat(mut commands: Commands) {
//!     let size = UVec2::new(40, 60);
//!     // Painted weights: the shoulders are held, the hem gets 0.5 m away.
//!     let weights = (0..size.element_product()).map(|i| (i / size.x) as f32 / (size.y - 1) as f32);
//!     commands.spawn((
//!         Cloth::grid(Vec2::new(0.8, 1.2), size),
//!         ClothMotionConstraints {
//!             max_distance: ClothPerParticle::weighted(weights, 0.5),
//!             ..ClothMotionConstraints::default()
//!         }
//!         .with_backstop(0.01, 0.3),
//!         ClothMotionTargets::default(),
//!     ));
//! }
//!
//! /// In a system that runs in `FixedUpdate`, before the cloth.
//! fn animate(mut coats: Query<&mut ClothMotionTargets>) {
//!     for mut targets in &mut coats {
//!         let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = skinned_vertices();
//!         targets.set(positions, normals);
//!     }
//! }
//! # fn skinned_vertices() -> (Vec<Vec3>, Vec<Vec3>) { Default::default() }
//! ```
//!
//! Targets move evenly over the substeps, from where they were at the start of the step to where they are set. Where none
//! are set in a step, they stay. Those that are set in `FixedUpdate` are taken as they are; those that are set once a frame, in `Update`
//! or `PostUpdate`, are sampled a frame late, between those of two frames ([`sampling`](crate::sampling)). Where the one that moves
//! furthest [hops](crate::sampling#hops), and where they were set while cloth did not simulate, each particle is taken along with its
//! target, and keeps the velocity that it has.
//!
//! The constraints hold after all others, before the colliders. A particle that is stopped loses the velocity with which it
//! would leave again: it rests at its limit. The maximum distance counts before the backstop; pins and attachments
//! count before both.

mod prepare;
mod samples;

use bevy_ecs::{change_detection::Tick, prelude::*};
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::{limits::MotionLimits, topology::order::Stored};

pub use prepare::prepare_motion;
pub(crate) use samples::{begin_fixed_targets, end_fixed_targets, see_targets};

use crate::{error::ClothErrorKind, sampling::ClothHopDetector};

/// A value for each particle of a cloth.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothPerParticle {
    /// One value for all particles.
    All(
        #[cfg_attr(
            feature = "serialize",
            serde(deserialize_with = "crate::unbounded::number")
        )]
        f32,
    ),
    /// One for each, in the order of [`Cloth::rest_positions`](crate::cloth::Cloth::rest_positions).
    Each(
        #[cfg_attr(
            feature = "serialize",
            serde(deserialize_with = "crate::unbounded::list")
        )]
        Vec<f32>,
    ),
}

impl ClothPerParticle {
    /// Weights, 0 to 1, times the value of weight 1. A weight of 0 is 0 whatever that is: infinity is no limit.
    pub fn weighted(weights: impl IntoIterator<Item = f32>, most: f32) -> Self {
        let value = |weight| if weight == 0.0 { 0.0 } else { weight * most };
        Self::Each(weights.into_iter().map(value).collect())
    }

    fn get(&self, i: usize) -> Option<f32> {
        match self {
            Self::All(value) => Some(*value),
            Self::Each(values) => values.get(i).copied(),
        }
    }

    /// Error of a list: in the number of values, or in a value that is not `ok`.
    fn error(
        &self,
        field: &str,
        particles: usize,
        ok: impl Fn(f32) -> bool,
        allowed: &str,
    ) -> Option<ClothErrorKind> {
        match self {
            Self::All(value) => ClothErrorKind::number(field, *value, ok, allowed),
            Self::Each(values) if values.len() != particles => Some(ClothErrorKind::Count {
                field: field.into(),
                value: values.len(),
                allowed: format!("one for each of {particles} particles"),
            }),
            Self::Each(values) => {
                let wrong = values.iter().position(|value| !ok(*value))?;
                let field = format!("{field}[{wrong}]");
                ClothErrorKind::number(&field, values[wrong], ok, allowed)
            }
        }
    }
}

impl From<f32> for ClothPerParticle {
    fn from(value: f32) -> Self {
        Self::All(value)
    }
}

impl From<Vec<f32>> for ClothPerParticle {
    fn from(values: Vec<f32>) -> Self {
        Self::Each(values)
    }
}

/// Largest distances of particles from their targets. See the [module](self).
///
/// Change it at any time. Errors are reported in [`ClothStatus`](crate::error::ClothStatus), and the last valid constraints stay in force.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
#[require(ClothMotionState)]
pub struct ClothMotionConstraints {
    /// Furthest from the target \[m\]. Infinity, the default, is free; 0 is held.
    pub max_distance: ClothPerParticle,
    /// Largest distance of a particle behind its target, against the normal \[m\]. Infinity, the default, is no backstop.
    pub backstop_distance: ClothPerParticle,
    /// Radius of the ball behind the target \[m\]. The larger, the more it is a plane. 1 by default.
    pub backstop_radius: ClothPerParticle,
}

impl Default for ClothMotionConstraints {
    fn default() -> Self {
        Self {
            max_distance: ClothPerParticle::All(f32::INFINITY),
            backstop_distance: ClothPerParticle::All(f32::INFINITY),
            backstop_radius: ClothPerParticle::All(1.0),
        }
    }
}

impl ClothMotionConstraints {
    /// No particle gets further from its target than this \[m\].
    pub fn at_most(max_distance: impl Into<ClothPerParticle>) -> Self {
        Self {
            max_distance: max_distance.into(),
            ..Self::default()
        }
    }

    /// With a backstop: how far behind the target it begins \[m\], and its radius \[m\].
    pub fn with_backstop(
        self,
        distance: impl Into<ClothPerParticle>,
        radius: impl Into<ClothPerParticle>,
    ) -> Self {
        Self {
            backstop_distance: distance.into(),
            backstop_radius: radius.into(),
            ..self
        }
    }

    /// Errors for a cloth of so many particles.
    pub fn errors(&self, particles: usize) -> Vec<ClothErrorKind> {
        let not_negative = |v: f32| v >= 0.0;
        let distance = |values: &ClothPerParticle, field| {
            values.error(field, particles, not_negative, "at least 0 [m]")
        };
        let radius = self.backstop_radius.error(
            "ClothMotionConstraints.backstop_radius",
            particles,
            |r| r > 0.0 && r.is_finite(),
            "above 0 and finite [m]",
        );
        [
            distance(&self.max_distance, "ClothMotionConstraints.max_distance"),
            distance(
                &self.backstop_distance,
                "ClothMotionConstraints.backstop_distance",
            ),
            radius,
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Space of the targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothTargetSpace {
    /// The cloth's [`ClothFrame`](crate::frame::ClothFrame): targets move with the entity.
    #[default]
    Frame,
    /// The world.
    World,
}

/// Positions that an animation wants for the particles at the end of the next step; rest positions without this component, and until they
/// are set. See the [module](self).
///
/// Errors are reported in [`ClothStatus`](crate::error::ClothStatus), and the targets stay where they are.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
#[require(ClothTargetSamples)]
pub struct ClothMotionTargets {
    space: ClothTargetSpace,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

impl ClothMotionTargets {
    /// Targets that will be given in this space.
    pub fn in_space(space: ClothTargetSpace) -> Self {
        Self {
            space,
            ..Self::default()
        }
    }

    /// Sets the targets: one position \[m\] for each particle, in the order of
    /// [`Cloth::rest_positions`](crate::cloth::Cloth::rest_positions). The normals point away from what is behind the cloth, and
    /// are needed for backstops alone; without any they are computed from the triangles.
    pub fn set(
        &mut self,
        positions: impl IntoIterator<Item = Vec3>,
        normals: impl IntoIterator<Item = Vec3>,
    ) {
        self.positions.clear();
        self.positions.extend(positions);
        self.normals.clear();
        self.normals.extend(normals);
    }

    /// Sets the positions; normals are computed from the triangles.
    pub fn set_positions(&mut self, positions: impl IntoIterator<Item = Vec3>) {
        self.set(positions, []);
    }

    /// Errors for a cloth of so many particles.
    pub fn errors(&self, particles: usize) -> Vec<ClothErrorKind> {
        let count = |values: &[Vec3], field: &str, allowed| {
            let wrong = values.len() != particles && !(allowed && values.is_empty());
            wrong.then(|| ClothErrorKind::Count {
                field: field.into(),
                value: values.len(),
                allowed: format!("one for each of {particles} particles"),
            })
        };
        let finite = |values: &[Vec3], field: &str| {
            let wrong = values.iter().position(|p| !p.is_finite())?;
            ClothErrorKind::vector(&format!("{field}[{wrong}]"), values[wrong])
        };
        let (positions, normals) = ("ClothMotionTargets positions", "ClothMotionTargets normals");
        [
            // None are set yet.
            count(&self.positions, positions, true),
            count(&self.normals, normals, true),
            finite(&self.positions, positions),
            finite(&self.normals, normals),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Motion constraints during a step, in storage order. Written by [`prepare_motion`] alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothMotionState {
    /// Largest distances of particles from their targets.
    #[reflect(ignore)]
    pub(crate) limits: MotionLimits,
    /// Particles whose largest distance is 0.
    #[reflect(ignore)]
    held: Vec<Stored>,
    /// True if the targets move in this step.
    moving: bool,
    disturbed: bool,
    /// Largest displacement of a target in this step \[m\].
    furthest: f32,
    /// Identity of the targets that they were aimed at.
    aimed: [u64; 3],
    hops: ClothHopDetector,
    /// True if a step was left out.
    idle: bool,
    /// Revision of the topology.
    #[reflect(ignore)]
    revision: u64,
}

/// Number of kept frames: enough if frames are about equally long.
const KEPT: usize = 4;

/// Targets of the last frames. Comes with [`ClothMotionTargets`].
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTargetSamples {
    /// The last one first; one for each frame in which they changed.
    #[reflect(ignore)]
    seen: [SeenTargets; KEPT],
    known: usize,
    versions: u64,
    #[reflect(ignore)]
    changed: Option<Tick>,
    /// When this step of the fixed loop began.
    #[reflect(ignore)]
    began: Option<Tick>,
    /// Number of steps for which they still count as moved by the fixed loop.
    fixed: u8,
    hops: ClothHopDetector,
    frame: u64,
    /// True if they were put elsewhere since the last step.
    jumped: bool,
}

#[derive(Clone, Debug, Default)]
struct SeenTargets {
    /// Number of the frame.
    number: u64,
    /// Different whenever it is set.
    version: u64,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_of_nothing_holds_where_others_have_no_limit() {
        let limits = ClothPerParticle::weighted([0.0, 0.5, 1.0], f32::INFINITY);
        let expected = vec![0.0, f32::INFINITY, f32::INFINITY];
        assert_eq!(limits, ClothPerParticle::Each(expected));
    }
}
