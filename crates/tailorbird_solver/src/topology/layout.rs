//! The two kinds of cloth that the solver knows.

use super::{
    alive::{AliveEdges, Family},
    fabric::Fabric,
    lattice::Lattice,
};
use crate::memory::Memory;

/// Layout of the particles of a cloth, and the constraints between them.
#[derive(Clone, Debug)]
pub enum Layout {
    /// In columns and rows at equal spacing: nothing is stored of edges, diagonals and threads, and of hinges only where the sheet is
    /// not flat at rest.
    Sheet(SheetLayout),
    /// Anywhere, joined by chains along warp and weft, and by shear.
    Mesh(Box<Fabric>),
}

/// Columns and rows of particles.
#[derive(Clone, Debug)]
pub struct SheetLayout {
    /// Number of columns and rows, and their spacing.
    pub lattice: Lattice,
    /// The edges that are whole, where some are torn.
    pub alive: Option<AliveEdges>,
}

impl From<Lattice> for SheetLayout {
    fn from(lattice: Lattice) -> Self {
        Self {
            lattice,
            alive: None,
        }
    }
}

impl Default for Layout {
    /// A mesh without particles.
    fn default() -> Self {
        Self::Mesh(Box::default())
    }
}

impl Memory for Layout {
    fn memory_bytes(&self) -> usize {
        match self {
            Self::Sheet(sheet) => sheet.alive.as_ref().map_or(0, AliveEdges::memory_bytes),
            Self::Mesh(fabric) => fabric.memory_bytes(),
        }
    }
}

impl SheetLayout {
    /// The particles at the ends of the whole edges along rows, then of those along columns.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let is_alive = |&[a, b]: &[u32; 2]| {
            let family = if b == a + 1 {
                Family::Row
            } else {
                Family::Column
            };
            self.is_alive(family, a)
        };
        self.lattice.edges().filter(is_alive)
    }

    /// Returns whether the edge that begins at a particle is whole.
    pub fn is_alive(&self, family: Family, particle: u32) -> bool {
        let is_alive = |alive: &AliveEdges| alive.is_alive(family, particle);
        self.alive.as_ref().is_none_or(is_alive)
    }
}
