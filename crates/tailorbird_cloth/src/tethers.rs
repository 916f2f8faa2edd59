//! Tethers from every particle to up to four pins, or other particles that are held.

mod build;

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_solver::tethers::Tethers;

pub use build::build_tethers;

/// Geodesic distances of each particle from up to four of the pins, along the sheet at rest. In storage order. Written by [`build_tethers`]
/// alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTethers(#[reflect(ignore)] pub(crate) Tethers);

impl Deref for ClothTethers {
    type Target = Tethers;

    fn deref(&self) -> &Tethers {
        &self.0
    }
}
