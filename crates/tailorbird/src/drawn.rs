//! Draws what is held where its holder is drawn.
//!
//! Cloth is drawn between its last two steps, and so up to a step late; a bone that is animated in each frame is drawn where it is
//! now. A cape would be seen to lag behind its shoulders by as much. So whoever writes the mesh moves the particles that are
//! attached rigidly to the places that their points have now, and those around them along, less and less with the distance along
//! the sheet. The simulation knows nothing of it. Where all that holds it was put elsewhere since the last step, the whole cloth is drawn
//! there.
//!
//! [`ClothDrawnHolds`] keeps who moves along how much, and computes by how much each particle is drawn elsewhere:
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::Vec3;
//! # use bevy_transform::components::GlobalTransform;
//! # use tailorbird::{drawn::ClothDrawnHolds, prelude::*};
//! # use tailorbird_cloth::{attachment::ClothAttachedParticles, topology::order::Stored};
//! fn write_mesh(
//!     mut cloths: Query<(
//!         &GlobalTransform, &ClothTopology, &ClothParticles, &ClothAttachedParticles, &mut ClothDrawnHolds,
//!     )>,
//!     places: Query<&GlobalTransform>,
//! ) {
//!     let fraction = 0.5; // That of `Time<Fixed>`.
//!     for (place, topology, particles, attached, mut drawn) in &mut cloths {
//!         let now = |target| places.get(target).ok().copied();
//!         drawn.update(topology, particles, attached, place, fraction, now);
//!         for i in (0..particles.len() as u32).map(Stored) {
//!             let _drawn_at: Vec3 = particles.interpolated(i, fraction) + drawn.offset(i);
//!         }
//!     }
//! }
//! ```

use std::{cmp::Ordering, collections::BinaryHeap};

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::{
    attachment::ClothAttachedParticles,
    frame::split_mirrored,
    particles::ClothParticles,
    topology::{
        Topology,
        order::{Given, Stored},
    },
};
use tailorbird_solver::points::Points;

/// Motion of a cloth's particles along with its holders when it is drawn. See the [module](self).
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothDrawnHolds {
    /// Of the topology and of what is attached.
    revisions: [u64; 2],
    targets: Vec<Entity>,
    #[reflect(ignore)]
    held: Vec<Held>,
    #[reflect(ignore)]
    weights: Vec<Weight>,
    /// In storage order, in the cloth's frame \[m\]; empty where all are drawn where they are.
    #[reflect(ignore)]
    offsets: Points,
    /// Motion of each target from the time for which the cloth is drawn to the present one, in the cloth's frame.
    #[reflect(ignore)]
    motions: Vec<Option<Isometry3d>>,
}

/// A particle that is drawn at a point of a target.
#[derive(Clone, Copy, Debug)]
struct Held {
    particle: Stored,
    target: u32,
    /// In the target's own space \[m\].
    point: Vec3,
}

/// A free particle that moves along.
#[derive(Clone, Copy, Debug)]
struct Weight {
    particle: Stored,
    target: u32,
    /// Random number from 0 to 1.
    weight: f32,
}

impl ClothDrawnHolds {
    /// Distance along the sheet within which particles move along, as a part of the side of a square of the cloth's area [-].
    pub const REACH: f32 = 0.6;

    /// By how much a particle is drawn elsewhere, in the cloth's frame \[m\].
    #[inline]
    pub fn offset(&self, particle: Stored) -> Vec3 {
        let i = particle.index();
        if i < self.offsets.len() {
            self.offsets.get(i)
        } else {
            Vec3::ZERO
        }
    }

    /// The offsets of all particles in storage order; none where all are drawn where they are.
    #[cfg(feature = "render")]
    pub(crate) fn offsets(&self) -> Option<&Points> {
        (!self.is_still()).then_some(&self.offsets)
    }

    /// Returns whether all particles are drawn where they are.
    pub fn is_still(&self) -> bool {
        self.offsets.is_empty()
    }

    /// Computes the offsets of a cloth that is drawn at `place`, at a part of the time between the last two steps, 0 to 1.
    /// `now` tells where a target is drawn. Targets and cloths that are nowhere move nothing.
    pub fn update(
        &mut self,
        topology: &Topology,
        particles: &ClothParticles,
        attached: &ClothAttachedParticles,
        place: &GlobalTransform,
        fraction: f32,
        now: impl Fn(Entity) -> Option<GlobalTransform>,
    ) {
        let revisions = [topology.revision, attached.revision()];
        if self.revisions != revisions {
            self.revisions = revisions;
            self.weigh(topology, particles, attached);
        }
        self.offsets.clear();
        let Ok((frame, _)) = split_mirrored(place, topology.scale) else {
            return;
        };
        if self.held.is_empty() || particles.len() != topology.particles() {
            return;
        }
        self.offsets.resize(particles.len(), 0.0);
        self.motions.clear();
        self.motions.resize(self.targets.len(), None);
        for (k, target) in self.targets.iter().enumerate() {
            let Some(transform) = now(*target).filter(|at| at.affine().is_finite()) else {
                continue;
            };
            let held = self.held.iter().filter(|held| held.target == k as u32);
            for held in held {
                let i = held.particle.index();
                let world = transform.affine().transform_point3a(held.point.into());
                let there = frame.rotation.inverse() * Vec3::from(world - frame.translation);
                self.offsets
                    .set(i, there - particles.interpolated(held.particle, fraction));
            }
            self.motions[k] = attached.motion(*target, &transform, frame, fraction);
        }
        if self.all_leap() {
            self.draw_along(particles, fraction);
            return;
        }
        for weight in &self.weights {
            if let Some(motion) = self.motions[weight.target as usize] {
                let from = particles.interpolated(weight.particle, fraction);
                let i = weight.particle.index();
                self.offsets.add(i, (motion * from - from) * weight.weight);
            }
        }
    }

    /// Returns whether all held particles are drawn so far from their places that they were put elsewhere, and the cloth has not stepped
    /// since.
    fn all_leap(&self) -> bool {
        /// Further than anything runs in the time that cloth is late \[m\].
        const LEAP: f32 = 1.0;
        let offset = |held: &Held| self.offsets.get(held.particle.index());
        self.motions.iter().all(Option::is_some)
            && self.held.iter().all(|held| offset(held).length() > LEAP)
    }

    /// Draws the whole cloth along with its first target.
    fn draw_along(&mut self, particles: &ClothParticles, fraction: f32) {
        let Some(motion) = self.motions.first().copied().flatten() else {
            return;
        };
        let held: Vec<(usize, Vec3)> = self
            .held
            .iter()
            .map(|held| held.particle.index())
            .map(|i| (i, self.offsets.get(i)))
            .collect();
        for i in 0..particles.len() {
            let from = particles.interpolated(Stored(i as u32), fraction);
            self.offsets.set(i, motion * from - from);
        }
        for (i, offset) in held {
            self.offsets.set(i, offset);
        }
    }

    /// Finds who moves along.
    fn weigh(
        &mut self,
        topology: &Topology,
        particles: &ClothParticles,
        attached: &ClothAttachedParticles,
    ) {
        self.targets.clear();
        self.held.clear();
        self.weights.clear();
        for point in attached.rigid() {
            let known = self.targets.iter().position(|t| *t == point.target);
            let target = known.unwrap_or_else(|| {
                self.targets.push(point.target);
                self.targets.len() - 1
            });
            self.held.push(Held {
                particle: particles.order().stored(Given(point.particle)),
                target: target as u32,
                point: point.point,
            });
        }
        let count = topology.particles();
        let area = topology.cell_area() * count as f32;
        let reach = Self::REACH * area.sqrt();
        let lengths: Vec<Vec<f32>> = (0..self.targets.len() as u32)
            .map(|k| {
                let held = self.held.iter().filter(|held| held.target == k);
                path_lengths(topology, held.map(|held| held.particle), reach)
            })
            .collect();
        let mut fixed = vec![false; count];
        let pins = particles
            .pinned()
            .map(|i| particles.order().stored(Given(i as u32)));
        for i in pins.chain(self.held.iter().map(|held| held.particle)) {
            if let Some(fixed) = fixed.get_mut(i.index()) {
                *fixed = true;
            }
        }
        for particle in (0..count).filter(|&i| !fixed[i]) {
            let all: f32 = lengths.iter().map(|to| to[particle].powi(-2)).sum();
            for (k, to) in lengths.iter().enumerate() {
                let q = to[particle] / reach;
                if q < 1.0 {
                    // Between several targets the nearer one counts more; 1 at a target, 0 with no kink at the end.
                    let share = to[particle].powi(-2) / all;
                    self.weights.push(Weight {
                        particle: Stored(particle as u32),
                        target: k as u32,
                        weight: share * (1.0 - q * q) * (1.0 - q * q),
                    });
                }
            }
        }
    }
}

/// A particle that a path leads to.
#[derive(Clone, Copy, PartialEq)]
struct Reached {
    path_length: f32,
    particle: Stored,
}

impl Eq for Reached {}

impl Ord for Reached {
    /// The nearest is the greatest.
    fn cmp(&self, other: &Self) -> Ordering {
        let nearest = other.path_length.total_cmp(&self.path_length);
        nearest.then(other.particle.cmp(&self.particle))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Distance along edges and diagonals from the nearest of some particles to each one \[m\] (Dijkstra); infinite beyond `reach` \[m\].
fn path_lengths(topology: &Topology, from: impl Iterator<Item = Stored>, reach: f32) -> Vec<f32> {
    let rest = &topology.rest_positions;
    let mut lengths = vec![f32::INFINITY; rest.len()];
    let mut next = BinaryHeap::new();
    for particle in from.filter(|i| i.index() < rest.len()) {
        lengths[particle.index()] = 0.0;
        next.push(Reached {
            path_length: 0.0,
            particle,
        });
    }
    while let Some(Reached {
        path_length,
        particle,
    }) = next.pop()
    {
        if path_length > lengths[particle.index()] {
            continue;
        }
        for &to in topology.neighbors(particle).iter() {
            let further = path_length + rest[to.index()].distance(rest[particle.index()]);
            if further < lengths[to.index()] && further < reach {
                lengths[to.index()] = further;
                next.push(Reached {
                    path_length: further,
                    particle: to,
                });
            }
        }
    }
    lengths
}
