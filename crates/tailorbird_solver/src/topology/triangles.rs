//! Triangles of a cloth: a list, or the cells of a grid, which need none.

use bevy_math::UVec2;

/// Particles at the corners of each triangle of a cloth, counter-clockwise seen from the front.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a>(Source<'a>);

#[derive(Clone, Copy, Debug)]
enum Source<'a> {
    List(&'a [[u32; 3]]),
    Grid(UVec2),
}

impl<'a> Triangles<'a> {
    pub(super) fn of_list(list: &'a [[u32; 3]]) -> Self {
        Self(Source::List(list))
    }

    /// Triangles of a grid of so many columns and rows, at least 2 each.
    pub(super) fn of_grid(size: UVec2) -> Self {
        Self(Source::Grid(size))
    }

    /// Number of triangles.
    #[inline]
    pub fn len(self) -> usize {
        match self.0 {
            Source::List(list) => list.len(),
            Source::Grid(size) => (size.x as usize - 1) * (size.y as usize - 1) * 2,
        }
    }

    /// Returns whether there are none.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Corners of a triangle; `None` where it is out of range.
    #[inline]
    pub fn get(self, triangle: usize) -> Option<[u32; 3]> {
        match self.0 {
            Source::List(list) => list.get(triangle).copied(),
            Source::Grid(size) => (triangle < self.len()).then(|| of_cell(size, triangle as u32)),
        }
    }

    /// All triangles, in order.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = [u32; 3]> + Clone + use<'a> {
        (0..self.len()).map(move |triangle| match self.0 {
            Source::List(list) => list[triangle],
            Source::Grid(size) => of_cell(size, triangle as u32),
        })
    }
}

/// Triangle of a grid, two for each cell. The diagonals mirror at the middle of the sheet and run through its corners, so that the
/// triangles are as symmetric as the grid allows, and with them masses, wind and shading.
#[inline]
fn of_cell(size: UVec2, triangle: u32) -> [u32; 3] {
    let (columns, rows) = (size.x, size.y);
    let (cell, second) = (triangle / 2, triangle % 2 == 1);
    let (row, column) = (cell / (columns - 1), cell % (columns - 1));
    let top_left = row * columns + column;
    let (top_right, bottom_left) = (top_left + 1, top_left + columns);
    let bottom_right = bottom_left + 1;
    let left = 2 * column < columns - 1;
    let top = 2 * row < rows - 1;
    match (left == top, second) {
        (true, false) => [top_left, bottom_left, bottom_right],
        (true, true) => [top_left, bottom_right, top_right],
        (false, false) => [top_left, bottom_left, top_right],
        (false, true) => [top_right, bottom_left, bottom_right],
    }
}
