//! The line solve is a step of Newton's: what it leaves falls with the square of what there was.

use crate::properties::*;
use bevy_math::Vec3;
use fearless_simd::Level;

use super::{Cloth, cases, cloths, vector};
use crate::kernels::{edges::LineStiffness, lattice, lines::Give};

const ROWS: usize = 12;

/// The length of C of all edges along columns after one pass, where each particle was off by a part of `off`, without any compliance.
fn left(off: &[Vec3], inv_mass: &[f32], part: f32) -> f64 {
    let at = |i: usize| {
        let (column, row) = (i % 2, i / 2);
        // Edges of length 1 that turn to and fro.
        Vec3::new(
            3.0 * column as f32 + 0.6 * (row % 2) as f32,
            -0.8 * row as f32,
            0.0,
        )
    };
    let cloth = Cloth {
        columns: 2,
        rows: ROWS,
        position: (0..2 * ROWS).map(|i| at(i) + off[i] * part).collect(),
        inv_mass: inv_mass.to_vec(),
        normal: Vec::new(),
        lengths: [const { Vec::new() }; 2],
    };
    let line = LineStiffness {
        rest_length: 1.0,
        stretch: 0.0,
        bend: f32::INFINITY,
        mass: 0.5,
    };
    let give = Give {
        compliance: 0.0,
        ..Give::default()
    };
    let solved = cloth.solved_with(give, |sheet| {
        lattice::solve_columns(Level::new(), sheet, line, 0..2);
    });
    let edges = (0..2 * ROWS - 2).map(|i| 0.5 * (solved[i].distance_squared(solved[i + 2]) - 1.0));
    edges.map(|c| c * c).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(cases(200))]

    /// Halved, it leaves a quarter; a third order of a tenth of that, and rounding, may be beside it.
    #[test]
    fn a_pass_along_lines_leaves_the_square_of_what_was_there(
        off in prop::collection::vec(vector(1.0), 2 * ROWS), inv_mass in prop::collection::vec(0.5_f32..2.0, 2 * ROWS),
    ) {
        let [whole, half] = [0.02, 0.01].map(|part| left(&off, &inv_mass, part));
        // Half the square of what edges change by, of up to 0.04 √3, of 22 of them.
        prop_assert!(whole < 0.0024 * 22.0_f64.sqrt() && whole > 1e-5, "{whole}");
        prop_assert!((whole / half - 4.0).abs() < 1.0, "{whole} {half}");
    }
}

proptest! {
    #![proptest_config(cases(50))]

    /// Twice as large all is twice as far, to the bit: compliances are those of lengths.
    #[test]
    fn lines_of_twice_the_size_move_twice_as_far(cloth in cloths(0.2, true, false), stretch in 0.01_f32..1.0, bend in 0.1_f32..5.0) {
        let [small, large] = [1.0, 2.0].map(|size| {
            let cloth = Cloth { position: cloth.position.iter().map(|p| p * size).collect(), ..cloth.clone() };
            let line = LineStiffness { rest_length: size, stretch, bend, mass: 0.5 };
            cloth.solved(|sheet| {
                lattice::solve_rows(Level::new(), sheet, line, 0..sheet.rows);
                lattice::solve_columns(Level::new(), sheet, line, 0..sheet.columns);
            })
        });
        for (small, large) in small.into_iter().zip(large) {
            prop_assert_eq!(small * 2.0, large);
        }
    }

    /// Whatever the tension and the surfaces, which differ: what is in contact moves along its own alone.
    #[test]
    fn lines_leave_no_surface(cloth in cloths(0.9, true, false), size in 1.0_f32..3.0) {
        let cloth = Cloth { position: cloth.position.iter().map(|p| p * size).collect(), ..cloth };
        let line = LineStiffness { rest_length: 1.0, stretch: 0.01, bend: f32::INFINITY, mass: 0.5 };
        let solved = cloth.solved(|sheet| lattice::solve_rows(Level::new(), sheet, line, 0..sheet.rows));
        for (i, solved) in solved.into_iter().enumerate() {
            let moved = solved - cloth.position[i].as_dvec3();
            // Coordinates below 128, and displacements of their size.
            prop_assert!(moved.dot(cloth.normal[i].as_dvec3()).abs() < 2e-4, "{i}: {moved}");
        }
    }
}
