//! Springs between two particles, in batches that share no particle.

use std::ops::Range;

use bevy_math::Vec3;

use super::coloring::color;
use crate::memory_bytes;

/// Deformation that a spring resists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ConstraintFamily {
    /// Springs that skip a particle: bending.
    Bend,
    /// Diagonals: shear.
    Shear,
    /// Edges: stretch. Solved last, so that they are held best.
    Stretch,
}

impl ConstraintFamily {
    /// All families, in the order in which they are solved.
    pub const ALL: [Self; 3] = [Self::Bend, Self::Shear, Self::Stretch];
}

/// A run of constraints of one family, no two of which share a particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Family of all its constraints.
    pub family: ConstraintFamily,
    /// Range of its constraints.
    pub range: Range<usize>,
}

/// Springs between two particles, as parallel arrays.
#[derive(Clone, Debug, Default)]
pub struct DistanceConstraints {
    /// Particles at the ends.
    pub ends: Vec<[u32; 2]>,
    /// Distance at rest \[m\].
    pub rest_lengths: Vec<f32>,
    /// All constraints, in the order in which they are solved.
    pub batches: Vec<Batch>,
}

memory_bytes!(DistanceConstraints: ends, rest_lengths, batches);

impl DistanceConstraints {
    /// The number of constraints.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Ends and rest lengths of one family.
    pub fn family(
        &self,
        family: ConstraintFamily,
    ) -> impl Iterator<Item = ([u32; 2], f32)> + Clone + '_ {
        self.batches
            .iter()
            .filter(move |batch| batch.family == family)
            .flat_map(|batch| batch.range.clone())
            .map(|k| (self.ends[k], self.rest_lengths[k]))
    }

    /// Appends a batch, whose pairs must share no particle.
    pub(super) fn push_batch(
        &mut self,
        family: ConstraintFamily,
        rest_positions: &[Vec3],
        pairs: impl IntoIterator<Item = [u32; 2]>,
    ) {
        let start = self.ends.len();
        self.ends.extend(pairs);
        self.rest_lengths.extend(
            self.ends[start..]
                .iter()
                .map(|&[a, b]| rest_positions[a as usize].distance(rest_positions[b as usize])),
        );
        let range = start..self.ends.len();
        if !range.is_empty() {
            self.batches.push(Batch { family, range });
        }
    }

    /// Appends pairs that may share particles, sorted into batches.
    pub(super) fn push_colored(
        &mut self,
        family: ConstraintFamily,
        rest_positions: &[Vec3],
        pairs: &[[u32; 2]],
    ) {
        for batch in color(pairs, rest_positions.len()) {
            let batch = batch.into_iter().map(|k| pairs[k as usize]);
            self.push_batch(family, rest_positions, batch);
        }
    }
}
