//! Shapes to collide with, and how far points are from them, by formulas that the library does not use.

use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use tailorbird_cloth::prelude::*;

/// A shape with the distance of points from its surface, negative inside, in its own axes \[m\].
pub struct Case {
    pub name: &'static str,
    pub collider: ClothCollider,
    pub distance: fn(Vec3) -> f32,
}

/// The corners of a box.
fn corners(half: Vec3) -> Vec<Vec3> {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    (0..8)
        .map(|k| half * Vec3::new(sign(k & 1), sign(k & 2), sign(k & 4)))
        .collect()
}

/// The triangles between them, seen from outside.
const SIDES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

fn box_distance(p: Vec3, half: Vec3) -> f32 {
    let q = p.abs() - half;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}

fn segment_distance(p: Vec3, half_length: f32) -> f32 {
    (p - Vec3::Y * p.y.clamp(-half_length, half_length)).length()
}

fn tapered(p: Vec3) -> f32 {
    // The nearest of many balls.
    let ball = |k: u32| {
        let part = k as f32 / 2000.0;
        (p - Vec3::Y * (0.6 * part - 0.3)).length() - (0.3 - 0.2 * part)
    };
    (0..=2000).map(ball).fold(f32::MAX, f32::min)
}

fn octahedron(p: Vec3) -> f32 {
    (p.abs().element_sum() - 0.5) / 3f32.sqrt()
}

/// A mesh of the surface of a box of 1 × 0.4 × 1 m, its faces cut into `n`² squares.
pub fn fine_box(n: u32) -> ClothCollider {
    let half = Vec3::new(0.5, 0.2, 0.5);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for j in 0..=n {
                for i in 0..=n {
                    let part = |k: u32| 2.0 * k as f32 / n as f32 - 1.0;
                    let mut p = Vec3::ZERO;
                    p[axis] = sign;
                    p[(axis + 1) % 3] = part(i);
                    p[(axis + 2) % 3] = part(j);
                    positions.push(p * half);
                }
            }
            for j in 0..n {
                for i in 0..n {
                    let a = first + j * (n + 1) + i;
                    let [b, c, d] = [a + 1, a + n + 1, a + n + 2];
                    if sign > 0.0 {
                        triangles.extend([[a, b, d], [a, d, c]]);
                    } else {
                        triangles.extend([[a, d, b], [a, c, d]]);
                    }
                }
            }
        }
    }
    ClothCollider::trimesh(positions, triangles).expect("a box")
}

pub fn all() -> Vec<Case> {
    let half = Vec3::new(0.5, 0.2, 0.5);
    let octahedron_points: Vec<Vec3> = [Vec3::X, Vec3::Y, Vec3::Z]
        .into_iter()
        .flat_map(|v| [0.5 * v, -0.5 * v])
        .collect();
    let ball = ClothColliderShape::Sphere { radius: 0.25 };
    let at = |x: f32| Isometry3d::new(Vec3::X * x, Quat::IDENTITY);
    vec![
        Case {
            name: "sphere",
            collider: ClothCollider::sphere(0.4),
            distance: |p| p.length() - 0.4,
        },
        Case {
            name: "capsule",
            collider: ClothCollider::capsule(0.2, 0.8),
            distance: |p| segment_distance(p, 0.4) - 0.2,
        },
        Case {
            name: "tapered capsule",
            collider: ClothCollider::tapered_capsule(0.3, 0.1, 0.6),
            distance: tapered,
        },
        Case {
            name: "cuboid",
            collider: ClothCollider::cuboid(1.0, 0.4, 1.0),
            distance: |p| box_distance(p, Vec3::new(0.5, 0.2, 0.5)),
        },
        Case {
            name: "cylinder",
            collider: ClothCollider::cylinder(0.3, 0.8),
            distance: |p| {
                let q = Vec2::new(p.x.hypot(p.z) - 0.3, p.y.abs() - 0.4);
                q.max(Vec2::ZERO).length() + q.max_element().min(0.0)
            },
        },
        Case {
            name: "box of points",
            collider: ClothCollider::convex_hull(&corners(half)).expect("a box"),
            distance: |p| box_distance(p, Vec3::new(0.5, 0.2, 0.5)),
        },
        Case {
            name: "octahedron of points",
            collider: ClothCollider::convex_hull(&octahedron_points).expect("an octahedron"),
            distance: octahedron,
        },
        Case {
            name: "box of triangles",
            collider: ClothCollider::trimesh(corners(half), SIDES).expect("a box"),
            distance: |p| box_distance(p, Vec3::new(0.5, 0.2, 0.5)),
        },
        Case {
            name: "fine box of triangles",
            collider: fine_box(12),
            distance: |p| box_distance(p, Vec3::new(0.5, 0.2, 0.5)),
        },
        Case {
            name: "compound",
            collider: ClothCollider::compound([(at(-0.3), ball.clone()), (at(0.3), ball)])
                .expect("two balls"),
            distance: |p| {
                let to = |x: f32| (p - Vec3::X * x).length() - 0.25;
                to(-0.3).min(to(0.3))
            },
        },
    ]
}
