//! Paths of moving things.

use std::f32::consts::TAU;

use bevy_math::Vec3;
use bevy_transform::components::Transform;

use super::demands::SIZE;

/// Pose of the moving post.
pub fn post(time: f32, apart: f32) -> Transform {
    Transform::from_xyz(apart * SIZE * time.min(1.0), 0.0, 0.0)
}

/// Scale of the growing curtain.
pub fn grown(time: f32) -> Vec3 {
    let part = (0.5 * (time - 2.0)).clamp(0.0, 1.0);
    let scale = 1.5 - 0.5 * (TAU * part).cos();
    let side = if time > 4.5 { -1.0 } else { 1.0 };
    Vec3::new(side * scale, scale, scale)
}

/// From 0.35 m above the net to 0.6 m below it, and back.
pub fn net_ball(time: f32) -> Transform {
    let distance = 0.95;
    let down = if time < distance + 1.0 {
        time.min(distance)
    } else {
        (distance - (time - distance - 1.0)).max(0.0)
    };
    Transform::from_xyz(0.011, 1.35 - down, 0.007)
}
