//! Numbers that are painted on a cloth.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;

/// Weight from 0 to 1 of each particle, in original order, that was painted on the mesh: the firmness of its hold.
///
/// `ClothFromMesh` in the crate `tailorbird` fills it in from vertex colours or an attribute; the greatest of the vertices of a
/// particle counts. It holds nothing by itself: [`ClothPins::painted`](crate::pins::ClothPins::painted) makes pins of it.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothWeights {
    /// The weights [-], one for each particle.
    pub weights: Vec<f32>,
}

impl ClothWeights {
    /// The particles whose weight is above `threshold`, ascending.
    pub fn above(&self, threshold: f32) -> impl Iterator<Item = u32> + '_ {
        (0..)
            .zip(&self.weights)
            .filter_map(move |(i, weight)| (*weight > threshold).then_some(i))
    }
}
