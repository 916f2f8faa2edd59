//! Bending: the vector constraint D = Σ Kᵢ xᵢ = 0 over the four particles of a hinge, by extended position-based dynamics
//! (Macklin et al. 2016), with the coefficients of [`HingeConstraints`](crate::topology::hinges::HingeConstraints).
//!
//! K is constant and the same for each axis, so that a pass over hinges that are flat at rest is linear:
//! Δλ = −C/d, Δxᵢ = wᵢ Kᵢ Δλ with C = D and no square root. Hinges that are folded at rest keep the length of D:
//! C = D − L u, where u is the unit vector along D, turned to the side to which the hinge is folded at rest.
//!
//! Since Σ Kᵢ = 0, momentum is kept; since Σ xᵢ × Kᵢ Δλ = D × Δλ and Δλ points along D, so is angular momentum.
//!
//! # The denominator
//!
//! With one pass per substep and multipliers that start at 0, XPBD divides by d = W + α̃, α̃ = α/h². That is right for a single hinge; in a
//! sheet it makes hinges too soft, all the more the finer the mesh. At rest a pass must move each particle back to the place where the
//! substep began. So a hinge does not see the value of D at the end of the pass, D*, but D* less the changes by itself and by all hinges
//! after it. Inside a sheet the bending moment varies slowly and moments of neighbours cancel: all other hinges together change D by −W λ.
//! Half of them come later, so that a hinge sees D* − W λ + ½ W λ and pushes by λ = −(D* − ½ W λ)/d. That is the −D*/α̃ of a spring of the
//! prescribed compliance if **d = α̃ + W/2**. (d = α̃ would be right if every hinge saw D*, and is too stiff by as much as W + α̃ is too
//! soft.)
//!
//! d is at least W, because a smaller d over-relaxes and gains energy. So a sheet settles at the deflection that follows from its rigidity
//! as long as α̃ ≥ W/2. A stiffer sheet is softer than prescribed, because one pass cannot make it stiffer: then more substeps are needed.
//! Solve batches in the same order in each substep; reversing the order makes stiff hinges swing.

use bevy_math::{Vec3, Vec4, Vec4Swizzles};

use super::packed::{Packed, inv_mass, of_space};

/// Ratio of D to its rest length below which D has no direction.
const SHORTEST: f32 = 1e-6;

/// Smallest denominator [1/kg], so that a hinge of four held particles does not divide by 0.
const HEAVIEST: f32 = 1e-20;

/// One pass over hinges that share no particle.
#[derive(Clone, Copy, Debug)]
pub struct HingePass {
    /// 1/B, B being the bending rigidity [1/(N m)]. 0 is rigid.
    pub bend_compliance: f32,
    /// Length of the substep, h \[s\].
    pub seconds: f32,
}

/// A batch of hinges, as parallel slices.
#[derive(Clone, Copy, Debug)]
pub struct Hinges<'a> {
    /// The four particles of each hinge.
    pub particles: &'a [[u32; 4]],
    /// Kᵢ [-].
    pub coefficients: &'a [[f32; 4]],
    /// 1/g \[m²\]: the compliance of a hinge is bend compliance × area.
    pub areas: &'a [f32],
}

impl HingePass {
    /// Bends hinges that are flat at rest.
    ///
    /// # Panics
    /// When a particle is not below the number of particles.
    pub fn solve_flat(&self, hinges: Hinges, all: &mut [Packed]) {
        self.pass(hinges, all, |_, _, d| d);
    }

    /// Bends hinges of any rest shape. `rest_lengths` \[m\] are the lengths of D at rest, with the sign of D · (x₁ − x₀) × (x₃ − x₂) at
    /// rest.
    ///
    /// # Panics
    /// When a particle is not below the number of particles.
    pub fn solve_curved(&self, hinges: Hinges, rest_lengths: &[f32], all: &mut [Packed]) {
        self.pass(hinges, all, |k, corners, d| {
            let c = away_from_rest(corners.map(Vec4::truncate), d.truncate(), rest_lengths[k]);
            c.extend(0.0)
        });
    }

    /// One pass; `constraint` computes C of hinge k from its corners and D.
    #[inline(always)]
    fn pass(
        &self,
        hinges: Hinges,
        all: &mut [Packed],
        constraint: impl Fn(usize, [Vec4; 4], Vec4) -> Vec4,
    ) {
        let compliance = self.bend_compliance / (self.seconds * self.seconds);
        let least = Vec4::splat(HEAVIEST);
        let hinges = hinges
            .particles
            .iter()
            .zip(hinges.coefficients)
            .zip(hinges.areas);
        for (number, ((particles, k), area)) in hinges.enumerate() {
            let particles = particles.map(|i| i as usize);
            let corners = particles.map(|i| Vec4::from_array(all[i]));
            let k = Vec4::from_array(*k);
            let k = [k.xxxx(), k.yyyy(), k.zzzz(), k.wwww()];

            let d = bending(k, corners);
            let c = constraint(number, corners, d);

            let [x0, x1, x2, x3] = corners.map(inv_mass);
            let pulls = [x0 * k[0], x1 * k[1], x2 * k[2], x3 * k[3]];
            let own = pulls[0] * k[0] + pulls[1] * k[1] + pulls[2] * k[2] + pulls[3] * k[3];
            let own = own.max(least);
            let denominator = (Vec4::splat(compliance * area) + own * 0.5).max(own);
            let delta = of_space(c * (Vec4::NEG_ONE / denominator));
            for i in 0..4 {
                all[particles[i]] = (corners[i] + delta * pulls[i]).to_array();
            }
        }
    }
}

/// Computes D. Differences come first: the result must not depend on the distance of the cloth from the origin.
#[inline(always)]
fn bending(k: [Vec4; 4], [x0, x1, x2, x3]: [Vec4; 4]) -> Vec4 {
    (x1 - x0) * k[1] + (x2 - x0) * k[2] + (x3 - x0) * k[3]
}

/// C of a hinge that is folded at rest. A D without a direction of its own gets that of the normal.
#[inline(always)]
fn away_from_rest([x0, x1, x2, x3]: [Vec3; 4], d: Vec3, rest_length: f32) -> Vec3 {
    let normal = (x1 - x0).cross(x3 - x2);
    let squared = d.length_squared();
    let shortest = SHORTEST * rest_length;
    if squared > shortest * shortest {
        let toward_normal = if d.dot(normal) < 0.0 { -1.0 } else { 1.0 };
        d - d * (toward_normal * rest_length / squared.sqrt())
    } else {
        d - normal.normalize_or_zero() * rest_length
    }
}

#[cfg(test)]
#[path = "hinge_tests.rs"]
mod tests;
