//! Blows: motion that starts too suddenly for cloth to follow.

use bevy_math::Vec3;

/// Largest acceleration of a whole cloth by its holder [m/s²]: 2.5 m/s from one step of 1/60 s to the next.
const MOST_ACCELERATION: f32 = 150.0;

/// The part of a displacement in a step \[m\] that carries cloth instead of pulling it, after a step with this velocity [m/s]; and the velocity of
/// the rest.
pub(crate) fn excess(before: Vec3, displacement: Vec3, seconds: f32) -> (Vec3, Vec3) {
    if seconds <= 0.0 {
        return (Vec3::ZERO, before);
    }
    let velocity = displacement / seconds;
    let change = velocity - before;
    let most = MOST_ACCELERATION * seconds;
    if change.length_squared() <= most * most {
        return (Vec3::ZERO, velocity);
    }
    let felt = before + change.clamp_length_max(most);
    (displacement - felt * seconds, felt)
}
