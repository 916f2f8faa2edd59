//! Sheets.

use bevy_math::Vec2;

/// A sheet whose particles lie in columns and rows at equal spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Particles in a row.
    pub columns: u32,
    /// Particles in a column.
    pub rows: u32,
    /// Between neighbours of a row, and of a column \[m\].
    pub spacing: Vec2,
}
