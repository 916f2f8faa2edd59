//! Every instruction set gives the same bits, and so do any blocks of rows, columns or particles.

mod constraints;
mod particles;

use bevy_math::Vec3;
use fearless_simd::Level;

use super::{
    lanes::{Shared, SharedPoints, levels},
    lattice::{Lengths, Sheet},
    lines::Give,
    recovery::Recovery,
};
use crate::{numbers::Numbers, points::Points, topology::test_meshes::random};

/// Sizes that leave remainders in vectors of 4, 8 and 16 lanes.
const SIZES: [[usize; 2]; 4] = [[5, 7], [17, 33], [50, 50], [2, 2]];

/// Blocks of rows that start at even ones, of columns or of particles: all at once, or cut.
const CUTS: [&[usize]; 3] = [&[], &[2], &[4, 6, 24]];

/// All that kernels write.
#[derive(Clone, PartialEq)]
struct State {
    columns: usize,
    rows: usize,
    position: Points,
    previous: Points,
    lost: Points,
    acceleration: Points,
    inv_mass: Numbers,
    normal: Points,
    depth: Numbers,
    pressed: Numbers,
    /// Prescribed lengths of edges: along rows, along columns, across.
    lengths: [Numbers; 3],
    /// True if some particles carry parts of bodies.
    bodies: bool,
    /// True if prescribed lengths differ from those at rest.
    granted: bool,
}

fn noise(len: usize, seed: u64, size: f32) -> Points {
    let axis = |axis: u64| (0..len).map(move |i| (random(i, seed + axis) - 0.5) * size);
    Points {
        x: axis(0).collect(),
        y: axis(1).collect(),
        z: axis(2).collect(),
    }
}

impl State {
    /// A crumpled sheet at a distance of 1 between neighbours, with pins and different masses.
    fn sheet([columns, rows]: [usize; 2]) -> Self {
        let rest = (0..columns * rows)
            .map(|i| Vec3::new((i % columns) as f32, -((i / columns) as f32), 0.0));
        Self::new([columns, rows], rest)
    }

    fn new([columns, rows]: [usize; 2], rest: impl Iterator<Item = Vec3>) -> Self {
        let n = columns * rows;
        let mut position = noise(n, 1, 0.6);
        for (i, p) in rest.enumerate() {
            position.add(i, p);
        }
        let mut previous = noise(n, 4, 0.1);
        for i in 0..n {
            previous.add(i, position.get(i));
        }
        // A third of the particles is in contact.
        let normal = noise(n, 10, 2.0);
        let normal = (0..n).map(|i| {
            let touching = i % 3 == 1;
            if touching {
                // Some carry a part of a body.
                normal.get(i).normalize_or(Vec3::Z) * if i % 2 == 0 { 0.8 } else { 1.0 }
            } else {
                Vec3::ZERO
            }
        });
        Self {
            columns,
            rows,
            position,
            previous,
            lost: noise(n, 7, 1e-7),
            acceleration: noise(n, 20, 5.0),
            inv_mass: (0..n)
                .map(|i| match i % 23 {
                    5 => 0.0,
                    7..=9 => 0.5,
                    _ => 2.0,
                })
                .collect(),
            normal: normal.collect(),
            depth: (0..n)
                .map(|i| if i % 3 == 1 { 0.05 } else { 0.0 })
                .collect(),
            pressed: (0..n).map(|_| 0.0).collect(),
            lengths: [30, 31, 32].map(|seed| (0..n).map(|i| 1.0 + 0.5 * random(i, seed)).collect()),
            bodies: false,
            granted: false,
        }
    }

    fn with_sheet(&mut self, contact: bool, f: impl FnOnce(Sheet)) {
        self.with_sheet_and_start(contact, |sheet, _| f(sheet));
    }

    fn with_sheet_and_start(&mut self, contact: bool, f: impl FnOnce(Sheet, Recovery)) {
        let recovery = Recovery {
            start: SharedPoints::new(&mut self.previous),
            least: 0.01,
            part: 0.05,
        };
        let [rows, columns, diagonals] = self.lengths.each_mut().map(|all| Shared::new(all));
        let sheet = Sheet {
            columns: self.columns,
            rows: self.rows,
            position: SharedPoints::new(&mut self.position),
            inv_mass: Shared::new(&mut self.inv_mass),
            normal: contact.then(|| SharedPoints::new(&mut self.normal)),
            pressed: (contact && self.bodies).then(|| Shared::new(&mut self.pressed)),
            give: give(contact),
            lengths: self.granted.then_some(Lengths {
                rows,
                columns,
                diagonals,
            }),
        };
        f(sheet, recovery);
    }

    /// The bits of all numbers.
    fn bits(&self) -> Vec<u32> {
        let points = [&self.position, &self.previous, &self.lost, &self.normal];
        let numbers = points.into_iter().flat_map(|p| [&p.x, &p.y, &p.z]);
        let all = numbers.chain([&self.depth, &self.pressed]).flatten();
        all.map(|v| v.to_bits()).collect()
    }
}

/// Give of a strained cloth, and of one that is not.
fn give(strained: bool) -> Give {
    if strained {
        Give {
            compliance: 0.02,
            pull: 1.3,
            push: 1.3,
        }
    } else {
        Give::default()
    }
}

/// A range cut into blocks.
fn blocks(len: usize, cuts: &[usize]) -> Vec<std::ops::Range<usize>> {
    let inner = cuts.iter().copied().filter(|cut| *cut < len);
    let ends: Vec<usize> = [0].into_iter().chain(inner).chain([len]).collect();
    ends.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// `kernel` gets a level, a state, and where to cut.
fn same(start: &State, kernel: impl Fn(Level, &mut State, &[usize])) {
    let result = |level, cuts| {
        let mut state = start.clone();
        kernel(level, &mut state, cuts);
        state.bits()
    };
    let expected = result(levels()[0], CUTS[0]);
    assert!(expected != start.bits(), "nothing happens");
    for level in levels() {
        for cuts in CUTS {
            let size = [start.columns, start.rows];
            assert!(
                result(level, cuts) == expected,
                "{size:?}, {level:?}, {cuts:?}"
            );
        }
    }
}
