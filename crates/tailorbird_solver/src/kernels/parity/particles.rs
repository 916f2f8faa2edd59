//! Parity of the kernels that move particles, keep them out of colliders or survey them.

use bevy_math::Vec3;
use fearless_simd::Level;

use super::{
    super::{
        contact::{Out, Phase, Touching},
        half_space::{self, MovingHalfSpace},
        lanes::{Shared, SharedPoints, levels},
        lattice::Sheet,
        limit::{self, Backstop, Limits},
        lines::Give,
        range,
        rigid_motion::RigidMotion,
        sphere::{self, MovingSphere},
        verlet::Verlet,
        viscosity::{Beside, SheetMotion},
    },
    SIZES, State, blocks, noise, same,
};
use crate::topology::test_meshes::random;

fn verlet() -> Verlet {
    Verlet {
        seconds: 0.01,
        seconds_before: 0.02,
        damping: 0.4,
        gravity: Vec3::new(1.0, -9.0, 2.0),
    }
}

#[test]
fn inertia() {
    for size in SIZES {
        for pushed in [false, true] {
            same(&State::sheet(size), |level, state, _| {
                verlet().step(
                    level,
                    &mut state.position,
                    &mut state.previous,
                    &mut state.lost,
                    pushed.then_some(&state.acceleration),
                    &state.inv_mass,
                    0..state.inv_mass.len(),
                );
            });
        }
    }
}

#[test]
fn viscosity() {
    for size in SIZES {
        for pushed in [false, true] {
            same(&State::sheet(size), |level, state, cuts| {
                let rows = blocks(state.rows, cuts);
                let rigid = RigidMotion {
                    center: Vec3::ONE,
                    displacement: Vec3::new(0.01, -0.02, 0.03),
                    rotation: Vec3::new(0.03, 0.01, -0.02),
                };
                let motion = SheetMotion {
                    sheet: Sheet {
                        columns: state.columns,
                        rows: state.rows,
                        position: SharedPoints::new(&mut state.position),
                        inv_mass: Shared::new(&mut state.inv_mass),
                        normal: None,
                        pressed: None,
                        give: Give::default(),
                        lengths: None,
                    },
                    previous: SharedPoints::new(&mut state.previous),
                    lost: SharedPoints::new(&mut state.lost),
                    acceleration: pushed.then_some(&state.acceleration),
                    conductance: 0.1,
                    rigid,
                    verlet: verlet(),
                };
                let saved: Vec<[Vec<f32>; 2]> = rows
                    .iter()
                    .map(|block| {
                        [block.start, block.end - 1].map(|row| {
                            let mut saved = vec![0.0; motion.saved_len()];
                            motion.save_row(level, row, &mut saved);
                            saved
                        })
                    })
                    .collect();
                // In any order.
                for (k, block) in rows.iter().enumerate().rev() {
                    let beside = Beside {
                        above: k.checked_sub(1).map(|k| saved[k][1].as_slice()),
                        below: saved.get(k + 1).map(|rows| rows[0].as_slice()),
                    };
                    motion.sweep(level, block.clone(), beside);
                }
            });
        }
    }
}

#[test]
fn viscosity_keeps_momentum_and_is_inertia_without_it() {
    let motion_of = |state: &mut State, conductance: f32, rigid: RigidMotion| {
        let rows = state.rows;
        let motion = SheetMotion {
            sheet: Sheet {
                columns: state.columns,
                rows,
                position: SharedPoints::new(&mut state.position),
                inv_mass: Shared::new(&mut state.inv_mass),
                normal: None,
                pressed: None,
                give: Give::default(),
                lengths: None,
            },
            previous: SharedPoints::new(&mut state.previous),
            lost: SharedPoints::new(&mut state.lost),
            acceleration: None,
            conductance,
            rigid,
            verlet: verlet(),
        };
        motion.sweep(Level::new(), 0..rows, Beside::default());
    };
    let mut start = State::sheet([17, 33]);
    start.inv_mass.fill(2.0);
    let still = RigidMotion::default();
    let [mut plain, mut damped] = [start.clone(), start.clone()];
    motion_of(&mut plain, 0.0, still);
    motion_of(&mut damped, 0.1, still);
    let sum = |state: &State| {
        (0..state.position.len()).fold(Vec3::ZERO, |s, i| {
            s + state.position.get(i) - state.previous.get(i)
        })
    };
    assert!(sum(&plain).distance(sum(&damped)) < 1e-3);
    let mut expected = start.clone();
    verlet().step(
        Level::new(),
        &mut expected.position,
        &mut expected.previous,
        &mut expected.lost,
        None,
        &expected.inv_mass,
        0..expected.inv_mass.len(),
    );
    assert!(plain.bits() == expected.bits());
    assert!(damped.bits() != expected.bits());
}

#[test]
fn colliders() {
    let sphere = MovingSphere {
        from: Vec3::new(1.0, -1.0, -2.5),
        to: Vec3::new(1.1, -1.0, -2.4),
        rotation: Vec3::new(0.1, 0.0, 0.2),
        radius: 3.1,
        friction: 0.4,
    };
    let plane = MovingHalfSpace {
        from: Vec3::ZERO,
        to: Vec3::Z * 0.01,
        normal: Vec3::new(0.0, 0.6, 0.8),
        margin: 0.02,
        friction: 0.3,
    };
    for size in SIZES {
        for (phase, noted) in [
            (Phase::Approach, true),
            (Phase::Final, true),
            (Phase::Final, false),
        ] {
            for flat in [false, true] {
                same(&State::sheet(size), |level, state, _| {
                    let n = state.inv_mass.len();
                    let contacts = noted.then(|| {
                        (
                            SharedPoints::new(&mut state.normal),
                            Shared::new(&mut state.depth),
                        )
                    });
                    let particles = Touching {
                        position: SharedPoints::new(&mut state.position),
                        previous: SharedPoints::new(&mut state.previous),
                        inv_mass: Shared::new(&mut state.inv_mass),
                        contacts,
                        phase,
                        out: Out {
                            most: f32::INFINITY,
                            overlaps: &std::sync::atomic::AtomicBool::new(false),
                        },
                    };
                    let any = if flat {
                        half_space::collide_all(level, &plane, particles, 0..n)
                    } else {
                        sphere::collide_all(level, &sphere, particles, 0..n)
                    };
                    assert!(any);
                });
            }
        }
    }
}

#[test]
fn bounds() {
    let State {
        position, previous, ..
    } = State::sheet([17, 33]);
    let all = levels().into_iter();
    let all: Vec<_> = all
        .map(|level| range::bounds(level, [&position, &previous], 0..position.len()))
        .collect();
    assert!(all.iter().all(|one| *one == all[0]));
}

#[test]
fn limits() {
    for size in SIZES {
        let start = State::sheet(size);
        let count = start.inv_mass.len();
        let spread = |seed: u64, size: f32| -> Vec<f32> {
            (0..count).map(|i| size * random(i, seed)).collect()
        };
        let (most, distance, radius) = (spread(30, 0.5), spread(31, 0.2), spread(32, 2.0));
        let normals = [40, 43].map(|seed| noise(count, seed, 2.0));
        for behind in [false, true] {
            same(&start, |level, state, cuts| {
                let targets = [&start.previous, &start.position];
                let limits = Limits {
                    targets,
                    fractions: (0.25, 0.5),
                    max_distance: &most,
                    backstop: behind.then_some(Backstop {
                        normals: [&normals[0], &normals[1]],
                        distance: &distance,
                        radius: &radius,
                    }),
                };
                state.position = noise(count, 50, 3.0);
                let position = SharedPoints::new(&mut state.position);
                let previous = SharedPoints::new(&mut state.previous);
                let inv_mass = Shared::new(&mut state.inv_mass);
                for block in blocks(count, cuts) {
                    limit::hold(level, limits, position, previous, inv_mass, block);
                }
            });
        }
    }
}
