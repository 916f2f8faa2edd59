//! Meshes that have rings and open chains.

use bevy_math::Vec3;

use crate::{
    shape::ClothShape,
    topology::{Topology, test_meshes::delaunay},
};

/// Tubes of 5, 9 and 9 edges around, of 8 rings: rings of different lengths side by side.
pub(super) fn tubes() -> Topology {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (k, around) in [5_u32, 9, 9].into_iter().enumerate() {
        let first = positions.len() as u32;
        positions.extend((0..8 * around).map(|i| {
            let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
            let radius = 0.5 / (0.5 * std::f32::consts::TAU / around as f32).sin();
            Vec3::new(
                radius * angle.cos() + 5.0 * k as f32,
                (i / around) as f32,
                radius * angle.sin(),
            )
        }));
        let at = |c: u32, r: u32| first + r * around + c % around;
        for i in 0..7 * around {
            let (c, r) = (i % around, i / around);
            let [a, b, d, e] = [at(c, r), at(c, r + 1), at(c + 1, r), at(c + 1, r + 1)];
            triangles.extend([a, b, d, d, b, e]);
        }
    }
    Topology::build(&ClothShape::mesh(positions, triangles), Vec3::ONE).expect("tubes")
}

/// A square of 12, whose edges are about as long as 1.
pub(super) fn patch() -> Topology {
    let (positions, triangles) = delaunay(12, 5);
    let positions = positions.into_iter().map(|p| p * 12.0).collect::<Vec<_>>();
    Topology::build(&ClothShape::mesh(positions, triangles.concat()), Vec3::ONE).expect("a mesh")
}
