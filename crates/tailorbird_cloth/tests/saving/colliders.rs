//! Colliders: their shapes are shared and private, and come back as what they were made from.

use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use tailorbird_cloth::{
    collider::{ConvexHull, TriMesh},
    prelude::*,
};

use crate::{comes_back, read, through_json, through_ron};

/// The corners of a cube, one point within it, and one in the middle of a side.
fn cube() -> Vec<Vec3> {
    let mut points: Vec<_> = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
        .collect();
    points.extend([Vec3::splat(0.5), Vec3::new(0.5, 0.5, 0.0)]);
    points
}

/// Points of a sphere, along a spiral.
fn ball() -> Vec<Vec3> {
    let point = |i: u32| {
        let up = (i as f32 + 0.5) / 100.0 - 1.0;
        let (sin, cos) = (2.4 * i as f32).sin_cos();
        let around = (1.0 - up * up).sqrt();
        Vec3::new(around * cos, up, around * sin) * 0.3
    };
    (0..200).map(point).collect()
}

fn compound() -> ClothCollider {
    let arm = ClothColliderShape::Capsule {
        radius: 0.05,
        half_length: 0.2,
    };
    let mesh = TriMesh::new([Vec3::ZERO, Vec3::X, Vec3::Y], [[0, 1, 2]]).unwrap();
    let turned = Isometry3d::new(Vec3::Y * 0.5, Quat::from_rotation_x(0.3));
    ClothCollider::compound([
        (Isometry3d::IDENTITY, arm),
        (turned, ClothColliderShape::TriMesh(mesh)),
    ])
    .unwrap()
}

#[test]
fn simple_shapes_come_back() {
    for collider in [
        ClothCollider::sphere(0.3),
        ClothCollider::capsule(0.1, 0.5),
        ClothCollider::tapered_capsule(0.1, 0.2, 0.5),
        ClothCollider::half_space(),
        ClothCollider::cuboid(1.0, 0.8, 0.1),
        ClothCollider::cylinder(0.4, 1.1),
    ] {
        comes_back(&collider.shape);
        comes_back(&collider.with_friction(0.8).with_margin(0.003));
    }
    comes_back(&ClothLayers::new(0b101, 0b10));
}

#[test]
fn meshes_fields_and_compounds_come_back() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    comes_back(&ClothCollider::trimesh(positions, [[0, 1, 2], [0, 2, 3]]).unwrap());
    let heights = vec![0.0, 0.2, 0.1, 0.3, 0.7, -0.4];
    comes_back(&ClothCollider::height_field(heights, 3, Vec2::new(5.0, 6.0)).unwrap());
    comes_back(&compound());
}

/// A hull is computed again from its corners, which need not come in the same order.
#[test]
fn a_hull_comes_back_as_the_same_body() {
    let sorted = |hull: &ConvexHull| {
        let mut corners: Vec<_> = hull.points().iter().map(Vec3::to_array).collect();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        corners
    };
    for points in [cube(), ball()] {
        let hull = ConvexHull::new(&points).unwrap();
        for back in [through_ron(&hull), through_json(&hull)] {
            assert_eq!(sorted(&back), sorted(&hull));
            let change = back.volume() / hull.volume() - 1.0;
            assert!(change.abs() < 1e-6, "{change}");
        }
    }
}

#[test]
fn a_collider_without_its_options_has_their_defaults() {
    let ball: ClothCollider = read("(shape: Sphere(radius: 0.5))");
    assert_eq!(ball, ClothCollider::sphere(0.5));
}

/// Compounds within a compound are taken apart, as the constructor does.
#[test]
fn a_compound_within_a_compound_is_taken_apart() {
    let place = "(rotation: (0, 0, 0, 1), translation: (0, 1, 0))";
    let inner = format!("Compound((parts: [({place}, Sphere(radius: 1))]))");
    let outer: ClothColliderShape = read(&format!("Compound((parts: [({place}, {inner})]))"));
    let ClothColliderShape::Compound(outer) = outer else {
        panic!("{outer:?}");
    };
    let [(at, ClothColliderShape::Sphere { .. })] = outer.parts() else {
        panic!("{outer:?}");
    };
    assert_eq!(Vec3::from(at.translation), Vec3::Y * 2.0);
}
