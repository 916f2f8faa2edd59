//! Parity of the kernels of constraints.

use bevy_math::{Vec2, Vec3};

use super::{
    super::{
        edges::LineStiffness,
        lanes::{Reading, Shared, SharedPoints},
        lattice,
        mesh::{self, Mesh},
        shear::{self, Shear},
        tether::{self, Straight, Tether},
    },
    SIZES, State, blocks, levels, same,
};
use crate::{
    shape::ClothShape,
    topology::{Topology, chains::ChainBatch, test_meshes::delaunay},
};

#[test]
fn lines() {
    for size in SIZES {
        let kinds = [
            (false, false, false),
            (true, false, false),
            (true, true, false),
            (false, false, true),
            (true, false, true),
        ];
        for (contact, bodies, granted) in kinds {
            for bend in [0.3, f32::INFINITY] {
                let line = LineStiffness {
                    rest_length: 1.0,
                    stretch: 0.01,
                    bend,
                    mass: 0.5,
                };
                let mut start = State::sheet(size);
                (start.bodies, start.granted) = (bodies, granted);
                same(&start, |level, state, cuts| {
                    let columns = blocks(state.columns, cuts);
                    state.with_sheet(contact, |sheet| {
                        for block in columns {
                            lattice::solve_columns(level, sheet, line, block);
                        }
                    });
                });
                same(&start, |level, state, cuts| {
                    let rows = blocks(state.rows, cuts);
                    state.with_sheet(contact, |sheet| {
                        for block in rows {
                            lattice::solve_rows(level, sheet, line, block);
                        }
                    });
                });
            }
        }
    }
}

/// Lines with particles that carry parts of bodies report all impulses on these: with them, momentum is kept.
#[test]
fn lines_tell_what_they_press() {
    let line = LineStiffness {
        rest_length: 1.0,
        stretch: 0.01,
        bend: f32::INFINITY,
        mass: 0.5,
    };
    let mut state = State::sheet([19, 17]);
    state.bodies = true;
    state.inv_mass = state.inv_mass.iter().map(|w| w.max(0.5)).collect();
    let before = state.clone();
    state.with_sheet(true, |sheet| {
        for level in levels() {
            lattice::solve_columns(level, sheet, line, 0..19);
            lattice::solve_rows(level, sheet, line, 0..17);
        }
    });
    let (mut left, mut pressed) = (Vec3::ZERO, Vec3::ZERO);
    for (i, w) in state.inv_mass.iter().enumerate() {
        left += (state.position.get(i) - before.position.get(i)) / *w;
        pressed += state.normal.get(i) * state.pressed[i];
    }
    assert!(pressed.length() > 0.1, "nothing is pressed: {pressed}");
    assert!((left + pressed).length() < 1e-3, "{left} and {pressed}");
}

#[test]
fn diagonals() {
    for size in SIZES {
        for (rising_first, granted) in [(false, false), (true, false), (true, true)] {
            let shear = Shear {
                rest_length: 1.4,
                alpha_tilde: 0.5,
                rising_first,
            };
            let mut start = State::sheet(size);
            start.granted = granted;
            same(&start, |level, state, cuts| {
                let rows = blocks(state.rows, cuts);
                state.with_sheet(rising_first, |sheet| {
                    // The last block first: they do not depend on each other.
                    for block in rows.iter().rev() {
                        shear::solve(level, sheet, shear, block.clone());
                    }
                    for block in &rows[1..] {
                        shear::solve_seam(level, sheet, shear, block.start - 1);
                    }
                });
            });
        }
    }
}

#[test]
fn tethers() {
    for size in SIZES {
        let start = State::sheet(size);
        let n = start.inv_mass.len();
        let distances = |pin: usize| Straight {
            column: (pin % start.columns) as u32,
            row: (pin / start.columns) as u32,
            spacing: Vec2::new(0.99, 0.97),
        };
        let pins = [0, n / 2, n - 1];
        same(&start, |level, state, cuts| {
            let rows = blocks(state.rows, cuts);
            let tethers = pins.map(|pin| {
                let anchor = state.position.get(pin);
                Some(Tether {
                    anchor,
                    anchor_before: anchor + 0.01,
                    longer: 1.01,
                    distances: distances(pin),
                })
            });
            state.with_sheet_and_start(true, |sheet, recovery| {
                for block in rows {
                    tether::solve_straight(level, sheet, &tethers, (1.001, Some(recovery)), block);
                }
            });
        });
        let lengths = pins.map(|pin| {
            let length = |i: usize| {
                distances(pin).length((i % start.columns) as u32, (i / start.columns) as u32)
            };
            (0..n).map(length).collect::<Vec<f32>>()
        });
        same(&start, |level, state, cuts| {
            let tethers = [0, 1, 2].map(|k| {
                let anchor = state.position.get(pins[k]);
                Some(Tether {
                    anchor,
                    anchor_before: anchor + 0.01,
                    longer: 1.01,
                    distances: Reading(&lengths[k]),
                })
            });
            let particles = blocks(n, cuts);
            state.with_sheet_and_start(false, |sheet, recovery| {
                for block in particles {
                    tether::solve(level, sheet, &tethers, (1.001, Some(recovery)), block);
                }
            });
        });
    }
}

#[test]
fn chains_of_a_mesh() {
    let (positions, triangles) = delaunay(16, 5);
    chains_of(ClothShape::mesh(positions, triangles.concat()), false);
}

/// Tubes of different widths, each closed: rings of some lengths in one batch.
#[test]
fn rings_of_a_mesh() {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (k, around) in [21_u32, 23, 24].into_iter().enumerate() {
        let first = positions.len() as u32;
        positions.extend((0..4 * around).map(|i| {
            let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
            Vec3::new(
                angle.cos() + 3.0 * k as f32,
                (i / around) as f32,
                angle.sin(),
            )
        }));
        let at = |c: u32, r: u32| first + r * around + c % around;
        for i in 0..3 * around {
            let (c, r) = (i % around, i / around);
            let [a, b, d, e] = [at(c, r), at(c, r + 1), at(c + 1, r), at(c + 1, r + 1)];
            triangles.extend([a, b, d, d, b, e]);
        }
    }
    chains_of(ClothShape::mesh(positions, triangles), true);
}

fn chains_of(cloth: ClothShape, has_rings: bool) {
    let topology = Topology::build(&cloth, Vec3::ONE).expect("a mesh");
    let fabric = topology.fabric().expect("no grid");
    let closed = |batch: &ChainBatch| batch.closing.is_some();
    assert_eq!(fabric.chains().batches.iter().any(closed), has_rings);
    let rest = topology.rest_positions.iter().map(|p| *p * 20.0);
    let start = State::new([topology.particles(), 1], rest);
    for (contact, bodies) in [(false, false), (true, false), (true, true)] {
        same(&start, |level, state, _| {
            let mesh = Mesh {
                fabric,
                position: SharedPoints::new(&mut state.position),
                inv_mass: Shared::new(&mut state.inv_mass),
                normal: contact.then(|| SharedPoints::new(&mut state.normal)),
                pressed: bodies.then(|| Shared::new(&mut state.pressed)),
                rest_length: &fabric.chains().rest_length,
                give: super::give(contact),
            };
            for pass in &fabric.chains().passes {
                mesh::solve_chains(level, mesh, 0.01, pass.batches.clone());
            }
        });
    }
}
