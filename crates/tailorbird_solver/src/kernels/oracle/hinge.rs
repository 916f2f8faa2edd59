//! Hinges: one projection of the vector constraint Σ Kᵢ xᵢ = 0, or of that of a length.

use crate::properties::*;
use bevy_math::{DVec3, Vec3};

use super::{cases, momentum, vector};
use crate::{
    kernels::{
        hinge::{HingePass, Hinges},
        packed::with_packed,
    },
    points::Points,
};

#[derive(Clone, Debug)]
struct Hinge {
    corners: [Vec3; 4],
    inv_mass: [f32; 4],
    /// Kᵢ, whose sum is 0.
    coefficients: [f32; 4],
    area: f32,
    pass: HingePass,
    /// Length of D, where the hinge is folded at rest \[m\].
    rest_length: Option<f32>,
}

impl Hinge {
    fn solved(&self) -> Vec<DVec3> {
        let mut position: Points = self.corners.into_iter().collect();
        let hinges = Hinges {
            particles: &[[0, 1, 2, 3]],
            coefficients: &[self.coefficients],
            areas: &[self.area],
        };
        with_packed(&mut position, &self.inv_mass, |all| {
            match self.rest_length {
                Some(length) => self.pass.solve_curved(hinges, &[length], all),
                None => self.pass.solve_flat(hinges, all),
            }
        });
        position.iter().map(Vec3::as_dvec3).collect()
    }

    fn start(&self) -> Vec<DVec3> {
        self.corners.map(Vec3::as_dvec3).to_vec()
    }

    fn bending(&self, x: &[DVec3]) -> DVec3 {
        let k = self.coefficients.map(f64::from);
        (1..4).map(|i| k[i] * (x[i] - x[0])).sum()
    }

    fn normal(&self) -> DVec3 {
        let x = self.start();
        (x[1] - x[0]).cross(x[3] - x[2])
    }

    /// C = D, or D − L u with u along D on the side of the normal.
    fn constraint(&self) -> DVec3 {
        let d = self.bending(&self.start());
        match self.rest_length {
            Some(length) => {
                let side = if d.dot(self.normal()) < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                d - d.normalize() * side * f64::from(length)
            }
            None => d,
        }
    }

    /// W = Σ w K².
    fn own(&self) -> f64 {
        let all = self.inv_mass.iter().zip(&self.coefficients);
        all.map(|(w, k)| f64::from(*w) * f64::from(*k).powi(2))
            .sum()
    }

    /// Δx = w K λ with λ = −C/max(α̃ + W/2, W).
    fn wanted(&self) -> Vec<DVec3> {
        let h = f64::from(self.pass.seconds);
        let alpha = f64::from(self.pass.bend_compliance) * f64::from(self.area) / (h * h);
        let lambda = -self.constraint() / (alpha + 0.5 * self.own()).max(self.own());
        let push = |i: usize| f64::from(self.inv_mass[i]) * f64::from(self.coefficients[i]);
        let moved = self.start().into_iter().enumerate();
        moved.map(|(i, x)| x + push(i) * lambda).collect()
    }
}

prop_compose! {
    fn hinges()(
        corners in [vector(1.0), vector(1.0), vector(1.0), vector(1.0)],
        inv_mass in [0.1_f32..3.0, 0.1_f32..3.0, 0.1_f32..3.0, 0.1_f32..3.0],
        held in prop::option::of(0_usize..4),
        k in [0.2_f32..2.0, -2.0_f32..-0.2, -2.0_f32..-0.2],
        area in 0.1_f32..2.0,
        compliance in prop_oneof![Just(0.0_f32), 1e-6_f32..1e-3],
        rest_length in prop::option::of(-1.0_f32..1.0),
    ) -> Hinge {
        let mut inv_mass = inv_mass;
        if let Some(held) = held {
            inv_mass[held] = 0.0;
        }
        Hinge {
            corners,
            inv_mass,
            coefficients: [-(k[0] + k[1] + k[2]), k[0], k[1], k[2]],
            area,
            // α̃ of up to 4 kg⁻¹, which is what W is.
            pass: HingePass { bend_compliance: compliance, seconds: 1.0 / 64.0 },
            rest_length,
        }
    }
}

/// Numbers up to 8, a dozen operations, divided by a W of 0.01 at least times w K of 6.
const MOST: f64 = 1e-5;

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn a_hinge_is_projected_as_stated(hinge in hinges()) {
        prop_assume!(hinge.own() > 0.05);
        let d = hinge.bending(&hinge.start());
        if hinge.rest_length.is_some() {
            // Where the side is in doubt, and where there is no direction.
            let across = d.dot(hinge.normal()).abs();
            prop_assume!(d.length() > 0.05 && across > 1e-4);
        }
        for (is, wanted) in hinge.solved().iter().zip(hinge.wanted()) {
            prop_assert!(is.distance(wanted) < MOST, "{is} {wanted}");
        }
    }

    /// Rigid: afterwards the constraint holds, along D as it lay, and the push is the least that does it (Gauss).
    #[test]
    fn a_rigid_hinge_ends_where_its_constraint_holds(hinge in hinges()) {
        let pass = HingePass { bend_compliance: 0.0, ..hinge.pass };
        let hinge = Hinge { pass, inv_mass: hinge.inv_mass.map(|w| w.max(0.1)), ..hinge };
        prop_assume!(hinge.bending(&hinge.start()).length() > 0.05);
        let solved = hinge.solved();
        let left = hinge.bending(&solved).length() - f64::from(hinge.rest_length.unwrap_or(0.0)).abs();
        prop_assert!(left.abs() < MOST, "{left}");
        let sum = momentum(&hinge.start(), &solved, &hinge.inv_mass);
        prop_assert!(sum.length() < 40.0 * MOST, "{sum}");
    }

    #[test]
    fn a_hinge_at_rest_is_left_alone_wherever_it_is(hinge in hinges(), at in vector(50.0)) {
        // All in one place, and where D is as long as at rest.
        let one = Hinge { corners: [at; 4], rest_length: None, ..hinge.clone() };
        prop_assert_eq!(one.solved(), one.start());
        let d = hinge.bending(&hinge.start());
        prop_assume!(d.length() > 0.05 && d.dot(hinge.normal()).abs() > 1e-4 && hinge.own() > 0.05);
        let length = d.length().copysign(d.dot(hinge.normal())) as f32;
        let folded = Hinge { rest_length: Some(length), ..hinge };
        for (is, was) in folded.solved().iter().zip(folded.start()) {
            prop_assert!(is.distance(was) < MOST, "{is} {was}");
        }
    }
}

/// D of less than a millionth of its rest length is put along the normal, at once in its full length.
#[test]
fn a_hinge_that_is_flat_to_a_millionth_has_no_direction_of_its_own() {
    for (d, own) in [(0.0, false), (0.95e-6, false), (1.05e-6, true)] {
        let hinge = Hinge {
            // D = x₁ − x₀, and a normal along y.
            corners: [Vec3::ZERO, Vec3::X * 2.0 * d, Vec3::ZERO, Vec3::Z],
            inv_mass: [1.0; 4],
            coefficients: [-1.0, 1.0, 0.0, 0.0],
            area: 1.0,
            pass: HingePass {
                bend_compliance: 0.0,
                seconds: 1.0,
            },
            rest_length: Some(2.0),
        };
        let solved = hinge.solved();
        // X × Z = −Y.
        let direction = if own {
            DVec3::X
        } else if d > 0.0 {
            DVec3::NEG_Y
        } else {
            DVec3::ZERO
        };
        let is = solved[1] - solved[0];
        assert!(is.distance(2.0 * direction) < 1e-5, "{d}: {is}");
    }
}
