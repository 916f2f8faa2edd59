//! Neighbours of particles: by an edge or a diagonal.

use std::ops::Deref;

use super::{alive::Family, layout::SheetLayout, order::Stored};
use crate::memory::heap;

/// Particles that are joined to a particle by an edge or a diagonal.
#[derive(Clone, Copy, Debug)]
pub enum Neighbors<'a> {
    /// Neighbours of a particle of a lattice: up to eight.
    Around([Stored; 8], usize),
    /// Neighbours of a particle of a mesh.
    Listed(&'a [Stored]),
}

impl Deref for Neighbors<'_> {
    type Target = [Stored];

    fn deref(&self) -> &[Stored] {
        match self {
            Self::Around(particles, count) => &particles[..*count],
            Self::Listed(particles) => particles,
        }
    }
}

impl Neighbors<'_> {
    /// Neighbours of a particle of a sheet by whole edges; none where it is out of range.
    pub(super) fn in_sheet(sheet: &SheetLayout, particle: Stored) -> Self {
        const AROUND: [((i64, i64), Family); 8] = [
            ((1, 0), Family::Row),
            ((-1, 0), Family::Row),
            ((0, 1), Family::Column),
            ((0, -1), Family::Column),
            ((1, 1), Family::Falling),
            ((-1, -1), Family::Falling),
            ((-1, 1), Family::Rising),
            ((1, -1), Family::Rising),
        ];
        let lattice = &sheet.lattice;
        let (columns, rows) = (i64::from(lattice.columns), i64::from(lattice.rows));
        let particle = particle.0;
        let (column, row) = (i64::from(particle) % columns, i64::from(particle) / columns);
        let (mut particles, mut count) = ([Stored(0); 8], 0);
        for ((dx, dy), family) in AROUND {
            let (x, y) = (column + dx, row + dy);
            if row < rows && (0..columns).contains(&x) && (0..rows).contains(&y) {
                let other = (y * columns + x) as u32;
                // The first end of an edge comes first.
                if sheet.is_alive(family, particle.min(other)) {
                    particles[count] = Stored(other);
                    count += 1;
                }
            }
        }
        Self::Around(particles, count)
    }
}

/// For each particle of a mesh the particles at the other ends of its edges.
#[derive(Clone, Debug, Default)]
pub(super) struct NeighborLists {
    /// Start of the list of each particle in `particles`; one more than there are particles.
    offsets: Vec<u32>,
    particles: Vec<Stored>,
}

impl NeighborLists {
    pub(super) fn new(particles: usize, edges: impl Iterator<Item = [u32; 2]> + Clone) -> Self {
        let mut offsets = vec![0u32; particles + 1];
        for [a, b] in edges.clone() {
            offsets[a as usize + 1] += 1;
            offsets[b as usize + 1] += 1;
        }
        for i in 0..particles {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut list = vec![Stored(0); offsets[particles] as usize];
        for [a, b] in edges {
            for (from, to) in [(a, b), (b, a)] {
                list[next[from as usize] as usize] = Stored(to);
                next[from as usize] += 1;
            }
        }
        Self {
            offsets,
            particles: list,
        }
    }

    /// Neighbours of one particle; none where the particle is out of range.
    pub(super) fn of(&self, particle: Stored) -> &[Stored] {
        let i = particle.index();
        match (self.offsets.get(i), self.offsets.get(i + 1)) {
            (Some(&start), Some(&end)) => &self.particles[start as usize..end as usize],
            _ => &[],
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        heap(&self.offsets) + heap(&self.particles)
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::Vec2;

    use super::{super::lattice::Lattice, *};

    #[test]
    fn those_in_a_lattice_are_the_ones_around() {
        let lattice = Lattice {
            columns: 4,
            rows: 3,
            spacing: Vec2::ONE,
        };
        let sorted = |particle| {
            let around = Neighbors::in_sheet(&lattice.into(), Stored(particle));
            let mut around: Vec<u32> = around.iter().map(|i| i.0).collect();
            around.sort_unstable();
            around
        };
        assert_eq!(sorted(0), [1, 4, 5]);
        assert_eq!(sorted(5), [0, 1, 2, 4, 6, 8, 9, 10]);
        assert_eq!(sorted(11), [6, 7, 10]);
        assert_eq!(sorted(12), [0; 0]);
    }
}
