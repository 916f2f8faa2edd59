//! Kernels against plain solutions of the same equations in double precision.
//!
//! Constants stand here as numbers once more: one that is changed is a change of what is solved.

mod air;
mod chain;
mod contact;
mod exchange;
mod hinge;
mod hull;
mod line;
mod meshes;
mod motion;
mod newton;
mod series;
mod shear;
mod solid;
mod sphere;
mod surface;
mod survey;
mod swept;
mod tether;
mod viscosity;

use crate::properties::*;
use bevy_math::{DVec3, Vec3};
use proptest::test_runner::RngSeed;

use super::{
    lanes::{Shared, SharedPoints},
    lattice::{Lengths, Sheet},
    lines::Give,
};
use crate::points::Points;

/// Always the same ones.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}

/// A sheet, without the parameters of its solve.
#[derive(Clone, Debug)]
struct Cloth {
    columns: usize,
    rows: usize,
    position: Vec<Vec3>,
    inv_mass: Vec<f32>,
    /// Normals of contacts; empty where nothing is in contact.
    normal: Vec<Vec3>,
    /// Prescribed lengths of edges along rows and along columns; empty where all are 1.
    lengths: [Vec<f32>; 2],
}

impl Cloth {
    /// Solves it with a kernel, and returns the positions of the particles afterwards.
    fn solved(&self, solve: impl FnOnce(Sheet)) -> Vec<DVec3> {
        self.solved_with(Give::default(), solve)
    }

    fn solved_with(&self, give: Give, solve: impl FnOnce(Sheet)) -> Vec<DVec3> {
        let mut position: Points = self.position.iter().copied().collect();
        let mut normal: Points = self.normal.iter().copied().collect();
        let mut inv_mass = self.inv_mass.clone();
        let [mut rows, mut columns] = self.lengths.clone();
        let mut diagonals = rows.clone();
        solve(Sheet {
            columns: self.columns,
            rows: self.rows,
            position: SharedPoints::new(&mut position),
            inv_mass: Shared::new(&mut inv_mass),
            normal: (!self.normal.is_empty()).then(|| SharedPoints::new(&mut normal)),
            pressed: None,
            give,
            lengths: (!rows.is_empty()).then(|| Lengths {
                rows: Shared::new(&mut rows),
                columns: Shared::new(&mut columns),
                diagonals: Shared::new(&mut diagonals),
            }),
        });
        position.iter().map(Vec3::as_dvec3).collect()
    }
}

/// Sum of m Δx of the free particles \[kg m\].
fn momentum(from: &[DVec3], to: &[DVec3], inv_mass: &[f32]) -> DVec3 {
    let all = from.iter().zip(to).zip(inv_mass);
    all.filter(|(_, w)| **w > 0.0)
        .map(|((from, to), w)| (*to - *from) / f64::from(*w))
        .sum()
}

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    [-size..size, -size..size, -size..size].prop_map(Vec3::from)
}

/// Sheets at a distance of 1 between neighbours, whose particles are off by up to `noise`; a part of them is held, and a part in contact.
fn cloths(noise: f32, contacts: bool, granted: bool) -> impl Strategy<Value = Cloth> {
    (2_usize..24, 2_usize..24).prop_flat_map(move |(columns, rows)| {
        let n = columns * rows;
        let normal = if contacts {
            let some = prop_oneof![2 => Just(Vec3::ZERO), 1 => vector(1.0)];
            prop::collection::vec(some.prop_map(Vec3::normalize_or_zero), n).boxed()
        } else {
            Just(Vec::new()).boxed()
        };
        let lengths = if granted {
            [(); 2].map(|()| prop::collection::vec(0.9_f32..1.3, n).boxed())
        } else {
            [(); 2].map(|()| Just(Vec::new()).boxed())
        };
        let off = prop::collection::vec(vector(noise), n);
        let inv_mass = prop::collection::vec(prop_oneof![1 => Just(0.0), 9 => 0.2_f32..2.0], n);
        (off, inv_mass, normal, lengths).prop_map(move |(off, inv_mass, normal, lengths)| {
            let at = |i: usize| Vec3::new((i % columns) as f32, -((i / columns) as f32), 0.0);
            Cloth {
                columns,
                rows,
                position: (0..).zip(off).map(|(i, off)| at(i) + off).collect(),
                inv_mass,
                normal,
                lengths,
            }
        })
    })
}

/// Solves A x = b by elimination with pivots.
fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs()))
            .unwrap_or(k);
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let row = a[k].clone();
            for (to, from) in a[i].iter_mut().zip(row) {
                *to -= factor * from;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - sum) / a[k][k];
    }
    b
}
