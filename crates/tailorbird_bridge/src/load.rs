//! Loads of bodies by cloth, and the waking of sleeping ones.
//!
//! A ball that sleeps on a sheet, or a crate that sleeps under a tablecloth, is under a steady push: the one that it fell asleep
//! with, which the floor or its weight balances. So a push wakes a body when it differs from that one, as soon as the
//! difference would have given the body the speed below which the engine lets it sleep. The difference fades with the time
//! that the engine lets pass before a body sleeps, so that what only trembles adds up to nothing.

use bevy_ecs::prelude::*;
use bevy_math::{Mat3, Vec3};
use tailorbird_cloth::collider::ClothReaction;

/// On each rigid body: what cloth loads it with.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ClothLoad {
    /// Mean while awake: force \[N\], torque \[N m\].
    mean: (Vec3, Vec3),
    /// Velocities that the difference from that would have given it while it sleeps [m/s], [rad/s].
    push: (Vec3, Vec3),
    /// True if it lies at a sleeping cloth, which does not push meanwhile.
    pub at_rest: bool,
}

/// When an engine lets a body sleep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SleepLimits {
    /// Below this speed [m/s].
    pub linear: f32,
    /// Below this rate of turning [rad/s].
    pub angular: f32,
    /// After this time \[s\].
    pub seconds: f32,
}

/// Inverse mass of a sleeping body if it were awake: along the axes of the world [1/kg], and the inverse inertia in world axes [1/(kg m²)].
pub type InverseMass = (Vec3, Mat3);

impl ClothLoad {
    /// The mean force \[N\] and torque about the centre of mass \[N m\] of the last while in which the body was awake.
    pub fn mean(&self) -> (Vec3, Vec3) {
        self.mean
    }

    /// Notes the push of a step on a body that is awake.
    pub fn carry(&mut self, reaction: Option<&ClothReaction>, seconds: f32, memory: f32) {
        self.push = (Vec3::ZERO, Vec3::ZERO);
        // A cloth that fell asleep under it carries it as before.
        if self.at_rest && reaction.is_none() {
            return;
        }
        let (force, torque) = per_second(reaction, seconds);
        let part = (seconds / memory.max(seconds)).min(1.0);
        self.mean.0 += part * (force - self.mean.0);
        self.mean.1 += part * (torque - self.mean.1);
    }

    /// Notes the push of a step on a body that sleeps. Velocities that it wakes with [m/s], [rad/s], where it wakes.
    pub fn disturb(
        &mut self,
        reaction: Option<&ClothReaction>,
        (inv_mass, inv_inertia): InverseMass,
        seconds: f32,
        limits: SleepLimits,
    ) -> Option<(Vec3, Vec3)> {
        if self.at_rest && reaction.is_none() {
            return None;
        }
        let (force, torque) = per_second(reaction, seconds);
        let fade = 1.0 / (1.0 + seconds / limits.seconds.max(seconds));
        self.push.0 = self.push.0 * fade + inv_mass * (force - self.mean.0) * seconds;
        self.push.1 = self.push.1 * fade + inv_inertia * (torque - self.mean.1) * seconds;
        let wakes = self.push.0.length() > limits.linear.abs()
            || self.push.1.length() > limits.angular.abs();
        wakes.then(|| std::mem::take(&mut self.push))
    }
}

fn per_second(reaction: Option<&ClothReaction>, seconds: f32) -> (Vec3, Vec3) {
    reaction.map_or((Vec3::ZERO, Vec3::ZERO), |reaction| {
        (
            reaction.impulse / seconds,
            reaction.angular_impulse / seconds,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: SleepLimits = SleepLimits {
        linear: 0.1,
        angular: 0.1,
        seconds: 0.5,
    };
    const STEP: f32 = 1.0 / 64.0;

    fn push(force: f32) -> ClothReaction {
        ClothReaction {
            impulse: Vec3::Y * force * STEP,
            ..ClothReaction::default()
        }
    }

    /// Of a body of 1 kg that fell asleep under 10 N: after how many steps of these pushes it wakes, in 10 s.
    fn wakes(force: impl Fn(u32) -> Option<f32>, at_rest: bool) -> Option<u32> {
        let mut load = ClothLoad {
            at_rest,
            ..ClothLoad::default()
        };
        for _ in 0..640 {
            load.carry(Some(&push(10.0)), STEP, LIMITS.seconds);
        }
        (0..640).find(|step| {
            let push = force(*step).map(push);
            let body = (Vec3::ONE, Mat3::IDENTITY);
            load.disturb(push.as_ref(), body, STEP, LIMITS).is_some()
        })
    }

    #[test]
    fn the_load_that_it_sleeps_under_and_its_trembling_do_not_wake_a_body() {
        assert_eq!(wakes(|_| Some(10.0), false), None);
        assert_eq!(
            wakes(|step| Some(if step % 2 == 0 { 7.0 } else { 13.0 }), false),
            None
        );
        assert_eq!(wakes(|_| None, true), None);
    }

    #[test]
    fn a_hit_wakes_it_at_once_and_what_stays_or_goes_soon() {
        // 1 N s.
        assert_eq!(wakes(|_| Some(10.0 + 64.0), false), Some(0));
        // 0.1 m/s at 2 m/s² takes 3 or 4 steps, at 10 m/s² one.
        assert!(wakes(|_| Some(12.0), false).is_some_and(|steps| (3..5).contains(&steps)));
        assert_eq!(wakes(|_| None, false), Some(0));
        // Below 0.1 m/s within 0.5 s.
        assert_eq!(wakes(|_| Some(10.1), false), None);
    }
}
