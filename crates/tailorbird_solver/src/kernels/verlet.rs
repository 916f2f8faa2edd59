//! Verlet integration: x' = x + (x − x⁻) d + a h².
//!
//! In `f32` the sum loses the low bits of a h², which is 10⁻⁵ of x and less, and since x − x⁻ is the velocity, a loss is permanent: a cloth
//! in free fall would lag by millimetres in seconds. So the rounding error of a displacement is kept and added to the next one (as Kahan
//! does for sums).

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Reading, Shared, each_window};
use crate::points::Points;

/// One substep for all particles.
#[derive(Clone, Copy, Debug)]
pub struct Verlet {
    /// Length of the substep, h \[s\].
    pub seconds: f32,
    /// Length of the substep before \[s\]: the time of x − x⁻. 0 for a cloth that has not moved yet.
    pub seconds_before: f32,
    /// Rate at which velocity decays [1/s].
    pub damping: f32,
    /// Acceleration of all particles [m/s²].
    pub gravity: Vec3,
}

impl Verlet {
    /// Part of x − x⁻ that is kept, d: e^(−damping · h), so that the decay over a time does not depend on the number of substeps; times
    /// h/h⁻ where the length changed.
    pub fn kept(&self) -> f32 {
        let same = self.seconds_before == self.seconds || self.seconds_before == 0.0;
        let ratio = if same {
            1.0
        } else {
            self.seconds / self.seconds_before
        };
        (-self.damping * self.seconds).exp() * ratio
    }

    /// Moves the free ones (`inv_mass` > 0) of some particles from `previous` over `position` to the new position, which replaces
    /// `position`; the old one becomes `previous`. Kinematic ones stay as they are.
    ///
    /// `acceleration` is added to gravity [m/s²]; `None` is 0. `lost` is the rounding error of the displacement of each particle in the
    /// substep before \[m\], and is replaced by that of this one.
    ///
    /// # Panics
    /// When the lengths differ.
    pub fn step(
        &self,
        level: Level,
        position: &mut Points,
        previous: &mut Points,
        lost: &mut Points,
        acceleration: Option<&Points>,
        inv_mass: &[f32],
        particles: Range<usize>,
    ) {
        let n = inv_mass.len();
        assert!(
            [&*position, &*previous, &*lost]
                .iter()
                .all(|points| points.is_of(n)),
            "one of each for {n} particles"
        );
        let (kept, h2) = (self.kept(), self.seconds * self.seconds);
        let gravity = self.gravity * h2;
        let axes = [
            (&mut position.x, &mut previous.x, &mut lost.x, gravity.x),
            (&mut position.y, &mut previous.y, &mut lost.y, gravity.y),
            (&mut position.z, &mut previous.z, &mut lost.z, gravity.z),
        ];
        for (axis, (position, previous, lost, fall)) in axes.into_iter().enumerate() {
            let acceleration = acceleration.map(|a| Reading([&a.x, &a.y, &a.z][axis]));
            let axis = Axis {
                position: Shared::new(position),
                previous: Shared::new(previous),
                lost: Shared::new(lost),
                acceleration,
                inv_mass: Reading(inv_mass),
            };
            let particles = particles.clone();
            dispatch!(level, simd => step_axis(simd, axis, kept, fall, h2, particles));
        }
    }
}

/// One coordinate of all particles.
#[derive(Clone, Copy)]
struct Axis<'a> {
    position: Shared<'a>,
    previous: Shared<'a>,
    lost: Shared<'a>,
    acceleration: Option<Reading<'a>>,
    inv_mass: Reading<'a>,
}

#[inline(always)]
fn step_axis<S: Simd>(simd: S, axis: Axis, kept: f32, fall: f32, h2: f32, particles: Range<usize>) {
    let zero = S::f32s::splat(simd, 0.0);
    let fall = S::f32s::splat(simd, fall);
    each_window(
        simd,
        particles,
        #[inline(always)]
        |window| {
            let now = axis.position.load_at(simd, window, 0);
            let before = axis.previous.load_at(simd, window, 0);
            let lost = axis.lost.load_at(simd, window, 0);
            let mut displacement = (now - before + lost) * kept + fall;
            if let Some(acceleration) = axis.acceleration {
                displacement += acceleration.load_at(simd, window) * h2;
            }
            let free = axis.inv_mass.load_at(simd, window).simd_gt(zero);
            let displacement = free.select(displacement, zero);
            let next = now + displacement;
            axis.position.store_at(simd, window, 0, next);
            axis.lost
                .store_at(simd, window, 0, displacement - (next - now));
            axis.previous
                .store_at(simd, window, 0, free.select(now, before));
        },
    );
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
            Level::new(),
            &mut position,
            &mut previous,
            &mut lost,
            None,
            &[1.0],
            0..1,
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
                    Level::new(),
                    &mut position,
                    &mut previous,
                    &mut lost,
                    None,
                    &[1.0],
                    0..1,
                );
            }
            let (h, n) = (f64::from(seconds), f64::from(steps));
            let fallen = f64::from(9.81_f32) * h * h * n * (n + 1.0) / 2.0;
            let error = f64::from(position.get(0).y) - (1.0 - fallen);
            assert!(error.abs() < 1e-5 * fallen, "{substeps}: {error}");
        }
    }
}
