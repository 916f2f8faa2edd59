//! Numbers that are painted on a cloth.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;

/// For each particle, by its given number, a weight from 0 to 1 that was painted on the mesh: how firmly it is held.
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
    /// The weights of particles from those of vertices, given the particle of each vertex: the greatest counts. Weights that
    /// are not numbers count as 0.
    pub fn of_vertices(
        particles: usize,
        particle_of_vertex: &[u32],
        weight_of_vertex: &[f32],
    ) -> Self {
        let mut weights = vec![0.0f32; particles];
        for (&particle, &weight) in particle_of_vertex.iter().zip(weight_of_vertex) {
            if let Some(most) = weights.get_mut(particle as usize) {
                *most = most.max(weight);
            }
        }
        Self { weights }
    }

    /// The particles whose weight is above `threshold`, ascending.
    pub fn above(&self, threshold: f32) -> impl Iterator<Item = u32> + '_ {
        (0..)
            .zip(&self.weights)
            .filter_map(move |(i, weight)| (*weight > threshold).then_some(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_vertex_of_a_particle_can_hold_it() {
        let weights =
            ClothWeights::of_vertices(3, &[0, 1, 1, 2, 0, 9], &[0.2, 0.0, 0.9, f32::NAN, 0.4, 1.0]);
        assert_eq!(weights.weights, [0.4, 0.9, 0.0]);
        assert_eq!(weights.above(0.3).collect::<Vec<_>>(), [0, 1]);
    }
}
