//! Rigid motion: x' = R x + t.

use bevy_math::{Mat3, Vec3};

use crate::points::Points;

/// Moves every point.
pub fn transform_all(rotation: Mat3, shift: Vec3, points: &mut Points) {
    for i in 0..points.len() {
        points.set(i, rotation * points.get(i) + shift);
    }
}

/// Moves the points of free particles (`inv_mass` > 0).
pub fn transform_free(rotation: Mat3, shift: Vec3, inv_mass: &[f32], points: &mut Points) {
    for (i, w) in inv_mass.iter().enumerate() {
        if *w > 0.0 {
            points.set(i, rotation * points.get(i) + shift);
        }
    }
}
