//! A cloth in somebody's hand.

mod apply;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

pub use apply::apply_grab;

/// A cloth in somebody's hand: one particle is moved to a point of the world, its neighbours are pulled along, less
/// and less with distance.
///
/// The held particle follows as far as the cloth does: it never gets further from a neighbour than
/// [`ClothGrab::MOST_STRETCH`] times their distance at rest, so that pulling a pinned cloth draws no spike.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothGrab {
    held: Option<Hand>,
}

#[derive(Clone, Debug, PartialEq, Reflect)]
struct Hand {
    particle: u32,
    radius: f32,
    target: Vec3,
    /// Set by [`apply_grab`] when the hand closes: who is pulled along, with which weight, where from the particle.
    patch: Option<Vec<(u32, f32, Vec3)>>,
    revision: u64,
}

impl ClothGrab {
    /// Largest distance of the held particle from a neighbour, as a multiple of their distance at rest.
    pub const MOST_STRETCH: f32 = tailorbird_solver::hand::MOST_STRETCH;

    /// Takes a particle, and those within `radius` \[m\] along the sheet (its direct neighbours at least). `target` is
    /// where it is to be, in the world \[m\].
    pub fn take(&mut self, particle: u32, radius: f32, target: Vec3) {
        self.held = Some(Hand {
            particle,
            radius,
            target,
            patch: None,
            revision: 0,
        });
    }

    /// Moves the hand to a point of the world \[m\].
    pub fn move_to(&mut self, target: Vec3) {
        if let Some(hand) = &mut self.held {
            hand.target = target;
        }
    }

    /// Lets go.
    pub fn release(&mut self) {
        self.held = None;
    }

    /// The particle in the hand.
    pub fn particle(&self) -> Option<u32> {
        self.held.as_ref().map(|hand| hand.particle)
    }

    /// Position of the hand in the world \[m\].
    pub fn target(&self) -> Option<Vec3> {
        self.held.as_ref().map(|hand| hand.target)
    }

    /// The particles in the hand: the one that is held, then those that are pulled along (from the first step on).
    pub fn particles(&self) -> impl Iterator<Item = u32> + '_ {
        let patch = self
            .held
            .iter()
            .flat_map(|hand| hand.patch.iter().flatten());
        self.particle()
            .into_iter()
            .chain(patch.map(|(particle, ..)| *particle))
    }
}
