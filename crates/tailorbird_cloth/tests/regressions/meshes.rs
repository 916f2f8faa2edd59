//! Bugs of meshes.

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet};

/// An irregular sheet of 1 m with a side of `n` vertices, and each triangle a second time from behind if it has two sides.
fn sheet(n: u32, two_sides: bool) -> Cloth {
    let at = |k: u32| {
        let jitter = |by: f32| 0.25 * (k as f32 * by).sin();
        let (x, y) = ((k % n) as f32, (k / n) as f32);
        Vec3::new(x + jitter(1.7), y + jitter(2.9), 0.0) / (n - 1) as f32 - 0.5
    };
    let corners = (0..n * (n - 1)).filter(|k| k % n + 1 < n);
    let front: Vec<u32> = corners
        .flat_map(|k| [k, k + 1, k + n + 1, k, k + n + 1, k + n])
        .collect();
    let back = front.chunks(3).flat_map(|t| [t[0], t[2], t[1]]);
    let indices: Vec<u32> = if two_sides {
        front.iter().copied().chain(back).collect()
    } else {
        front
    };
    Cloth::mesh((0..n * n).map(at).collect::<Vec<_>>(), indices)
}

/// Twice the faces are neither twice the mass, nor twice the wind, nor springs that fight each other.
#[test]
fn double_sided_faces() {
    let [one, two] = [false, true].map(|two_sides| {
        let mut sheet = Sheet::new(&Scene {
            cloth: Some(sheet(12, two_sides)),
            pins: ClothPins::particles([0]),
            wind: ClothWind::steady(Vec3::new(3.0, 1.0, 4.0)),
            sphere: Some((Vec3::new(0.0, 0.0, -0.8), 0.3)),
            ..Scene::default()
        });
        sheet.steps(90);
        assert_eq!(sheet.complaint(), None);
        let backs = sheet.get::<ClothTopology>().report.backs.count;
        assert_eq!(backs, if two_sides { 242 } else { 0 });
        (sheet.mass(), sheet.hash())
    });
    assert_eq!(one, two);
}
