//! Topology of a cloth: computed once from the rest shape, and shared.

use std::{ops::Deref, sync::Arc};

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;

pub use tailorbird_solver::topology::*;

/// The [`Topology`] of this cloth, shared. Written by [`build_topology`](crate::build::build_topology) alone; empty until then.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTopology(#[reflect(ignore)] pub(crate) Arc<Topology>);

impl Deref for ClothTopology {
    type Target = Topology;

    fn deref(&self) -> &Topology {
        &self.0
    }
}
