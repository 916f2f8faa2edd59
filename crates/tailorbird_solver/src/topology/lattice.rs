//! Sheets: particles in columns and rows at equal spacing.

use bevy_math::Vec2;

/// A sheet whose particles lie in columns and rows at equal spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Particles in a row.
    pub columns: u32,
    /// Particles in a column.
    pub rows: u32,
    /// Distance of neighbours in a row, and in a column \[m\].
    pub spacing: Vec2,
}

impl Lattice {
    /// Area of a cell \[m²\].
    pub fn cell_area(&self) -> f32 {
        self.spacing.x * self.spacing.y
    }

    /// Area of a particle: a quarter of the cells around it \[m²\].
    pub fn area_of(&self, particle: usize) -> f32 {
        let (columns, rows) = (self.columns as usize, self.rows as usize);
        let beside = |at: usize, len: usize| if at == 0 || at + 1 == len { 1.0 } else { 2.0 };
        let around = beside(particle % columns, columns) * beside(particle / columns, rows);
        0.25 * self.cell_area() * around
    }

    /// Particles at the ends of the edges along rows, then of those along columns.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let Self { columns, rows, .. } = *self;
        let along = move |last_column, last_row, step| {
            (0..last_row).flat_map(move |row| {
                (0..last_column).map(move |column| {
                    let i = row * columns + column;
                    [i, i + step]
                })
            })
        };
        along(columns - 1, rows, 1).chain(along(columns, rows - 1, columns))
    }
}
