//! Numbers that tell contents from each other: equal contents have equal ones, in every process.

use std::hash::{DefaultHasher, Hasher};

use bevy_math::Vec3;

/// The fingerprint of a list of numbers.
pub fn of(numbers: impl IntoIterator<Item = u32>) -> u64 {
    let mut hasher = DefaultHasher::new();
    numbers
        .into_iter()
        .for_each(|number| hasher.write_u32(number));
    hasher.finish()
}

/// The fingerprint of points and of triangles between them.
pub fn of_triangles(points: &[Vec3], triangles: &[[u32; 3]]) -> u64 {
    let coordinates = points.iter().flat_map(Vec3::to_array).map(f32::to_bits);
    let corners = triangles.iter().flatten().copied();
    of([points.len() as u32]
        .into_iter()
        .chain(coordinates)
        .chain(corners))
}
