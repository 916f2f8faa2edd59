//! Cloths that are held, in a vacuum where nothing sleeps.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2};
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

/// A vacuum. What is spawned is not seen before time passes.
pub fn vacuum() -> Sim {
    Sim::vacuum().started()
}

/// Cotton that does not stretch, whose motion does not decay, and that does not sleep.
pub fn rigid() -> (ClothMaterial, ClothSleep) {
    let material = ClothMaterial {
        damping: 0.0,
        ..tailorbird_test::rigid()
    };
    (material, ClothSleep::never())
}

/// A sheet of 1 m × 1 m in the x-y plane, its middle at the entity's origin.
pub fn square(n: u32) -> impl Bundle {
    (Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered(), rigid())
}

/// A strip of two columns that is 1 m long: a rope.
pub fn rope() -> impl Bundle {
    let cloth =
        Cloth::grid(Vec2::new(0.02, 1.0), UVec2::new(2, 50)).with_origin(Vec2::new(0.5, 0.0));
    (cloth, rigid())
}
