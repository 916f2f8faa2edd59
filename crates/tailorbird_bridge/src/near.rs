//! Broad phase: colliders near a cloth.

use bevy_ecs::{prelude::*, system::SystemParam};
use bevy_math::{Isometry3d, Vec3};
use bevy_time::Time;
use tailorbird_cloth::prelude::*;

/// Room around a cloth's box \[m\]: what of a cloth may get out of it within a step.
const ROOM: f32 = 1.0;

/// Room in which a collider counts as lying at a sleeping cloth \[m\].
const TOUCH: f32 = 0.05;

/// A box in the world: lowest and highest coordinates \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldBox {
    /// Lowest coordinates \[m\].
    pub min: Vec3,
    /// Highest coordinates \[m\].
    pub max: Vec3,
}

impl WorldBox {
    /// Nothing is outside.
    pub const EVERYWHERE: Self = Self {
        min: Vec3::MIN,
        max: Vec3::MAX,
    };

    /// The box around a box of half sides `half` around `center`, given in the axes of `at`.
    pub fn around(center: Vec3, half: Vec3, at: Isometry3d) -> Self {
        let middle = at * center;
        let axes = bevy_math::Mat3::from_quat(at.rotation);
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        Self {
            min: middle - half,
            max: middle + half,
        }
    }

    /// The box around both.
    pub fn merge(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// With room on all sides \[m\].
    pub fn grown(self, room: f32) -> Self {
        Self {
            min: self.min - room,
            max: self.max + room,
        }
    }

    /// Returns whether the two have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }
}

/// The boxes of the cloths: which colliders have to be told to them.
#[derive(SystemParam)]
pub struct ClothBoxes<'w, 's> {
    time: Res<'w, Time>,
    settings: Res<'w, ClothSettings>,
    cloths: Query<
        'w,
        's,
        (
            Ref<'static, ClothParticles>,
            &'static ClothFrame,
            &'static ClothBounds,
            &'static ClothSleepState,
        ),
        With<Cloth>,
    >,
    boxes: Local<'s, Vec<(WorldBox, bool)>>,
}

impl ClothBoxes<'_, '_> {
    /// Reads the boxes for the step to come; `false` where there is none, as time stands still or there is no cloth.
    pub fn begin_step(&mut self) -> bool {
        self.boxes.clear();
        let paused = self.settings.paused && self.settings.pending_steps == 0;
        if paused || self.seconds() <= 0.0 {
            return false;
        }
        for (particles, frame, bounds, rest) in &self.cloths {
            let unknown = particles.is_empty() || particles.is_added();
            let around = if unknown {
                WorldBox::EVERYWHERE
            } else {
                let center = 0.5 * (bounds.min + bounds.max);
                WorldBox::around(center, bounds.max - center, frame.isometry())
            };
            self.boxes.push((around, rest.is_asleep()));
        }
        !self.boxes.is_empty()
    }

    /// The length of the step to come \[s\].
    pub fn seconds(&self) -> f32 {
        self.time.delta_secs()
    }

    /// Speed of a collider above which it hops [m/s]: the teleport speed of the settings.
    pub fn teleport_speed(&self) -> f32 {
        self.settings.teleport_speed
    }

    /// Returns whether a collider that is in this box during the step may meet a cloth.
    pub fn reach(&self, collider: WorldBox) -> bool {
        let collider = collider.grown(ROOM);
        self.boxes.iter().any(|(cloth, _)| cloth.meets(&collider))
    }

    /// Returns whether a collider in this box lies at a sleeping cloth, which does not push meanwhile.
    pub fn rest_on(&self, collider: WorldBox) -> bool {
        let collider = collider.grown(TOUCH);
        let mut asleep = self.boxes.iter().filter(|(_, asleep)| *asleep);
        asleep.any(|(cloth, _)| cloth.meets(&collider))
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_4;

    use bevy_math::Quat;

    use super::*;

    #[test]
    fn the_box_around_a_turned_box_holds_its_corners() {
        let at = Isometry3d::new(Vec3::new(1.0, 2.0, 3.0), Quat::from_rotation_z(FRAC_PI_4));
        let around = WorldBox::around(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.5), at);
        let root = 2.0_f32.sqrt();
        assert!(around.min.distance(Vec3::new(1.0 - root, 2.0 - root, 2.5)) < 1e-6);
        assert!(around.max.distance(Vec3::new(1.0 + root, 2.0 + root, 3.5)) < 1e-6);
        assert!(around.meets(&WorldBox::EVERYWHERE));
        let far = WorldBox::around(Vec3::X * 5.0, Vec3::ONE, Isometry3d::IDENTITY);
        assert!(!around.meets(&far));
        assert!(around.meets(&far.grown(2.0)));
    }
}
