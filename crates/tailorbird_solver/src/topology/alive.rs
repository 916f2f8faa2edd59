//! Edges of a sheet that are not torn.

use crate::memory_bytes;

use super::lattice::Lattice;

/// The families of a sheet's edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// From a particle to the next one of its row.
    Row,
    /// From a particle to the next one of its column.
    Column,
    /// From a particle to the next one of the next row.
    Falling,
    /// From a particle to the one before in the next row.
    Rising,
}

/// One bit for each edge of a sheet: whether it is whole. A sheet of which nothing is torn has none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AliveEdges {
    /// By family; the bit of an edge is that of its first particle.
    bits: [Vec<u64>; 4],
}

memory_bytes!(AliveEdges: bits);

impl AliveEdges {
    /// Edges of a sheet of which nothing is torn.
    pub fn all(lattice: &Lattice) -> Self {
        let words = (lattice.columns as usize * lattice.rows as usize).div_ceil(64);
        Self {
            bits: [(); 4].map(|()| vec![u64::MAX; words]),
        }
    }

    /// Returns whether the edge that begins at a particle is whole.
    ///
    /// # Panics
    /// When the particle is out of range.
    pub fn is_alive(&self, family: Family, particle: u32) -> bool {
        let (word, bit) = place(particle);
        self.bits[family as usize][word] & bit != 0
    }

    /// Marks the edge that begins at a particle as torn. Returns whether it was whole.
    ///
    /// # Panics
    /// When the particle is out of range.
    pub fn tear(&mut self, family: Family, particle: u32) -> bool {
        let (word, bit) = place(particle);
        let was = self.is_alive(family, particle);
        self.bits[family as usize][word] &= !bit;
        was
    }
}

fn place(particle: u32) -> (usize, u64) {
    (particle as usize / 64, 1 << (particle % 64))
}
