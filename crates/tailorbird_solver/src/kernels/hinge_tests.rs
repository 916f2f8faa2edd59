use std::f32::consts::TAU;

use crate::properties::*;
use bevy_math::Quat;

use super::*;
use crate::{kernels::packed::with_packed, points::Points, topology::hinges::HingeConstraints};

const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [1, 0, 3]];

fn solve(hinges: &HingeConstraints, pass: HingePass, w: &[f32], at: &mut Points) {
    with_packed(at, w, |all| {
        for batch in &hinges.batches {
            let range = batch.range.clone();
            let slices = Hinges {
                particles: &hinges.particles[range.clone()],
                coefficients: &hinges.coefficients[range.clone()],
                areas: &hinges.areas[range.clone()],
            };
            if batch.flat {
                pass.solve_flat(slices, all);
            } else {
                pass.solve_curved(slices, &hinges.rest_lengths[range], all);
            }
        }
    });
}

fn rigid() -> HingePass {
    HingePass {
        bend_compliance: 0.0,
        seconds: 1.0 / 480.0,
    }
}

/// Two triangles that share an edge of length 1 and are folded by `angle` \[rad\] along it.
fn folded(angle: f32) -> [Vec3; 4] {
    let (sin, cos) = angle.sin_cos();
    [
        Vec3::ZERO,
        Vec3::Y,
        Vec3::new(-0.8, 0.3, 0.0),
        Vec3::new(0.9 * cos, 0.6, 0.9 * sin),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #[test]
    fn rigid_motion_bends_nothing(
        angle in -2.5f32..2.5, axis in point(), turn in 0.0f32..TAU, shift in point(),
    ) {
        prop_assume!(axis.length() > 0.1);
        for angle in [angle, 1e-4 * angle, 0.0] {
            let rest = folded(angle);
            let hinges = HingeConstraints::new(&TRIANGLES, &rest);
            // A fold that is too slight to tell from none is made flat.
            let tolerance = 1e-5 + if hinges.batches[0].flat { angle.abs() } else { 0.0 };
            let turn = Quat::from_axis_angle(axis.normalize(), turn);
            let moved: Points = rest.into_iter().map(|p| turn * p + shift).collect();
            let mut position = moved.clone();
            solve(&hinges, rigid(), &[1.0, 2.0, 0.5, 1.0], &mut position);
            for (p, q) in position.iter().zip(moved.iter()) {
                prop_assert!(p.distance(q) < tolerance, "{p} {q}");
            }
        }
    }

    #[test]
    fn momentum_and_angular_momentum_are_kept(
        rest_angle in -1.0f32..1.0, corners in prop::collection::vec(point(), 4),
        w in prop::collection::vec(0.1f32..10.0, 4), compliance in 0.0f32..1e-3,
    ) {
        for rest_angle in [rest_angle, 0.0] {
            let hinges = HingeConstraints::new(&TRIANGLES, &folded(rest_angle));
            let before: Points = corners.iter().copied().collect();
            let mut position = before.clone();
            let pass = HingePass { bend_compliance: compliance, ..rigid() };
            solve(&hinges, pass, &w, &mut position);
            let (mut momentum, mut spin, mut size) = (Vec3::ZERO, Vec3::ZERO, 0.0);
            for (i, w) in w.iter().enumerate() {
                let impulse = (position.get(i) - before.get(i)) / w;
                momentum += impulse;
                spin += before.get(i).cross(impulse);
                size += impulse.length() + 0.1 / w;
            }
            prop_assert!(momentum.length() < 1e-5 * size, "{momentum}");
            prop_assert!(spin.length() < 1e-5 * size, "{spin}");
        }
    }

    #[test]
    fn nothing_turns_into_nan(corners in prop::collection::vec(point(), 4), held in 0u8..16, pick in 0usize..4) {
        let w: Vec<f32> = (0..4).map(|i| f32::from(held >> i & 1)).collect();
        let mut collapsed = corners.clone();
        collapsed[pick] = collapsed[(pick + 1) % 4];
        for corners in [corners, collapsed, vec![Vec3::ONE; 4]] {
            for rest_angle in [0.0, 0.7] {
                for bend_compliance in [0.0, 1e4, f32::INFINITY] {
                    let hinges = HingeConstraints::new(&TRIANGLES, &folded(rest_angle));
                    let before: Points = corners.iter().copied().collect();
                    let mut position = before.clone();
                    let pass = HingePass { bend_compliance, ..rigid() };
                    solve(&hinges, pass, &w, &mut position);
                    prop_assert!(position.iter().all(Vec3::is_finite));
                    for i in (0..4).filter(|&i| w[i] == 0.0) {
                        prop_assert_eq!(position.get(i), before.get(i));
                    }
                }
            }
        }
    }
}

#[test]
fn a_fold_is_restored_from_either_side_and_from_flat() {
    for rest_angle in [0.8f32, -0.8] {
        let hinges = HingeConstraints::new(&TRIANGLES, &folded(rest_angle));
        for angle in [0.0, 0.3, -0.3, 1.5] {
            let mut position = Points::from_iter(folded(angle));
            for _ in 0..400 {
                solve(&hinges, rigid(), &[1.0; 4], &mut position);
            }
            let corners = [0, 1, 2, 3].map(|i| position.get(i));
            let packed = corners.map(|p| p.extend(0.0));
            let d = bending(hinges.coefficients[0].map(Vec4::splat), packed).truncate();
            let normal = (corners[1] - corners[0]).cross(corners[3] - corners[2]);
            let signed = d.length().copysign(d.dot(normal));
            assert!(
                (signed - hinges.rest_lengths[0]).abs() < 1e-4,
                "{rest_angle} {angle}: {signed}"
            );
        }
    }
}

/// A strip of `columns` × 4 square cells, clamped at its first two columns; `flip` says how its cells are cut. Its inner particles are
/// moved in the plane by up to `jitter` cells.
struct Strip {
    hinges: HingeConstraints,
    position: Points,
    inv_mass: Vec<f32>,
    columns: usize,
}

const CELL: f32 = 0.01;
const ROWS: usize = 4;
const AREAL_DENSITY: f32 = 0.15;

impl Strip {
    fn new(columns: usize, jitter: f32, flip: impl Fn(usize, usize) -> bool) -> Self {
        let side = columns + 1;
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let rest: Vec<Vec3> = (0..side * (ROWS + 1))
            .map(|i| {
                let (column, row) = (i % side, i / side);
                let inner = column > 1 && column < columns && row > 0 && row < ROWS;
                let jitter = if inner { jitter } else { 0.0 };
                let moved = jitter * Vec3::new(random(), 0.0, random());
                (Vec3::new(column as f32, 0.0, row as f32) + moved) * CELL
            })
            .collect();
        let mut triangles = Vec::new();
        for row in 0..ROWS {
            for column in 0..columns {
                let a = (row * side + column) as u32;
                let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
                triangles.extend(if flip(column, row) {
                    [[a, b, c], [b, d, c]]
                } else {
                    [[a, b, d], [a, d, c]]
                });
            }
        }
        let mut mass = vec![0.0; rest.len()];
        for &[a, b, c] in &triangles {
            let [p, q, r] = [a, b, c].map(|i| rest[i as usize]);
            let third = AREAL_DENSITY * (q - p).cross(r - p).length() / 6.0;
            for i in [a, b, c] {
                mass[i as usize] += third;
            }
        }
        let inv_mass = (0..rest.len())
            .map(|i| if i % side < 2 { 0.0 } else { 1.0 / mass[i] })
            .collect();
        Self {
            hinges: HingeConstraints::new(&triangles, &rest),
            position: rest.into_iter().collect(),
            inv_mass,
            columns,
        }
    }

    /// Deflection of the free end, over that at which energy and weight are in balance.
    fn sag(mut self, rigidity: f32, gravity: f32) -> f32 {
        let balance = self.balance() * gravity / rigidity;
        let pass = HingePass {
            bend_compliance: 1.0 / rigidity,
            seconds: 1.0 / 480.0,
        };
        let mut previous = self.position.clone();
        for _ in 0..20_000 {
            for i in 0..self.inv_mass.len() {
                if self.inv_mass[i] > 0.0 {
                    let now = self.position.get(i);
                    let step = 0.98 * (now - previous.get(i))
                        + gravity * pass.seconds * pass.seconds * Vec3::NEG_Y;
                    previous.set(i, now);
                    self.position.set(i, now + step);
                }
            }
            solve(&self.hinges, pass, &self.inv_mass, &mut self.position);
        }
        -self.end(|i| self.position.y[i]) / balance
    }

    /// Mean over the free end.
    fn end(&self, of: impl Fn(usize) -> f32) -> f32 {
        let side = self.columns + 1;
        (0..=ROWS)
            .map(|row| of(row * side + self.columns))
            .sum::<f32>()
            / (ROWS + 1) as f32
    }

    /// Deflection of the free end at which the derivative of energy and weight is 0, for B = 1 N m and 1 m/s²: conjugate gradients in
    /// double precision.
    fn balance(&self) -> f32 {
        let free = |i: usize| self.inv_mass[i] > 0.0;
        let n = self.inv_mass.len();
        let stiffness = |z: &[f64]| {
            let mut force = vec![0.0f64; n];
            for (k, particles) in self.hinges.particles.iter().enumerate() {
                let coefficients = self.hinges.coefficients[k].map(f64::from);
                let d: f64 = (0..4)
                    .map(|i| coefficients[i] * z[particles[i] as usize])
                    .sum();
                for i in (0..4).filter(|&i| free(particles[i] as usize)) {
                    force[particles[i] as usize] +=
                        coefficients[i] * d / f64::from(self.hinges.areas[k]);
                }
            }
            force
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut rest: Vec<f64> = (0..n)
            .map(|i| {
                if free(i) {
                    f64::from(1.0 / self.inv_mass[i])
                } else {
                    0.0
                }
            })
            .collect();
        let (mut z, mut along) = (vec![0.0; n], rest.clone());
        for _ in 0..20 * n {
            let pull = stiffness(&along);
            let before = dot(&rest, &rest);
            let step = before / dot(&along, &pull);
            if !step.is_finite() {
                break;
            }
            for i in 0..n {
                z[i] += step * along[i];
                rest[i] -= step * pull[i];
            }
            let turn = dot(&rest, &rest) / before;
            for i in 0..n {
                along[i] = rest[i] + turn * along[i];
            }
        }
        self.end(|i| z[i] as f32)
    }
}

#[test]
fn a_strip_of_zigzag_triangles_is_the_beam_of_its_rigidity() {
    let strip = Strip::new(16, 0.0, |_, row| row % 2 == 0);
    // The edge between the clamped columns and the next ones bends, half a cell before it.
    let length = 15.5 * CELL;
    let beam = AREAL_DENSITY * length.powi(4) / 8.0;
    let ratio = strip.balance() / beam;
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn a_strip_sags_as_its_rigidity_says() {
    // At 4e-5 N m, α̃/W is 2 for the rows and 1 for the diagonals, at 1e-5 N m four times that.
    for (rigidity, tolerance) in [(1e-5, 0.03), (2e-5, 0.03), (4e-5, 0.1)] {
        let flips: [fn(usize, usize) -> bool; 4] = [
            |_, _| false,
            |_, row| row % 2 == 0,
            |column, row| (column + row) % 2 == 0,
            |column, row| (column * 7 + row * 13) % 5 < 2,
        ];
        for (flip, jitter) in flips.into_iter().zip([0.0, 0.0, 0.0, 0.25]) {
            let sag = Strip::new(16, jitter, flip).sag(rigidity, 4e3 * rigidity);
            assert!((sag - 1.0).abs() < tolerance, "{rigidity} {jitter}: {sag}");
        }
    }
}
