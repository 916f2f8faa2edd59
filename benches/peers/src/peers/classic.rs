//! The classic scheme: Verlet integration, then Jakobsen's relaxation over 8 N² springs.
//!
//! Jakobsen, Advanced Character Physics, 2001. Plain scalar code with a square root and a division for each spring; the
//! springs are sorted into batches in which no two share a particle, so that none waits for the one before.

use super::Peer;
use crate::scene::{self, Sheet};

/// The springs' kinds, by how many rows and columns they span: structural, diagonal, skip-one, skip-one diagonal.
/// Diagonals in the other direction follow from those with both.
const KINDS: [[usize; 2]; 6] = [[0, 1], [1, 0], [1, 1], [0, 2], [2, 0], [2, 2]];

/// A spring.
struct Spring {
    /// Its ends.
    ends: [usize; 2],
    /// Its rest length, L [m].
    rest: f32,
    /// The share of the correction that goes to each end [-]: ½ and ½, or 0 and 1 beside a pin.
    shares: [f32; 2],
}

/// A sheet of particles and springs.
pub struct Classic {
    passes: u8,
    positions: Vec<[f32; 3]>,
    previous: Vec<[f32; 3]>,
    pinned: Vec<bool>,
    springs: Vec<Spring>,
}

impl Classic {
    /// The sheet at rest, relaxed so many times in a step.
    pub fn new(sheet: Sheet, passes: u8) -> Self {
        let positions: Vec<_> = sheet.positions().collect();
        let mut pinned = vec![false; positions.len()];
        for i in sheet.pins() {
            pinned[i] = true;
        }
        let spring = |ends: [usize; 2]| Spring {
            ends,
            rest: scene::distance(positions[ends[0]], positions[ends[1]]),
            shares: match ends.map(|i| pinned[i]) {
                [false, false] => [0.5, 0.5],
                [true, false] => [0.0, 1.0],
                [false, true] => [1.0, 0.0],
                [true, true] => [0.0, 0.0],
            },
        };
        let springs = batches(sheet).into_iter().flatten().map(spring).collect();
        Self {
            passes,
            previous: positions.clone(),
            positions,
            pinned,
            springs,
        }
    }

    /// x' = x + d (x − x⁻) + g h², with d the part of the motion that a step leaves.
    fn integrate(&mut self) {
        let kept = (-scene::DAMPING * scene::STEP).exp();
        let fall = [0.0, -scene::GRAVITY * scene::STEP * scene::STEP, 0.0];
        let particles = self.positions.iter_mut().zip(&mut self.previous);
        for ((x, previous), _) in particles.zip(&self.pinned).filter(|(_, pinned)| !**pinned) {
            let old = *x;
            for k in 0..3 {
                x[k] += (x[k] - previous[k]) * kept + fall[k];
            }
            *previous = old;
        }
    }

    /// Moves the ends of each spring to its rest length: by (|d| − L) d / |d|, shared.
    fn relax(&mut self) {
        for spring in &self.springs {
            let [a, b] = spring.ends;
            let (p, q) = (self.positions[a], self.positions[b]);
            let d = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
            let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            let part = 1.0 - spring.rest / length.max(f32::MIN_POSITIVE);
            let [to_a, to_b] = spring.shares.map(|share| share * part);
            for k in 0..3 {
                self.positions[a][k] = p[k] + to_a * d[k];
                self.positions[b][k] = q[k] - to_b * d[k];
            }
        }
    }
}

impl Peer for Classic {
    fn step(&mut self) {
        self.integrate();
        for _ in 0..self.passes {
            self.relax();
        }
    }

    fn positions(&self, into: &mut Vec<[f32; 3]>) {
        into.extend_from_slice(&self.positions);
    }
}

/// All springs, in batches without shared particles.
///
/// A spring that spans s rows begins in row r; those with the same parity of ⌊r / s⌋ touch no row twice. Springs along
/// a row are told apart by their column likewise.
fn batches(sheet: Sheet) -> Vec<Vec<[usize; 2]>> {
    let mut batches = Vec::new();
    for kind @ [rows, columns] in KINDS {
        for parity in 0..2 {
            let chosen = |ends: &[usize; 2]| {
                let (row, column) = (ends[0] / sheet.size, ends[0] % sheet.size);
                let along = row.checked_div(rows).unwrap_or(column / columns.max(1));
                along % 2 == parity
            };
            batches.push(sheet.pairs(kind).filter(chosen).collect());
            if rows > 0 && columns > 0 {
                // The other diagonal of the same square.
                let flip = |[a, b]: [usize; 2]| [a + columns, b - columns];
                batches.push(sheet.pairs(kind).filter(chosen).map(flip).collect());
            }
        }
    }
    batches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_share_no_particles_and_hold_each_spring_once() {
        for size in [2, 3, 4, 7, 10] {
            let sheet = Sheet { size };
            let mut springs = Vec::new();
            for batch in batches(sheet) {
                let mut touched: Vec<_> = batch.iter().flatten().copied().collect();
                touched.sort_unstable();
                assert!(
                    touched.windows(2).all(|w| w[0] != w[1]),
                    "{size}: {touched:?}"
                );
                springs.extend(batch.iter().map(|[a, b]| [*a.min(b), *a.max(b)]));
            }
            let n = size as isize;
            let span = |s: isize| (n - s).max(0);
            let expected = 2 * (n * span(1) + n * span(2) + span(1) * span(1) + span(2) * span(2));
            springs.sort_unstable();
            springs.dedup();
            assert_eq!(springs.len() as isize, expected, "{size}");
        }
    }

    #[test]
    fn a_sheet_at_rest_stays_until_gravity_acts() {
        let mut classic = Classic::new(Sheet { size: 6 }, 1);
        let before = classic.positions.clone();
        classic.relax();
        for (a, b) in before.iter().zip(&classic.positions) {
            assert!(scene::distance(*a, *b) < 1e-6);
        }
    }
}
