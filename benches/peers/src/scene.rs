//! The scene `hang`: a square sheet starts horizontal and hangs by two corners.
//!
//! The same as that of the example `headless` of `tailorbird_cloth`: rows along +z from −1, columns along +x from −1, at
//! y = 1; the first row's ends are pinned.

/// Its name.
pub const NAME: &str = "hang";
/// Width and height of the sheet [m].
pub const WIDTH: f32 = 2.0;
/// Height at which the sheet starts [m].
pub const Y: f32 = 1.0;
/// Mass per area [kg/m²].
pub const AREAL_DENSITY: f32 = 0.15;
/// Downwards [m/s²].
pub const GRAVITY: f32 = 9.81;
/// Rate at which motion decays [1/s].
pub const DAMPING: f32 = 0.3;
/// Length of a step [s].
pub const STEP: f32 = 1.0 / 60.0;
/// Steps: 5 s.
pub const STEPS: usize = 300;

/// The sheet at its start.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// Particles along a side; at least 2.
    pub size: usize,
}

impl Sheet {
    /// Distance between neighbours in a row or column [m].
    pub fn spacing(self) -> f32 {
        WIDTH / (self.size - 1) as f32
    }

    /// Number of particles.
    pub fn particles(self) -> usize {
        self.size * self.size
    }

    /// Positions of the particles [m], row by row.
    pub fn positions(self) -> impl Iterator<Item = [f32; 3]> {
        let at = move |k: usize| k as f32 * self.spacing() - WIDTH / 2.0;
        (0..self.particles()).map(move |i| [at(i % self.size), Y, at(i / self.size)])
    }

    /// The pinned particles: the corners (0, 0) and (0, N − 1).
    pub fn pins(self) -> [usize; 2] {
        [0, self.size - 1]
    }

    /// Pairs of particles that are `rows` and `columns` apart.
    pub fn pairs(self, [rows, columns]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
        let [height, width] = [rows, columns].map(|step| self.size.saturating_sub(step));
        (0..height * width).map(move |k| {
            let i = k / width * self.size + k % width;
            [i, i + rows * self.size + columns]
        })
    }

    /// The structural edges: neighbours in a row or column.
    pub fn edges(self) -> impl Iterator<Item = [usize; 2]> {
        self.pairs([0, 1]).chain(self.pairs([1, 0]))
    }
}

/// From a to b.
pub fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let d: [f32; 3] = std::array::from_fn(|k| b[k] - a[k]);
    d.iter().map(|x| x * x).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_have_the_length_of_the_spacing() {
        let sheet = Sheet { size: 5 };
        let positions: Vec<_> = sheet.positions().collect();
        assert_eq!(sheet.edges().count(), 2 * 5 * 4);
        for [a, b] in sheet.edges() {
            let length = distance(positions[a], positions[b]);
            assert!((length - 0.5).abs() < 1e-6, "{length} m");
        }
    }

    #[test]
    fn the_pins_are_the_ends_of_the_first_row() {
        let sheet = Sheet { size: 4 };
        let positions: Vec<_> = sheet.positions().collect();
        assert_eq!(
            sheet.pins().map(|i| positions[i]),
            [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0]]
        );
    }
}
