//! Collision layers of cloths and colliders.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_solver::contact::colliders::Layers;

/// Collision layers: a cloth and a collider interact if each one's memberships share a bit with the other's filters. Optional on both; an
/// entity without them meets everything that wants to meet it.
///
/// ```
/// # use tailorbird_cloth::prelude::*;
/// const BODY: u32 = 1 << 0;
/// const PROPS: u32 = 1 << 1;
/// let cape = ClothLayers::new(u32::MAX, BODY);
/// let chair = ClothLayers::new(PROPS, u32::MAX);
/// assert!(!cape.interacts_with(chair));
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothLayers {
    /// Layers of its own, a bit each.
    pub memberships: u32,
    /// Layers that it meets, a bit each.
    pub filters: u32,
}

impl Default for ClothLayers {
    fn default() -> Self {
        Self::ALL
    }
}

impl ClothLayers {
    /// Membership in all layers, meeting all.
    pub const ALL: Self = Self::new(u32::MAX, u32::MAX);

    /// Creates layers from memberships and filters.
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self {
            memberships,
            filters,
        }
    }

    /// Returns whether the two meet.
    pub const fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }

    /// Layers in the form of the solver.
    pub(crate) const fn layers(self) -> Layers {
        Layers {
            memberships: self.memberships,
            filters: self.filters,
        }
    }
}
