//! Neighbours of particles: by an edge or a diagonal.

use std::ops::Deref;

use super::{alive::Family, layout::SheetLayout, order::Stored};

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
