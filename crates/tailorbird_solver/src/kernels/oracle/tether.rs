//! Tethers: each particle is put back to where they are taut, one tether after the other.

use crate::properties::*;
use bevy_math::{DVec3, Vec2, Vec3};
use fearless_simd::Level;

use super::{Cloth, cases, cloths, vector};
use crate::{
    kernels::{
        lanes::{Reading, SharedPoints},
        recovery::Recovery,
        tether::{self, Straight, Tether},
    },
    points::Points,
};

/// A tether to a particle of the sheet.
#[derive(Clone, Copy, Debug)]
struct Pin {
    at: [usize; 2],
    anchor: Vec3,
    before: Vec3,
    longer: f32,
}

#[derive(Clone, Debug)]
struct Case {
    cloth: Cloth,
    /// Positions of the particles at the start of the substep.
    start: Vec<Vec3>,
    pins: Vec<Pin>,
    slack: f32,
    /// The least part, and the part of the rest, by which the square comes back.
    recovery: Option<[f32; 2]>,
}

const SPACING: Vec2 = Vec2::new(0.7, 0.8);

impl Case {
    fn distances(&self, pin: Pin) -> Straight {
        Straight {
            column: (pin.at[0] % self.cloth.columns) as u32,
            row: (pin.at[1] % self.cloth.rows) as u32,
            spacing: SPACING,
        }
    }

    /// Largest distance of a particle from a pin.
    fn reach(&self, pin: Pin, i: usize) -> f64 {
        let [column, row] = [i % self.cloth.columns, i / self.cloth.columns];
        let distances = self.distances(pin);
        let cells = [(column, distances.column), (row, distances.row)];
        let [x, y] = cells.map(|(here, there)| here as f64 - f64::from(there));
        let [dx, dy] = SPACING.to_array().map(f64::from);
        (x * dx).hypot(y * dy) * f64::from(self.slack) * f64::from(pin.longer)
    }

    fn tethers<W>(&self, of: impl Fn(Pin) -> W) -> Vec<Option<Tether<W>>> {
        let pins = self.pins.iter().map(|pin| {
            Some(Tether {
                anchor: pin.anchor,
                anchor_before: pin.before,
                longer: pin.longer,
                distances: of(*pin),
            })
        });
        pins.chain([None]).collect()
    }

    /// Positions after both kernels: by rows and columns, and by lengths.
    fn solved(&self) -> [Vec<DVec3>; 2] {
        let mut start: Points = self.start.iter().copied().collect();
        let recovery = self.recovery.map(|[least, part]| Recovery {
            start: SharedPoints::new(&mut start),
            least,
            part,
        });
        let level = Level::new();
        let n = self.cloth.position.len();
        let straight = self.tethers(|pin| self.distances(pin));
        let lengths: Vec<Vec<f32>> = (self.pins.iter())
            .map(|pin| {
                let distances = self.distances(*pin);
                let column = |i: usize| (i % self.cloth.columns) as u32;
                let row = |i: usize| (i / self.cloth.columns) as u32;
                (0..n)
                    .map(|i| distances.length(column(i), row(i)))
                    .collect()
            })
            .collect();
        let by_length = self.pins.iter().zip(&lengths).map(|(pin, lengths)| {
            Some(Tether {
                anchor: pin.anchor,
                anchor_before: pin.before,
                longer: pin.longer,
                distances: Reading(lengths),
            })
        });
        let by_length: Vec<_> = by_length.collect();
        let rows = 0..self.cloth.rows;
        let how = (self.slack, recovery);
        [
            self.cloth
                .solved(|sheet| tether::solve_straight(level, sheet, &straight, how, rows)),
            self.cloth
                .solved(|sheet| tether::solve(level, sheet, &by_length, how, 0..n)),
        ]
    }

    /// Position after s = 2 (q − l²)/(3 q + l²) times the distance to the pin, for each tether that is shorter than the distance.
    fn wanted(&self, i: usize) -> DVec3 {
        let start = self.cloth.position[i].as_dvec3();
        if self.cloth.inv_mass[i] == 0.0 {
            return start;
        }
        let mut p = start;
        for pin in &self.pins {
            let d = p - pin.anchor.as_dvec3();
            let (q, mut l2) = (d.length_squared(), self.reach(*pin, i).powi(2));
            if q <= l2 {
                continue;
            }
            if let Some([least, part]) = self.recovery {
                let q0 = (self.start[i].as_dvec3() - pin.before.as_dvec3()).length_squared();
                l2 = l2.max(q0 - (l2 * f64::from(least) + (q0 - l2) * f64::from(part)));
            }
            p -= d * (2.0 * (q - l2).max(0.0) / (3.0 * q + l2));
        }
        let n = self.cloth.normal.get(i).copied().unwrap_or(Vec3::ZERO);
        p - n.as_dvec3() * n.as_dvec3().dot(p - start)
    }
}

fn tethered(contacts: bool) -> impl Strategy<Value = Case> {
    cloths(0.3, contacts, false).prop_flat_map(|cloth| {
        let n = cloth.position.len();
        let pin = (any::<[usize; 2]>(), vector(3.0), vector(0.1), 0.9_f32..1.2).prop_map(
            |(at, anchor, moved, longer)| Pin {
                at,
                anchor,
                before: anchor + moved,
                longer,
            },
        );
        let recovery = prop::option::of([0.0_f32..0.1, 0.0_f32..0.3]);
        let moved = prop::collection::vec(vector(0.1), n);
        (
            moved,
            prop::collection::vec(pin, 1..4),
            1.0_f32..1.1,
            recovery,
        )
            .prop_map(move |(moved, pins, slack, recovery)| Case {
                start: cloth
                    .position
                    .iter()
                    .zip(moved)
                    .map(|(p, m)| p + m)
                    .collect(),
                cloth: cloth.clone(),
                pins,
                slack,
                recovery,
            })
    })
}

/// Coordinates below 32 come with an error of 10⁻⁶; each of three tethers passes the error before on, at most twice.
const MOST: f64 = 3e-5;

fn compare(case: &Case) -> Result<(), TestCaseError> {
    for solved in case.solved() {
        for (i, is) in solved.iter().enumerate() {
            let wanted = case.wanted(i);
            prop_assert!(is.distance(wanted) < MOST, "{i}: {is} {wanted}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn tethers_pull_as_stated(case in tethered(false)) {
        compare(&case)?;
    }

    #[test]
    fn what_is_in_contact_is_pulled_along_the_surface(case in tethered(true)) {
        compare(&case)?;
        for solved in case.solved() {
            for (i, is) in solved.iter().enumerate() {
                let moved = *is - case.cloth.position[i].as_dvec3();
                let off = moved.dot(case.cloth.normal[i].as_dvec3());
                prop_assert!(off.abs() < MOST, "{i}: {off}");
            }
        }
    }

    /// A particle within reach stays to the bit; of the excess e, e³/(3 (1 + e)² + 1) is left, along the line to the pin.
    #[test]
    fn what_is_beyond_reach_ends_at_it_on_the_line_to_its_pin(case in tethered(false)) {
        let case = Case { recovery: None, pins: vec![case.pins[0]], ..case };
        let anchor = case.pins[0].anchor.as_dvec3();
        for solved in case.solved() {
            for (i, is) in solved.iter().enumerate() {
                let start = case.cloth.position[i].as_dvec3();
                let reach = case.reach(case.pins[0], i);
                let (before, after) = (start - anchor, *is - anchor);
                if case.cloth.inv_mass[i] == 0.0 || before.length() < reach - 1e-5 {
                    prop_assert_eq!(*is, start);
                } else if reach > 0.0 && before.length() > reach + 1e-5 {
                    let e = before.length() / reach - 1.0;
                    let left = reach * (1.0 + e.powi(3) / (3.0 * (1.0 + e).powi(2) + 1.0));
                    prop_assert!((after.length() - left).abs() < 1e-5, "{i}: {} {left}", after.length());
                    prop_assert!(after.cross(before).length() < 1e-5 * before.length());
                }
            }
        }
    }

    /// A particle that was beyond reach when the substep began comes back by the rate alone.
    #[test]
    fn what_was_beyond_comes_back_by_the_rate(at in vector(1.0), least in 0.0_f32..0.1, part in 0.0_f32..0.2) {
        prop_assume!(at.length() > 0.1);
        let cloth = Cloth {
            columns: 2,
            rows: 2,
            position: vec![Vec3::ZERO, at.normalize() * 2.0, Vec3::ZERO, Vec3::ZERO],
            inv_mass: vec![0.0, 1.0, 0.0, 0.0],
            normal: Vec::new(),
            lengths: [const { Vec::new() }; 2],
        };
        let pin = Pin { at: [0, 0], anchor: Vec3::ZERO, before: Vec3::ZERO, longer: 1.0 / SPACING.x };
        let case = Case {
            start: cloth.position.clone(), cloth, pins: vec![pin], slack: 1.0, recovery: Some([least, part]),
        };
        // Reach 1, distance 2.
        let square = 4.0 - (f64::from(least) + 3.0 * f64::from(part));
        for solved in case.solved() {
            let is = solved[1].length_squared();
            // The excess is at most a tenth of the target, of which the cube is left.
            let e = 2.0 / square.sqrt() - 1.0;
            prop_assert!(is >= square - 1e-5 && is <= square * (1.0 + e.powi(3)) + 1e-5, "{is} {square}");
        }
    }
}
