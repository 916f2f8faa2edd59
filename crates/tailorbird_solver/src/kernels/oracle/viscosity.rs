//! Viscosity: neighbours exchange momentum in proportion to the difference of their velocities.

use crate::properties::*;
use bevy_math::{DVec3, Vec3};
use fearless_simd::Level;

use super::{Cloth, cases, cloths, momentum, vector};
use crate::{
    kernels::{
        lanes::SharedPoints,
        rigid_motion::RigidMotion,
        verlet::Verlet,
        viscosity::{Beside, LARGEST, SheetMotion},
    },
    points::Points,
};

/// A sheet, and the motion of its particles.
#[derive(Clone, Debug)]
struct Moving {
    cloth: Cloth,
    previous: Vec<Vec3>,
    acceleration: Option<Vec<Vec3>>,
    conductance: f32,
    rigid: RigidMotion,
    verlet: Verlet,
}

impl Moving {
    /// Displacement of each particle, rounding error included.
    fn displacements(&self) -> Vec<DVec3> {
        let mut previous: Points = self.previous.iter().copied().collect();
        let mut lost = Points::zeroed(self.previous.len());
        let acceleration = (self.acceleration.as_ref()).map(|all| all.iter().copied().collect());
        let moved = self.cloth.solved(|sheet| {
            let motion = SheetMotion {
                sheet,
                previous: SharedPoints::new(&mut previous),
                lost: SharedPoints::new(&mut lost),
                acceleration: acceleration.as_ref(),
                conductance: self.conductance,
                rigid: self.rigid,
                verlet: self.verlet,
            };
            motion.sweep(Level::new(), 0..sheet.rows, Beside::default());
        });
        let start = self.cloth.position.iter().map(|p| p.as_dvec3());
        let moved = moved.iter().zip(start).zip(lost.iter());
        moved
            .map(|((to, from), lost)| *to - from + lost.as_dvec3())
            .collect()
    }

    fn velocity(&self, i: usize) -> DVec3 {
        self.cloth.position[i].as_dvec3() - self.previous[i].as_dvec3()
    }

    /// x − x⁻, less the displacement by rigid motion.
    fn own_velocity(&self, i: usize) -> DVec3 {
        let RigidMotion {
            center,
            displacement,
            rotation,
        } = self.rigid;
        let from_center = self.cloth.position[i].as_dvec3() - center.as_dvec3();
        self.velocity(i) - (displacement.as_dvec3() + rotation.as_dvec3().cross(from_center))
    }

    fn neighbors(&self, i: usize) -> Vec<usize> {
        let Cloth { columns, rows, .. } = self.cloth;
        let (column, row) = (i % columns, i / columns);
        let beside = [
            (column > 0, i.wrapping_sub(1)),
            (column + 1 < columns, i + 1),
        ];
        let rows = [
            (row > 0, i.wrapping_sub(columns)),
            (row + 1 < rows, i + columns),
        ];
        let all = beside.into_iter().chain(rows);
        all.filter(|(is, _)| *is).map(|(_, j)| j).collect()
    }

    /// d (x − x⁻ + w κ Σ (v′ − v)) + a h² of a free particle, d = e^(−damping · h).
    fn wanted(&self, i: usize) -> DVec3 {
        let w = f64::from(self.cloth.inv_mass[i]);
        if w == 0.0 {
            return DVec3::ZERO;
        }
        let own = self.own_velocity(i);
        let differ: DVec3 = self
            .neighbors(i)
            .iter()
            .map(|j| self.own_velocity(*j) - own)
            .sum();
        let h = f64::from(self.verlet.seconds);
        let of_air = self.acceleration.as_ref().map_or(Vec3::ZERO, |all| all[i]);
        let acceleration = self.verlet.gravity.as_dvec3() + of_air.as_dvec3();
        let kept = (-f64::from(self.verlet.damping) * h).exp();
        kept * (self.velocity(i) + w * f64::from(self.conductance) * differ) + acceleration * h * h
    }
}

const STILL: Verlet = Verlet {
    seconds: 0.01,
    seconds_before: 0.01,
    damping: 0.0,
    gravity: Vec3::ZERO,
};

prop_compose! {
    fn moving()(cloth in cloths(0.2, false, false))(
        moved in prop::collection::vec(vector(0.1), cloth.position.len()),
        acceleration in prop::option::of(prop::collection::vec(vector(20.0), cloth.position.len())),
        conductance in 0.0_f32..0.1,
        turn in [vector(0.1), vector(0.1), vector(5.0)],
        gravity in vector(10.0),
        damping in 0.0_f32..20.0,
        cloth in Just(cloth),
    ) -> Moving {
        Moving {
            previous: cloth.position.iter().zip(moved).map(|(p, moved)| p - moved).collect(),
            cloth,
            acceleration,
            conductance,
            rigid: RigidMotion { displacement: turn[0], rotation: turn[1], center: turn[2] },
            verlet: Verlet { gravity, damping, ..STILL },
        }
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// Coordinates below 32 have velocities that are exact but for the rigid motion, whose parts are below 10 m.
    #[test]
    fn a_substep_without_constraints_is_as_stated(moving in moving()) {
        for (i, is) in moving.displacements().into_iter().enumerate() {
            let wanted = moving.wanted(i);
            prop_assert!(is.distance(wanted) < 8e-6, "{i}: {is} {wanted}");
        }
    }

    #[test]
    fn neighbours_of_a_sheet_keep_their_momentum(moving in moving()) {
        let mut moving = Moving { acceleration: None, verlet: STILL, ..moving };
        for w in &mut moving.cloth.inv_mass {
            *w = w.max(0.2);
        }
        let start: Vec<_> = (0..moving.previous.len()).map(|i| moving.velocity(i)).collect();
        let sum = momentum(&start, &moving.displacements(), &moving.cloth.inv_mass);
        prop_assert!(sum.length() < 5.0 * 8e-6 * (start.len() as f64), "{sum}");
    }

    /// A cloth in rigid motion is not slowed, whatever the conductance.
    #[test]
    fn rigid_motion_is_not_slowed(moving in moving()) {
        let mut moving = Moving { acceleration: None, verlet: STILL, conductance: 0.5, ..moving };
        let RigidMotion { center, displacement, rotation } = moving.rigid;
        for (previous, p) in moving.previous.iter_mut().zip(&moving.cloth.position) {
            let from_center = p.as_dvec3() - center.as_dvec3();
            let moved = displacement.as_dvec3() + rotation.as_dvec3().cross(from_center);
            *previous = (p.as_dvec3() - moved).as_vec3();
        }
        for (i, is) in moving.displacements().into_iter().enumerate() {
            let wanted = if moving.cloth.inv_mass[i] == 0.0 { DVec3::ZERO } else { moving.velocity(i) };
            // Eight differences, of which each is off by 2 · 10⁻⁶.
            prop_assert!(is.distance(wanted) < 3e-5, "{i}: {is} {wanted}");
        }
    }

    /// Energy beyond that of rigid motion falls for as long as c is no more than `LARGEST`.
    #[test]
    fn viscosity_takes_energy(moving in moving(), c in 0.01_f32..1.0) {
        let mut moving = Moving { acceleration: None, verlet: STILL, ..moving };
        moving.rigid = RigidMotion::default();
        moving.conductance = 0.25 * c * LARGEST;
        // Of mass 1, half of it at the border, and a quarter in corners.
        let n = moving.previous.len();
        for i in 0..n {
            let Cloth { columns, rows, .. } = moving.cloth;
            let half = |k: usize, of: usize| if k == 0 || k + 1 == of { 2.0 } else { 1.0 };
            moving.cloth.inv_mass[i] = half(i % columns, columns) * half(i / columns, rows);
        }
        let energy = |v: &[DVec3]| -> f64 {
            let each = v.iter().zip(&moving.cloth.inv_mass);
            each.map(|(v, w)| v.length_squared() / f64::from(*w)).sum()
        };
        let before: Vec<_> = (0..n).map(|i| moving.velocity(i)).collect();
        prop_assert!(energy(&moving.displacements()) < energy(&before));
    }
}

/// A corner, with a quarter of the mass and two neighbours, comes to where its neighbours are.
#[test]
fn the_largest_viscosity_takes_a_corner_along_with_its_neighbours() {
    let cloth = Cloth {
        columns: 2,
        rows: 2,
        position: vec![Vec3::ZERO, Vec3::X, Vec3::NEG_Y, Vec3::X - Vec3::Y],
        inv_mass: vec![4.0; 4],
        normal: Vec::new(),
        lengths: [const { Vec::new() }; 2],
    };
    let moved = [Vec3::ZERO, Vec3::Z, Vec3::Z, Vec3::ZERO];
    let moving = Moving {
        previous: cloth
            .position
            .iter()
            .zip(moved)
            .map(|(p, v)| p - v)
            .collect(),
        cloth,
        acceleration: None,
        conductance: 0.25 * LARGEST,
        rigid: RigidMotion::default(),
        verlet: STILL,
    };
    let is = moving.displacements();
    for (i, z) in [1.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
        assert!(is[i].distance(DVec3::Z * z) < 1e-6, "{i}: {}", is[i]);
    }
}
