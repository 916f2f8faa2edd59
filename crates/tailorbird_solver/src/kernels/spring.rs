//! Springs of zero length between particles and fixed anchors, solved together with all other constraints.
//!
//! A spring of compliance α pulls a particle at distance C from its anchor with C/α. In XPBD's terms, with α̃ = α/h² and inverse mass w,
//! its multiplier is λ = −C/α̃, and alone it would leave C α̃/(w + α̃).
//!
//! Solved after the lines it would fight them: they would move the particle as if it were free, by the load of the whole cloth, and the
//! spring would take it back. So it is eliminated from the system instead (the Schur complement). The particle is first put where its
//! spring alone would hold it, and then takes part in all other constraints with the inverse mass w α̃/(w + α̃): the displacement for a
//! unit impulse against its spring. After them C is that of the joint solution, and C/α the force. Compliance 0 gives inverse mass 0: a
//! kinematic particle.

/// α̃/(w + α̃): the part that a particle keeps of its distance from the anchor, and of its inverse mass [1/kg].
#[inline]
pub fn left(inv_mass: f32, alpha_tilde: f32) -> f32 {
    if alpha_tilde > 0.0 {
        1.0 / (1.0 + inv_mass / alpha_tilde)
    } else {
        0.0
    }
}

/// α̃ = α/h² [1/kg] of a compliance [m/N].
pub fn alpha_tilde(compliance: f32, seconds: f32) -> f32 {
    // An infinite value would turn into NaN in the product with a multiplier of 0.
    (compliance.max(0.0) / (seconds * seconds)).min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use crate::properties::*;

    use super::*;

    proptest! {
        /// Tests a particle at a spring and at a rod that pulls it with a given impulse: the spring's multiplier is in balance with both
        /// inertia and the rod.
        #[test]
        fn the_joint_solution_is_in_balance(
            w in 1e-1f32..1e4, alpha_tilde in 1e-1f32..1e4, inertia in -1.0f32..1.0, impulse in -1.0f32..1.0,
        ) {
            let kept = left(w, alpha_tilde);
            let x = inertia * kept + w * kept * impulse;
            // x = inertia + w (impulse − x/α̃)
            let balance = inertia + w * (impulse - x / alpha_tilde);
            let size = inertia.abs() + w * impulse.abs();
            prop_assert!((x - balance).abs() < 1e-5 * size * (1.0 + w / alpha_tilde), "{x} {balance}");
        }
    }

    #[test]
    fn the_ends_of_the_range() {
        assert_eq!(left(100.0, 0.0), 0.0);
        assert_eq!(left(0.0, 1.0), 1.0);
        assert_eq!(left(100.0, f32::MAX), 1.0);
        assert!(left(1.0, f32::MIN_POSITIVE) < 1e-30);
        assert_eq!(left(f32::MAX, f32::MIN_POSITIVE), 0.0);
    }

    #[test]
    fn a_compliance_by_the_square_of_a_step_is_finite() {
        assert_eq!(alpha_tilde(3.0, 0.5), 12.0);
        assert_eq!(alpha_tilde(0.0, 0.5), 0.0);
        assert_eq!(alpha_tilde(-1.0, 0.5), 0.0);
        assert_eq!(alpha_tilde(f32::MAX, 0.5), f32::MAX);
        assert_eq!(alpha_tilde(f32::INFINITY, 0.5), f32::MAX);
    }
}
