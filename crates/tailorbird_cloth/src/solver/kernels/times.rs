//! Times of the kernels, with every instruction set of this machine:
//! `cargo test --release -p tailorbird_cloth --lib times -- --ignored --nocapture`.

use std::time::Instant;

use super::{
    lanes::{Shared, SharedPoints, levels},
    lattice::{Shear, Sheet, solve_columns, solve_rows, solve_shear},
    line::LineStiffness,
    viscosity,
};
use crate::points::Points;

#[test]
#[ignore = "prints times"]
fn of_the_kernels_of_a_sheet() {
    for size in [64usize, 256] {
        let n = size * size;
        let mut position: Points = (0..n)
            .map(|i| {
                bevy_math::Vec3::new(
                    (i % size) as f32 * 0.01,
                    (i / size) as f32 * 0.01,
                    (i as f32 * 0.7).sin() * 1e-3,
                )
            })
            .collect();
        let mut previous = position.clone();
        let mut inv_mass = vec![1.0 / 1.5e-5; n];
        let sheet = Sheet {
            columns: size,
            rows: size,
            position: SharedPoints::new(&mut position),
            inv_mass: Shared::new(&mut inv_mass),
            normal: None,
        };
        let previous = SharedPoints::new(&mut previous);
        let mut lost = Points::zeroed(n);
        let lost = SharedPoints::new(&mut lost);
        let line = LineStiffness {
            rest_length: 0.01,
            stretch: 0.0,
            bend: 1e6,
        };
        let shear = Shear {
            rest_length: 0.014142,
            alpha_tilde: 1e3,
            rising_first: false,
        };
        for level in levels() {
            let time = |name: &str, f: &dyn Fn()| {
                f();
                let passes = 4_000_000 / n;
                let best = (0..5)
                    .map(|_| {
                        let start = Instant::now();
                        for _ in 0..passes {
                            f();
                        }
                        start.elapsed().as_secs_f64() / (passes * n) as f64 * 1e9
                    })
                    .fold(f64::MAX, f64::min);
                println!("{size} {level:?} {name}: {best:.3} ns per particle");
            };
            time("columns", &|| solve_columns(level, sheet, line, 0..size));
            time("rows", &|| solve_rows(level, sheet, line, 0..size));
            time("shear", &|| {
                solve_shear(level, sheet, shear, 0..size);
                solve_shear(level, sheet, shear, 1..size);
            });
            time("viscosity", &|| {
                viscosity::damp(level, sheet, previous, lost, Default::default(), 1e-6);
            });
        }
    }
}
