//! Where colliders are, and where cloth moves bodies to.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec3};
use tailorbird_cloth::collider::{ClothCollider, ClothReaction};

/// Where an engine's collider was after the last step, in the world, with what cloth moved it.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct TrackedPose(Option<Isometry3d>);

impl TrackedPose {
    /// Notes where the collider is after a step; a pose that is not finite is forgotten.
    pub fn set(&mut self, pose: Isometry3d) {
        let finite = pose.translation.is_finite() && pose.rotation.is_finite();
        self.0 = finite.then_some(pose);
    }

    /// Where the motion to `end` began: the noted pose, or `end` itself for what is new, or is put elsewhere
    /// ([`ClothCollider::TELEPORT_SPEED`]).
    pub fn start(&self, end: Isometry3d, seconds: f32) -> Isometry3d {
        let reach = ClothCollider::TELEPORT_SPEED * seconds;
        self.0
            .filter(|start| start.translation.distance(end.translation) <= reach)
            .unwrap_or(end)
    }
}

/// Where a body's pose gets that cloth moved and turned about its centre of mass \[m\].
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
        assert_eq!(track.start(at(1.0), 0.01), at(1.0));
        track.set(at(1.0));
        assert_eq!(track.start(at(2.0), 0.01), at(1.0));
        assert_eq!(track.start(at(9.0), 0.01), at(9.0));
        track.set(at(f32::NAN));
        assert_eq!(track.start(at(2.0), 0.01), at(2.0));
    }
}
