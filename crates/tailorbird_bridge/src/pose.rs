//! Poses of colliders, and of bodies that cloth moved.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec3};
use tailorbird_cloth::{collider::ClothReaction, sampling::ClothHopDetector};

/// Pose of an engine's collider after the last step, in the world, with its displacement by cloth.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct TrackedPose {
    pose: Option<Isometry3d>,
    hops: ClothHopDetector,
}

impl TrackedPose {
    /// Notes where the collider is after a step of this length \[s\], at this teleport speed [m/s]; a pose that is not finite is forgotten.
    pub fn set(&mut self, pose: Isometry3d, seconds: f32, speed: f32) {
        let finite = pose.translation.is_finite() && pose.rotation.is_finite();
        if finite && let Some(start) = self.pose {
            let displacement = Vec3::from(pose.translation - start.translation);
            self.hops.is_hop(displacement, seconds, speed);
        }
        self.pose = finite.then_some(pose);
    }

    /// Pose at which the motion to `end` in a step of this length \[s\] began: the noted pose; for a collider that hopped at this teleport
    /// speed [m/s] ([`ClothSettings::teleport_speed`](tailorbird_cloth::prelude::ClothSettings::teleport_speed)), the pose that it would
    /// have had if it had been put elsewhere and then moved on as before; `end` itself for a new collider.
    pub fn start(&self, end: Isometry3d, seconds: f32, speed: f32) -> Isometry3d {
        let Some(start) = self.pose else {
            return end;
        };
        let displacement = Vec3::from(end.translation - start.translation);
        let mut hops = self.hops;
        if hops.is_hop(displacement, seconds, speed) {
            let moved = hops.velocity() * seconds;
            return Isometry3d::new(Vec3::from(end.translation) - moved, end.rotation);
        }
        start
    }
}

/// Pose of a body that cloth displaced and turned about its centre of mass \[m\].
pub fn moved(
    reaction: &ClothReaction,
    (position, rotation): (Vec3, Quat),
    center_of_mass: Vec3,
) -> (Vec3, Quat) {
    let turn = Quat::from_scaled_axis(reaction.rotation);
    (
        center_of_mass + reaction.translation + turn * (position - center_of_mass),
        (turn * rotation).normalize(),
    )
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn a_body_turns_about_its_centre_of_mass() {
        let reaction = ClothReaction {
            translation: Vec3::Y,
            rotation: Vec3::Z * FRAC_PI_2,
            ..ClothReaction::default()
        };
        let center = Vec3::X;
        let (position, rotation) = moved(&reaction, (Vec3::ZERO, Quat::IDENTITY), center);
        // It was 1 m left of the centre, and is now 1 m below it.
        assert!(position.distance(Vec3::X) < 1e-6, "{position}");
        assert!((rotation * Vec3::X).distance(Vec3::Y) < 1e-6);
        let arm = rotation * (center - Vec3::ZERO);
        assert!((position + arm).distance(center + Vec3::Y) < 1e-6);
    }

    #[test]
    fn what_is_new_or_jumps_does_not_sweep() {
        let at = |x: f32| Isometry3d::from_translation(Vec3::X * x);
        let mut track = TrackedPose::default();
        let start = |track: &TrackedPose, to: f32| track.start(at(to), 0.01, 30.0);
        let set = |track: &mut TrackedPose, to: f32| track.set(at(to), 0.01, 30.0);
        assert_eq!(start(&track, 1.0), at(1.0));
        set(&mut track, 1.0);
        assert_eq!(start(&track, 1.2), at(1.0));
        set(&mut track, 1.2);
        // It goes on with 20 m/s.
        let hopped = start(&track, 9.0);
        assert!((hopped.translation.x - 8.8).abs() < 1e-5, "{hopped:?}");
        set(&mut track, f32::NAN);
        assert_eq!(start(&track, 2.0), at(2.0));
    }
}
