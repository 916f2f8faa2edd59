//! A grid: the classic springs to the neighbours at 1, √2, 2 and 2√2.

use bevy_math::{UVec2, Vec2, Vec3};

use super::{
    Neighbors, Topology, constraints::ConstraintFamily, constraints::DistanceConstraints,
    lattice::Lattice,
};

/// Builds the topology of a grid from its particles in row-major order. Areas and revision are left to the caller.
pub(super) fn build(rest_positions: Vec<Vec3>, resolution: UVec2) -> Topology {
    let (columns, rows) = (resolution.x, resolution.y);
    let triangles = triangles(columns, rows);
    let constraints = constraints(columns, rows, &rest_positions);
    let particles = rest_positions.len();
    let edges = constraints
        .family(ConstraintFamily::Stretch)
        .chain(constraints.family(ConstraintFamily::Shear))
        .map(|(ends, _)| ends);
    Topology {
        neighbors: Neighbors::new(particles, edges),
        grid: Some(resolution),
        flat: true,
        lattice: Some(Lattice {
            columns,
            rows,
            spacing: Vec2::new(
                rest_positions[0].distance(rest_positions[1]),
                rest_positions[0].distance(rest_positions[columns as usize]),
            ),
        }),
        source_triangles: (0..triangles.len() as u32).collect(),
        particle_of_vertex: (0..particles as u32).collect(),
        rest_positions,
        triangles,
        constraints,
        ..Default::default()
    }
}

/// Two triangles for each cell. The diagonals mirror at the middle of the sheet and run through its corners, so that
/// the triangles are as symmetric as the grid allows, and with them masses, wind and shading.
fn triangles(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(((columns - 1) * (rows - 1) * 2) as usize);
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let top_left = row * columns + column;
            let (top_right, bottom_left) = (top_left + 1, top_left + columns);
            let bottom_right = bottom_left + 1;
            let left = 2 * column < columns - 1;
            let top = 2 * row < rows - 1;
            if left == top {
                triangles.push([top_left, bottom_left, bottom_right]);
                triangles.push([top_left, bottom_right, top_right]);
            } else {
                triangles.push([top_left, bottom_left, top_right]);
                triangles.push([top_right, bottom_left, bottom_right]);
            }
        }
    }
    triangles
}

/// The springs, 8 for each particle of a large grid. A spring that spans `step` rows (or columns) shares no particle
/// with those whose first row, divided by `step`, is even as well: two batches for each direction.
fn constraints(columns: u32, rows: u32, rest_positions: &[Vec3]) -> DistanceConstraints {
    use ConstraintFamily::{Bend, Shear, Stretch};
    const ALONG_ROW: (u32, u32, bool) = (1, 0, false);
    const ALONG_COLUMN: (u32, u32, bool) = (0, 1, false);
    const FALLING: (u32, u32, bool) = (1, 1, false);
    const RISING: (u32, u32, bool) = (1, 1, true);

    let mut constraints = DistanceConstraints::default();
    for (family, step, directions) in [
        (Bend, 2, &[FALLING, RISING, ALONG_ROW, ALONG_COLUMN][..]),
        (Shear, 1, &[FALLING, RISING]),
        (Stretch, 1, &[ALONG_ROW, ALONG_COLUMN]),
    ] {
        for &(dx, dy, rising) in directions {
            let (dx, dy) = (dx * step, dy * step);
            let last_column = columns.saturating_sub(dx);
            let last_row = rows.saturating_sub(dy);
            for parity in 0..2 {
                let pairs = (0..last_row)
                    .flat_map(|row| (0..last_column).map(move |column| (row, column)))
                    .filter(|(row, column)| {
                        let first = if dy == 0 { column } else { row };
                        first / step % 2 == parity
                    })
                    .map(|(row, column)| {
                        let (from, to) = if rising {
                            (column + dx, column)
                        } else {
                            (column, column + dx)
                        };
                        [row * columns + from, (row + dy) * columns + to]
                    });
                constraints.push_batch(family, rest_positions, pairs);
            }
        }
    }
    constraints
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use bevy_math::Vec2;

    use super::*;
    use crate::cloth::Cloth;

    fn topology(columns: u32, rows: u32) -> Topology {
        let cloth = Cloth::grid(Vec2::new(1.0, 2.0), UVec2::new(columns, rows));
        Topology::build(&cloth.shape, Vec3::ONE).expect("valid")
    }

    #[test]
    fn has_the_springs_of_the_classic_scheme() {
        let (c, r) = (7usize, 5usize);
        let t = topology(c as u32, r as u32);
        let at = |step: usize| {
            (c - step.min(c)) * r
                + c * (r - step.min(r))
                + 2 * (c - step.min(c)) * (r - step.min(r))
        };
        assert_eq!(t.constraints.len(), at(1) + at(2));
        let distinct: HashSet<[u32; 2]> = t
            .constraints
            .ends
            .iter()
            .map(|&[a, b]| [a.min(b), a.max(b)])
            .collect();
        assert_eq!(distinct.len(), t.constraints.len());
    }

    #[test]
    fn batches_share_no_particle() {
        for (c, r) in [(2, 2), (3, 3), (8, 5), (16, 17)] {
            for batch in &topology(c, r).constraints.batches {
                let mut seen = HashSet::new();
                let t = topology(c, r);
                for &particle in t.constraints.ends[batch.range.clone()].iter().flatten() {
                    assert!(seen.insert(particle), "{c}x{r} {batch:?}");
                }
            }
        }
    }

    #[test]
    fn areas_add_up_and_mirror() {
        let t = topology(7, 9);
        let total: f32 = t.areas.iter().sum();
        assert!((total - 2.0).abs() < 1e-5);
        for row in 0..9 {
            for column in 0..7 {
                let at = |row: usize, column: usize| t.areas[row * 7 + column];
                assert!((at(row, column) - at(row, 6 - column)).abs() < 1e-7);
                assert!((at(row, column) - at(8 - row, column)).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn triangles_face_the_front() {
        let t = topology(4, 4);
        for tri in &t.triangles {
            let [a, b, c] = tri.map(|i| t.rest_positions[i as usize]);
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }
}
