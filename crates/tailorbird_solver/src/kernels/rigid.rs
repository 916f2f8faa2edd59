//! Rigid motion: x' = R x + t.
//!
//! Kinematic particles (`inv_mass` 0) keep their coordinates in a frame that moves. Their previous position becomes the one that they had
//! in the world, so that a released particle flies on with the velocity of its holder.

use bevy_math::{Mat3, Vec3};

use crate::points::Points;

/// Expresses particles in a frame that moved. The `position` of a free particle stays where it is in the world.
pub fn change_frame(
    rotation: Mat3,
    shift: Vec3,
    inv_mass: &[f32],
    position: &mut Points,
    previous: &mut Points,
) {
    for (i, w) in inv_mass.iter().enumerate() {
        let place = rotation * position.get(i) + shift;
        if *w > 0.0 {
            previous.set(i, rotation * previous.get(i) + shift);
            position.set(i, place);
        } else {
            previous.set(i, place);
        }
    }
}

/// Turns vectors.
pub fn rotate(rotation: Mat3, vectors: &mut Points) {
    for i in 0..vectors.len() {
        vectors.set(i, rotation * vectors.get(i));
    }
}

/// Adds the centrifugal displacement of a substep about the origin: −φ × (φ × x), with the angle φ of the substep, about its axis \[rad\].
pub fn add_centrifugal(turned: Vec3, inv_mass: &[f32], position: &mut Points) {
    for (i, w) in inv_mass.iter().enumerate() {
        if *w > 0.0 {
            let place = position.get(i);
            position.set(i, place - turned.cross(turned.cross(place)));
        }
    }
}
