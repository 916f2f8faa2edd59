//! A grid: the classic springs to the neighbours at 1, √2, 2 and 2√2.

use bevy_math::{UVec2, Vec2, Vec3};

use super::{
    Topology,
    constraints::ConstraintFamily,
    constraints::DistanceConstraints,
    lattice::Lattice,
    layout::{Layout, SheetLayout},
};

/// Builds the topology of a grid from its particles in row-major order. Areas and revision are left to the caller.
pub(super) fn build(rest_positions: Vec<Vec3>, resolution: UVec2) -> Topology {
    Topology {
        flat: true,
        layout: Layout::Sheet(SheetLayout::from(Lattice {
            columns: resolution.x,
            rows: resolution.y,
            spacing: Vec2::new(
                rest_positions[0].distance(rest_positions[1]),
                rest_positions[0].distance(rest_positions[resolution.x as usize]),
            ),
        })),
        rest_positions,
        ..Default::default()
    }
}

/// Number of springs.
pub(super) fn constraint_count(columns: usize, rows: usize) -> usize {
    let at = |step: usize| {
        let (c, r) = (columns.saturating_sub(step), rows.saturating_sub(step));
        c * rows + columns * r + 2 * c * r
    };
    at(1) + at(2)
}

/// Springs, 8 for each particle of a large grid. A spring that spans `step` rows (or columns) shares no particle with springs whose first
/// row, divided by `step`, is even as well: two batches for each direction.
pub(super) fn constraints(columns: u32, rows: u32, rest_positions: &[Vec3]) -> DistanceConstraints {
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
    use crate::{shape::ClothShape, topology::order::Stored};

    fn topology(columns: u32, rows: u32) -> Topology {
        let cloth = ClothShape::grid(Vec2::new(1.0, 2.0), UVec2::new(columns, rows));
        Topology::build(&cloth, Vec3::ONE).expect("valid")
    }

    #[test]
    fn has_the_springs_of_the_classic_scheme() {
        let (c, r) = (7usize, 5usize);
        let t = topology(c as u32, r as u32);
        assert_eq!(t.constraints().len(), t.constraint_count());
        assert_eq!(
            t.constraint_count(),
            6 * 5 + 7 * 4 + 2 * 6 * 4 + 5 * 5 + 7 * 3 + 2 * 5 * 3
        );
        let distinct: HashSet<[u32; 2]> = t
            .constraints()
            .ends
            .iter()
            .map(|&[a, b]| [a.min(b), a.max(b)])
            .collect();
        assert_eq!(distinct.len(), t.constraints().len());
    }

    #[test]
    fn batches_share_no_particle() {
        for (c, r) in [(2, 2), (3, 3), (8, 5), (16, 17)] {
            for batch in &topology(c, r).constraints().batches {
                let mut seen = HashSet::new();
                let t = topology(c, r);
                for &particle in t.constraints().ends[batch.range.clone()].iter().flatten() {
                    assert!(seen.insert(particle), "{c}x{r} {batch:?}");
                }
            }
        }
    }

    #[test]
    fn areas_add_up_and_mirror() {
        let t = topology(7, 9);
        let total: f32 = t.areas().sum();
        let areas: Vec<f32> = t.areas().collect();
        assert!((total - 2.0).abs() < 1e-5);
        for row in 0..9 {
            for column in 0..7 {
                let at = |row: usize, column: usize| areas[row * 7 + column];
                assert!((at(row, column) - at(row, 6 - column)).abs() < 1e-7);
                assert!((at(row, column) - at(8 - row, column)).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn what_is_not_stored_is_as_if_it_were() {
        let t = topology(7, 5);
        let (count, sum) = (t.triangles().len(), t.triangle_areas().sum::<f32>());
        assert_eq!((count, t.source_triangles().len()), (48, 48));
        assert!((sum - 2.0).abs() < 1e-5 && (t.cell_area() - sum / 35.0).abs() < 1e-7);
        assert_eq!(t.triangles().get(47), t.triangles().iter().last());
        assert_eq!(t.triangles().get(48), None);
        let mut edges: Vec<_> = t.stretch_edges();
        let mut springs: Vec<_> = t.constraints().family(ConstraintFamily::Stretch).collect();
        edges.sort_by_key(|edge| edge.0);
        springs.sort_by_key(|edge| edge.0);
        assert_eq!(edges, springs);
        assert!(t.particles_of_vertices().eq((0..35).map(Stored)));
    }

    #[test]
    fn triangles_face_the_front() {
        let t = topology(4, 4);
        for tri in t.triangles().iter() {
            let [a, b, c] = tri.map(|i| t.rest_positions[i as usize]);
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }
}
