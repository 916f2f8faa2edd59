//! Measurements, and numbers that look random.

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

/// FNV-1a, 64 bits, over the bits of all coordinates of all particles, in the frames of their cloths.
pub fn hash<'a>(cloths: impl IntoIterator<Item = &'a ClothParticles>) -> u64 {
    let positions = cloths.into_iter().flat_map(|cloth| cloth.positions());
    let bytes = positions.flat_map(|p| p.to_array()).map(f32::to_le_bytes);
    bytes.flatten().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The largest distance between places with the same number \[m\].
///
/// # Panics
///
/// If there are not as many of both.
pub fn furthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| a.distance(*b));
    distances.fold(0.0, f32::max)
}

/// A number from −1 to 1 that looks random, always the same for the same key (splitmix64, Steele et al. 2014).
pub fn unit(key: u64) -> f32 {
    let mut z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 40) as f32 / (1u32 << 23) as f32 - 1.0
}
