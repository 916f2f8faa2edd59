//! The shapes of colliders, as lines.

use bevy_color::{Srgba, palettes::tailwind};
use bevy_ecs::prelude::*;
use bevy_gizmos::{gizmos::Gizmos, primitives::dim3::GizmoPrimitive3d};
use bevy_math::{Affine3A, Isometry3d, Quat, Vec2, Vec3};
use bevy_shape::{Capsule3d, Cylinder};
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::{collider::HeightField, prelude::*};

use super::ClothGizmos;

const COLOR: Srgba = tailwind::ORANGE_400;

/// Side of the square that stands for a half-space \[m\].
const GROUND: f32 = 10.0;

pub(super) fn draw(
    colliders: Query<(&ClothCollider, &GlobalTransform)>,
    mut gizmos: Gizmos<ClothGizmos>,
) {
    for (collider, transform) in &colliders {
        draw_shape(&mut gizmos, &collider.shape, transform.affine());
    }
}

fn draw_shape(gizmos: &mut Gizmos<ClothGizmos>, shape: &ClothColliderShape, at: Affine3A) {
    let (scale, rotation, translation) = at.to_scale_rotation_translation();
    let place = Isometry3d::new(translation, rotation);
    let most = scale.abs().max_element();
    let points =
        |points: &[Vec3]| -> Vec<Vec3> { points.iter().map(|p| at.transform_point3(*p)).collect() };
    match shape {
        ClothColliderShape::Sphere { radius } => {
            gizmos.sphere(place, radius * most, COLOR);
        }
        ClothColliderShape::Capsule {
            radius,
            half_length,
        } => {
            let capsule = Capsule3d {
                radius: radius * most,
                half_length: half_length * most,
            };
            gizmos.primitive_3d(&capsule, place, COLOR);
        }
        ClothColliderShape::TaperedCapsule {
            bottom_radius,
            top_radius,
            half_length,
        } => {
            let [bottom, top, half] = [bottom_radius, top_radius, half_length].map(|v| v * most);
            draw_tapered(gizmos, [bottom, top], half, place);
        }
        ClothColliderShape::HalfSpace => {
            let flat = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
            let square = place * Isometry3d::from_rotation(flat);
            gizmos.rect(square, Vec2::splat(GROUND), COLOR);
            gizmos.ray(translation, rotation * Vec3::Y, COLOR);
        }
        ClothColliderShape::Cuboid { size } => {
            gizmos.cube(at * Affine3A::from_scale(*size), COLOR);
        }
        ClothColliderShape::Cylinder {
            radius,
            half_height,
        } => {
            let cylinder = Cylinder {
                radius: radius * most,
                half_height: half_height * most,
            };
            gizmos.primitive_3d(&cylinder, place, COLOR);
        }
        ClothColliderShape::ConvexHull(hull) => {
            draw_triangles(gizmos, &points(hull.points()), hull.triangles());
        }
        ClothColliderShape::TriMesh(mesh) => {
            draw_triangles(gizmos, &points(mesh.positions()), mesh.triangles());
        }
        ClothColliderShape::HeightField(field) => draw_terrain(gizmos, field, at),
        ClothColliderShape::Compound(compound) => {
            for (part, shape) in compound.parts() {
                let part = Affine3A::from_rotation_translation(
                    part.rotation,
                    Vec3::from(part.translation),
                );
                draw_shape(gizmos, shape, at * part);
            }
        }
        _ => {}
    }
}

/// Both balls, and lines that touch them from one to the other.
fn draw_tapered(
    gizmos: &mut Gizmos<ClothGizmos>,
    [bottom, top]: [f32; 2],
    half: f32,
    place: Isometry3d,
) {
    let ends = [(-half, bottom), (half, top)];
    for (y, radius) in ends {
        let center = place * (Vec3::Y * y);
        gizmos.sphere(Isometry3d::new(center, place.rotation), radius, COLOR);
    }
    let slope = (bottom - top) / (2.0 * half);
    // Else one ball holds the other.
    if slope.abs() < 1.0 {
        let across = (1.0 - slope * slope).sqrt();
        for side in [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
            let out = side * across + Vec3::Y * slope;
            let [from, to] = ends.map(|(y, radius)| place * (Vec3::Y * y + out * radius));
            gizmos.line(from, to, COLOR);
        }
    }
}

fn draw_triangles(gizmos: &mut Gizmos<ClothGizmos>, points: &[Vec3], triangles: &[[u32; 3]]) {
    for [a, b, c] in triangles {
        gizmos.lineloop([a, b, c].map(|k| points[*k as usize]), COLOR);
    }
}

fn draw_terrain(gizmos: &mut Gizmos<ClothGizmos>, field: &HeightField, at: Affine3A) {
    let [columns, rows] = field.resolution().to_array();
    let point = |column: u32, row: u32| {
        let part = Vec2::new(
            column as f32 / (columns - 1) as f32,
            row as f32 / (rows - 1) as f32,
        );
        let [x, z] = ((part - 0.5) * field.size()).to_array();
        let height = field.heights()[(row * columns + column) as usize];
        at.transform_point3(Vec3::new(x, height, z))
    };
    for row in 0..rows {
        gizmos.linestrip((0..columns).map(|column| point(column, row)), COLOR);
    }
    for column in 0..columns {
        gizmos.linestrip((0..rows).map(|row| point(column, row)), COLOR);
    }
}
