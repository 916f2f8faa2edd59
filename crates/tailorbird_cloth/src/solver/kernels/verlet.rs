//! Verlet integration: x' = x + (x − x⁻) d + a h².
//!
//! In `f32` the sum loses the low bits of a h², which is 10⁻⁵ of x and less, and since x − x⁻ is the velocity, what is lost once
//! is missing ever after: a cloth in free fall would lag by millimetres in seconds. So what rounding takes from a displacement is
//! kept and given to the next one (as Kahan does for sums).

use bevy_math::Vec3;

use crate::points::Points;

/// One substep for all particles.
pub struct Verlet {
    /// Length of the substep, h \[s\].
    pub seconds: f32,
    /// Length of the substep before \[s\]: x − x⁻ took this long. 0 for a cloth that has not moved yet.
    pub seconds_before: f32,
    /// Rate at which velocity decays [1/s].
    pub damping: f32,
    /// Acceleration of all particles [m/s²].
    pub gravity: Vec3,
}

impl Verlet {
    /// The part of x − x⁻ that is kept, d: e^(−damping · h), so that the decay over a time does not depend on how many
    /// substeps it is divided into; times h/h⁻ where the length changed.
    pub fn kept(&self) -> f32 {
        let same = self.seconds_before == self.seconds || self.seconds_before == 0.0;
        let ratio = if same {
            1.0
        } else {
            self.seconds / self.seconds_before
        };
        (-self.damping * self.seconds).exp() * ratio
    }

    /// Moves free particles (`inv_mass` > 0) from `previous` over `position` to the new position, which replaces
    /// `position`; the old one becomes `previous`. Kinematic ones stay as they are.
    ///
    /// `acceleration` comes in addition to gravity [m/s²]. `lost` is what rounding took from the displacement of each
    /// particle in the substep before \[m\], and is replaced by what it takes in this one.
    pub fn step(
        &self,
        position: &mut Points,
        previous: &mut Points,
        lost: &mut Points,
        acceleration: &Points,
        inv_mass: &[f32],
    ) {
        let kept = self.kept();
        let h2 = self.seconds * self.seconds;
        let axes = [
            (
                &mut position.x,
                &mut previous.x,
                &mut lost.x,
                &acceleration.x,
                self.gravity.x,
            ),
            (
                &mut position.y,
                &mut previous.y,
                &mut lost.y,
                &acceleration.y,
                self.gravity.y,
            ),
            (
                &mut position.z,
                &mut previous.z,
                &mut lost.z,
                &acceleration.z,
                self.gravity.z,
            ),
        ];
        for (position, previous, lost, acceleration, gravity) in axes {
            for ((((x, x_before), lost), a), w) in position
                .iter_mut()
                .zip(previous)
                .zip(lost)
                .zip(acceleration)
                .zip(inv_mass)
            {
                let now = *x;
                let displacement = (now - *x_before + *lost) * kept + (gravity + a) * h2;
                let free = *w > 0.0;
                let displacement = if free { displacement } else { 0.0 };
                *x = now + displacement;
                *lost = displacement - (*x - now);
                *x_before = if free { now } else { *x_before };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decay_does_not_depend_on_the_number_of_substeps() {
        let decay = |substeps: u32| {
            let seconds = 0.1 / substeps as f32;
            let verlet = Verlet {
                seconds,
                seconds_before: seconds,
                damping: 2.0,
                gravity: Vec3::ZERO,
            };
            verlet.kept().powi(substeps as i32)
        };
        for n in [2, 5, 16, 64] {
            assert!((decay(n) - decay(1)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_change_of_the_substep_keeps_the_velocity() {
        let mut position = Points::from_iter([Vec3::X]);
        let mut previous = Points::from_iter([Vec3::ZERO]);
        let verlet = Verlet {
            seconds: 0.25,
            seconds_before: 1.0,
            damping: 0.0,
            gravity: Vec3::ZERO,
        };
        let mut lost = Points::zeroed(1);
        verlet.step(
            &mut position,
            &mut previous,
            &mut lost,
            &Points::zeroed(1),
            &[1.0],
        );
        assert_eq!(position.get(0), Vec3::X * 1.25);
    }

    #[test]
    fn free_fall_is_the_discrete_sum_to_float_precision() {
        for substeps in [60u32, 480, 6000] {
            let seconds = 1.0 / substeps as f32;
            let verlet = Verlet {
                seconds,
                seconds_before: seconds,
                damping: 0.0,
                gravity: Vec3::NEG_Y * 9.81,
            };
            let mut position = Points::from_iter([Vec3::Y]);
            let (mut previous, mut lost) = (position.clone(), Points::zeroed(1));
            let steps = 2 * substeps;
            for _ in 0..steps {
                verlet.step(
                    &mut position,
                    &mut previous,
                    &mut lost,
                    &Points::zeroed(1),
                    &[1.0],
                );
            }
            let (h, n) = (f64::from(seconds), f64::from(steps));
            let fallen = f64::from(9.81_f32) * h * h * n * (n + 1.0) / 2.0;
            let error = f64::from(position.get(0).y) - (1.0 - fallen);
            assert!(error.abs() < 1e-5 * fallen, "{substeps}: {error}");
        }
    }
}
