//! Distinction of motion from hops.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::components::Transform;

/// Tells motion from hops by what moved before: see
/// [`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed).
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct ClothHopDetector {
    /// Velocity of the last motion [m/s].
    velocity: Vec3,
    /// Velocity of the last displacement, if that was a hop [m/s].
    suspect: Option<Vec3>,
}

impl ClothHopDetector {
    /// Takes a displacement \[m\] that took some time \[s\], and tells whether it is a hop: whether the velocity in it differs from the
    /// one before by more than that one's magnitude and `speed` [m/s]. A second one like it is motion.
    pub fn is_hop(&mut self, displacement: Vec3, seconds: f32, speed: f32) -> bool {
        if seconds <= 0.0 {
            return false;
        }
        let velocity = displacement / seconds;
        let differs = |from: Vec3| velocity.distance(from) > speed + from.length();
        let hop = differs(self.velocity) && self.suspect.is_none_or(differs);
        if hop {
            self.suspect = Some(velocity);
        } else {
            (self.velocity, self.suspect) = (velocity, None);
        }
        hop
    }

    /// The velocity of the last motion [m/s].
    pub fn velocity(&self) -> Vec3 {
        self.velocity
    }

    /// Place from which an entity that hopped from `from` to `to` came, had it been put elsewhere and then moved on as before; `None` if it
    /// did not hop. `metre` is the length of a unit of its space in the world \[m\].
    pub(super) fn came_from(
        &mut self,
        [from, to]: [&Transform; 2],
        [seconds, speed, metre]: [f32; 3],
    ) -> Option<Transform> {
        /// A hop that turns by more is one that turns \[rad\].
        const TURNS: f32 = 0.2;
        if !self.is_hop((to.translation - from.translation) * metre, seconds, speed) {
            return None;
        }
        let mut start = *from;
        if from.rotation.angle_between(to.rotation) > TURNS {
            start.rotation = to.rotation;
            self.velocity = to.rotation * from.rotation.inverse() * self.velocity;
        }
        start.translation = to.translation - self.velocity * (seconds / metre);
        Some(start)
    }
}

/// Takes something along that was near `from` where that is put to `to`.
pub(super) fn take_along(it: &mut Transform, [from, to]: [&Transform; 2]) {
    if from == to {
        return;
    }
    if from.rotation == to.rotation {
        it.translation = to.translation + (it.translation - from.translation);
    } else {
        let turn: Quat = to.rotation * from.rotation.inverse();
        it.translation = to.translation + turn * (it.translation - from.translation);
        it.rotation = if it.rotation == from.rotation {
            to.rotation
        } else {
            (turn * it.rotation).normalize()
        };
    }
    if from.scale != to.scale {
        let ratio = to.scale / from.scale;
        it.scale = if it.scale != from.scale && ratio.is_finite() {
            it.scale * ratio
        } else {
            to.scale
        };
    }
}

/// Something was put elsewhere, and what cloth it holds, carries or pushes did not feel it: it was seen to hop
/// ([`ClothSettings::teleport_speed`](crate::settings::ClothSettings::teleport_speed)), or the game said so.
///
/// Written once for each entity whose own `Transform` did so, in the step that takes it into account.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothMotionTeleported {
    /// A cloth, what holds it, a collider, a zone of wind, or a parent of one of them.
    pub entity: Entity,
    /// True if the game said so; else it was seen.
    pub told: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED: f32 = 30.0;

    fn hops(displacements: &[f32], seconds: f32) -> Vec<bool> {
        let mut detector = ClothHopDetector::default();
        displacements
            .iter()
            .map(|displacement| detector.is_hop(Vec3::X * *displacement, seconds, SPEED))
            .collect()
    }

    #[test]
    fn a_displacement_of_two_metres_is_a_hop_at_all_rates_and_running_is_none() {
        for hz in [20.0, 30.0, 60.0, 144.0f32] {
            let run = 5.0 / hz;
            assert_eq!(
                hops(&[run, run, 2.0 + run, run, -2.0, run], 1.0 / hz),
                [false, false, true, false, true, false],
                "{hz}"
            );
        }
    }

    #[test]
    fn what_goes_on_as_fast_is_motion() {
        let arrow = 100.0 / 60.0;
        assert_eq!(
            hops(&[0.0, arrow, arrow, arrow, 0.0], 1.0 / 60.0),
            [false, true, false, false, false]
        );
    }

    #[test]
    fn there_and_back_are_two_hops() {
        assert_eq!(
            hops(&[0.0, 2.0, -2.0, 2.0], 1.0 / 60.0),
            [false, true, true, true]
        );
    }

    #[test]
    fn what_hops_goes_on_as_fast_as_before_in_its_new_direction() {
        let mut detector = ClothHopDetector::default();
        let seconds = 1.0 / 60.0;
        detector.is_hop(Vec3::X * 3.0 * seconds, seconds, SPEED);
        let from = Transform::from_xyz(1.0, 0.0, 0.0);
        let turn = Quat::from_rotation_y(std::f32::consts::PI);
        let to = Transform::from_xyz(7.0, 1.0, 0.0).with_rotation(turn);
        let start = detector
            .came_from([&from, &to], [seconds, SPEED, 1.0])
            .unwrap();
        assert_eq!(start.rotation, turn);
        let expected = to.translation + Vec3::X * 3.0 * seconds;
        assert!(start.translation.distance(expected) < 1e-6);
    }

    #[test]
    fn what_is_taken_along_stays_as_near() {
        let from = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.3));
        let to = Transform::from_xyz(-4.0, 0.0, 1.0).with_rotation(Quat::from_rotation_z(2.0));
        let near = from * Transform::from_xyz(0.1, 0.2, 0.0);
        let mut it = near;
        take_along(&mut it, [&from, &to]);
        let expected = to * Transform::from_xyz(0.1, 0.2, 0.0);
        assert!(it.translation.distance(expected.translation) < 1e-6);
        assert!(it.rotation.angle_between(expected.rotation) < 1e-3);
        let mut same = from;
        take_along(&mut same, [&from, &to]);
        assert_eq!(same, to);
    }
}
