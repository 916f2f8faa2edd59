//! Parry's shapes as shapes that cloth collides with.

use std::f32::consts::TAU;

use avian3d::parry::{
    math::Pose,
    shape::{HeightField as ParryHeightField, Shape, TypedShape},
};
use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use tailorbird_bridge::Piece;
use tailorbird_cloth::{
    collider::{ClothColliderShape, ConvexHull, HeightField, TriMesh},
    error::ClothErrorKind,
};
use tracing::warn;

/// Radius of what has none: segments and lines of them \[m\].
const LINE_RADIUS: f32 = 1e-3;

/// Corners of the circle under a cone.
const CONE_CORNERS: u32 = 32;

/// The pieces of a shape; what cannot be converted is left out with a warning.
pub(crate) fn pieces(shape: &dyn Shape) -> Vec<Piece> {
    let mut pieces = Vec::new();
    add(shape, Isometry3d::IDENTITY, 0.0, &mut pieces);
    pieces
}

pub(crate) fn isometry(pose: &Pose) -> Isometry3d {
    Isometry3d::new(pose.translation, pose.rotation)
}

fn add(shape: &dyn Shape, at: Isometry3d, margin: f32, pieces: &mut Vec<Piece>) {
    let mut push = |at: Isometry3d, shape: ClothColliderShape| {
        pieces.push(Piece {
            margin,
            ..Piece::new(at, shape)
        });
    };
    let complex = match shape.as_typed_shape() {
        TypedShape::Ball(ball) => {
            push(
                at,
                ClothColliderShape::Sphere {
                    radius: ball.radius,
                },
            );
            return;
        }
        TypedShape::Cuboid(cuboid) => {
            let size = 2.0 * cuboid.half_extents;
            push(at, ClothColliderShape::Cuboid { size });
            return;
        }
        TypedShape::Capsule(capsule) => {
            let (to, shape) = stick(capsule.segment.a, capsule.segment.b, capsule.radius);
            push(at * to, shape);
            return;
        }
        TypedShape::Segment(segment) => {
            let (to, shape) = stick(segment.a, segment.b, LINE_RADIUS);
            push(at * to, shape);
            return;
        }
        TypedShape::Polyline(line) => {
            for segment in line.segments() {
                let (to, shape) = stick(segment.a, segment.b, LINE_RADIUS);
                push(at * to, shape);
            }
            return;
        }
        TypedShape::HalfSpace(half_space) => {
            let to = Isometry3d::from_rotation(Quat::from_rotation_arc(Vec3::Y, half_space.normal));
            push(at * to, ClothColliderShape::HalfSpace);
            return;
        }
        TypedShape::Cylinder(cylinder) => {
            push(
                at,
                ClothColliderShape::Cylinder {
                    radius: cylinder.radius,
                    half_height: cylinder.half_height,
                },
            );
            return;
        }
        TypedShape::Compound(compound) => {
            for (to, part) in compound.shapes() {
                add(&**part, at * isometry(to), margin, pieces);
            }
            return;
        }
        TypedShape::RoundCuboid(round) => {
            return add(&round.inner_shape, at, margin + round.border_radius, pieces);
        }
        TypedShape::RoundCylinder(round) => {
            return add(&round.inner_shape, at, margin + round.border_radius, pieces);
        }
        TypedShape::RoundCone(round) => {
            return add(&round.inner_shape, at, margin + round.border_radius, pieces);
        }
        TypedShape::RoundTriangle(round) => {
            return add(&round.inner_shape, at, margin + round.border_radius, pieces);
        }
        TypedShape::RoundConvexPolyhedron(round) => {
            return add(&round.inner_shape, at, margin + round.border_radius, pieces);
        }
        TypedShape::Cone(cone) => hull(&cone_corners(cone.radius, cone.half_height)),
        TypedShape::ConvexPolyhedron(hulled) => hull(hulled.points()),
        TypedShape::Triangle(triangle) => {
            mesh(vec![triangle.a, triangle.b, triangle.c], vec![[0, 1, 2]])
        }
        TypedShape::TriMesh(triangles) => {
            mesh(triangles.vertices().to_vec(), triangles.indices().to_vec())
        }
        TypedShape::HeightField(field) => height_field(field),
        TypedShape::Voxels(_) | TypedShape::Custom(_) => {
            warn!("cloth does not collide with voxels and custom shapes");
            return;
        }
    };
    match complex {
        Ok(shape) => push(at, shape),
        Err(error) => warn!("cloth does not collide with a shape: {error}"),
    }
}

/// All within a radius of the line between two points \[m\].
fn stick(a: Vec3, b: Vec3, radius: f32) -> (Isometry3d, ClothColliderShape) {
    let axis = b - a;
    let half_length = 0.5 * axis.length();
    let turn = axis.try_normalize().map_or(Quat::IDENTITY, |axis| {
        Quat::from_rotation_arc(Vec3::Y, axis)
    });
    let shape = ClothColliderShape::Capsule {
        radius,
        half_length,
    };
    (Isometry3d::new(0.5 * (a + b), turn), shape)
}

fn hull(points: &[Vec3]) -> Result<ClothColliderShape, ClothErrorKind> {
    ConvexHull::new(points).map(ClothColliderShape::ConvexHull)
}

fn mesh(
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
) -> Result<ClothColliderShape, ClothErrorKind> {
    TriMesh::new(positions, triangles).map(ClothColliderShape::TriMesh)
}

/// Corners of a cone: those of the circle below, and the tip \[m\].
fn cone_corners(radius: f32, half_height: f32) -> Vec<Vec3> {
    let circle = (0..CONE_CORNERS).map(|k| {
        let (sin, cos) = (TAU * k as f32 / CONE_CORNERS as f32).sin_cos();
        Vec3::new(radius * cos, -half_height, radius * sin)
    });
    circle.chain([Vec3::Y * half_height]).collect()
}

/// Terrain; one with holes, or turned inside out, is a mesh.
fn height_field(field: &ParryHeightField) -> Result<ClothColliderShape, ClothErrorKind> {
    let scale = field.scale();
    let whole = field
        .cells_statuses()
        .data()
        .iter()
        .all(|cell| !cell.contains(avian3d::parry::shape::HeightFieldCellStatus::CELL_REMOVED));
    if !whole || scale.x <= 0.0 || scale.z <= 0.0 {
        let (positions, triangles) = field.to_trimesh();
        return mesh(positions, triangles);
    }
    let grid = field.heights();
    let (rows, columns) = (grid.nrows(), grid.ncols());
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let heights: Vec<f32> = cells
        .map(|(row, column)| grid[(row, column)] * scale.y)
        .collect();
    let size = Vec2::new(scale.x, scale.z);
    HeightField::new(heights, columns as u32, size).map(ClothColliderShape::HeightField)
}

#[cfg(test)]
mod tests {
    use avian3d::prelude::*;

    use super::*;

    fn only(collider: &Collider) -> Piece {
        let mut all = pieces(&**collider.shape_scaled());
        assert_eq!(all.len(), 1, "{all:?}");
        all.remove(0)
    }

    #[test]
    fn capsules_lie_along_their_segment() {
        let (a, b) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 4.0));
        let piece = only(&Collider::capsule_endpoints(0.5, a, b));
        let ClothColliderShape::Capsule {
            radius,
            half_length,
        } = piece.shape
        else {
            panic!("{piece:?}");
        };
        assert_eq!((radius, half_length), (0.5, 2.0));
        assert!((piece.at * (Vec3::Y * half_length)).distance(b) < 1e-6);
        assert!((piece.at * (Vec3::NEG_Y * half_length)).distance(a) < 1e-6);
    }

    #[test]
    fn round_shapes_get_a_margin() {
        let piece = only(&Collider::round_cuboid(1.0, 2.0, 3.0, 0.1));
        assert_eq!(piece.margin, 0.1);
        let size = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(piece.shape, ClothColliderShape::Cuboid { size });
    }

    #[test]
    fn a_height_field_keeps_its_axes() {
        let heights = vec![vec![0.0, 1.0, 2.0], vec![3.0, 4.0, 5.0]];
        let collider = Collider::heightfield(heights, Vec3::new(4.0, 2.0, 6.0));
        let parry = collider.shape_scaled().as_heightfield().unwrap();
        let piece = only(&collider);
        let ClothColliderShape::HeightField(field) = piece.shape else {
            panic!("{piece:?}");
        };
        assert_eq!(field.size(), Vec2::new(4.0, 6.0));
        // Where parry has a corner, the height is there, too.
        let (columns, rows) = (field.resolution().x, field.resolution().y);
        let mut found = 0;
        for corner in parry.triangles().flat_map(|t| [t.a, t.b, t.c]) {
            let place = Vec2::new(corner.x, corner.z) / field.size() + 0.5;
            let column = (place.x * (columns - 1) as f32).round() as u32;
            let row = (place.y * (rows - 1) as f32).round() as u32;
            let height = field.heights()[(row * columns + column) as usize];
            assert!((height - corner.y).abs() < 1e-6, "{corner}: {height}");
            found += 1;
        }
        assert_eq!(found, 2 * 2 * 3);
    }

    #[test]
    fn a_half_space_looks_along_its_normal() {
        let normal = Vec3::new(0.6, 0.8, 0.0);
        let piece = only(&Collider::half_space(normal));
        assert!((piece.at.rotation * Vec3::Y).distance(normal) < 1e-6);
    }

    #[test]
    fn parts_of_compounds_keep_their_places() {
        let turn = Quat::from_rotation_z(0.5);
        let parts = vec![
            (Vec3::X, turn, Collider::sphere(0.5)),
            (Vec3::Y, Quat::IDENTITY, Collider::cone(1.0, 2.0)),
        ];
        let all = pieces(&**Collider::compound(parts).shape_scaled());
        assert_eq!(all.len(), 2);
        assert!((all[0].at * Vec3::ZERO).distance(Vec3::X) < 1e-6);
        let ClothColliderShape::ConvexHull(cone) = &all[1].shape else {
            panic!("{all:?}");
        };
        // π r² h/3, less what is cut off between the corners of the circle.
        let volume = std::f32::consts::PI * 2.0 / 3.0;
        assert!((cone.volume() / volume - 1.0).abs() < 0.01);
    }
}
