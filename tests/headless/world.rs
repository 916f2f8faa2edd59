//! Scenes of the tests, for a [`Sim`].

use bevy::prelude::*;
use tailorbird::prelude::*;
pub use tailorbird_test::{DT, G, HZ, Sim, hash};

/// The largest ratio of a stretch spring's length to that at rest.
pub fn longest_edge(sim: &Sim, cloth: Entity) -> f32 {
    1.0 + sim.stretch(cloth).max
}

/// Cotton whose motion does not decay.
pub fn undamped() -> ClothMaterial {
    ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::cotton()
    }
}

/// A square of `n` × `n` particles and 1 m × 1 m, its middle at the entity's origin, in the x-y plane.
pub fn square(n: u32) -> Cloth {
    Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered()
}

/// Turns the x-y plane into the horizontal one; the front faces up, row 0 is at −z.
pub fn lying() -> Quat {
    Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
}

/// Half the distance between `x` and the next larger number: the most by which rounding to f32 is off.
pub fn rounding(x: f32) -> f32 {
    0.5 * (x.abs().next_up() - x.abs())
}
