//! Parry's shapes as shapes that cloth collides with.
//!
//! Each engine has its own version of parry, so each bridge has a function of its own that takes parry's types, which the macro
//! [`convert_parry!`](crate::convert_parry) writes. [`ShapePart`] does the work.

use std::f32::consts::TAU;

use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use tailorbird_cloth::{
    collider::{ClothColliderShape, ConvexHull, HeightField, TriMesh},
    error::ClothErrorKind,
};
use tracing::warn;

use crate::Piece;

/// Radius of what has none: segments and lines of them \[m\].
const LINE_RADIUS: f32 = 1e-3;

/// Corners of the circle under a cone.
const CONE_CORNERS: u32 = 32;

/// A part of an engine's shape, and the pieces found so far. Lengths are in metres; what cannot be converted is left out with a
/// warning.
#[derive(Debug)]
pub struct ShapePart<'a> {
    at: Isometry3d,
    margin: f32,
    pieces: &'a mut Vec<Piece>,
}

impl<'a> ShapePart<'a> {
    /// The whole shape, whose pieces go to a list.
    pub fn whole(pieces: &'a mut Vec<Piece>) -> Self {
        Self {
            at: Isometry3d::IDENTITY,
            margin: 0.0,
            pieces,
        }
    }

    /// A part of this one, at a pose in it.
    pub fn moved(&mut self, translation: Vec3, rotation: Quat) -> ShapePart<'_> {
        ShapePart {
            at: self.at * Isometry3d::new(translation, rotation),
            margin: self.margin,
            pieces: self.pieces,
        }
    }

    /// The same part, rounded off this far beyond its surface.
    pub fn rounded(&mut self, radius: f32) -> ShapePart<'_> {
        ShapePart {
            at: self.at,
            margin: self.margin + radius,
            pieces: self.pieces,
        }
    }

    /// Adds a shape at the part's own pose.
    pub fn add(&mut self, shape: ClothColliderShape) {
        self.pieces.push(Piece {
            margin: self.margin,
            ..Piece::new(self.at, shape)
        });
    }

    /// Adds all within a radius of the line between two points.
    pub fn add_capsule(&mut self, a: Vec3, b: Vec3, radius: f32) {
        let axis = b - a;
        let half_length = 0.5 * axis.length();
        let turn = axis.try_normalize().map_or(Quat::IDENTITY, |axis| {
            Quat::from_rotation_arc(Vec3::Y, axis)
        });
        self.moved(0.5 * (a + b), turn)
            .add(ClothColliderShape::Capsule {
                radius,
                half_length,
            });
    }

    /// Adds the line between two points, which is given a radius.
    pub fn add_line(&mut self, a: Vec3, b: Vec3) {
        self.add_capsule(a, b, LINE_RADIUS);
    }

    /// Adds all below a plane through the origin.
    pub fn add_half_space(&mut self, normal: Vec3) {
        let turn = Quat::from_rotation_arc(Vec3::Y, normal);
        self.moved(Vec3::ZERO, turn)
            .add(ClothColliderShape::HalfSpace);
    }

    /// Adds a cone along y, as the hull of its tip and of the circle below.
    pub fn add_cone(&mut self, radius: f32, half_height: f32) {
        let circle = (0..CONE_CORNERS).map(|k| {
            let (sin, cos) = (TAU * k as f32 / CONE_CORNERS as f32).sin_cos();
            Vec3::new(radius * cos, -half_height, radius * sin)
        });
        let corners: Vec<_> = circle.chain([Vec3::Y * half_height]).collect();
        self.add_hull(&corners);
    }

    /// Adds the convex hull of points.
    pub fn add_hull(&mut self, points: &[Vec3]) {
        self.add_valid(ConvexHull::new(points).map(ClothColliderShape::ConvexHull));
    }

    /// Adds triangles.
    pub fn add_mesh(&mut self, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) {
        self.add_valid(TriMesh::new(positions, triangles).map(ClothColliderShape::TriMesh));
    }

    /// Adds terrain over so many rows along z and columns along x, of this size.
    pub fn add_height_field(
        &mut self,
        rows: usize,
        columns: usize,
        height: impl Fn(usize, usize) -> f32,
        size: Vec2,
    ) {
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let heights: Vec<f32> = places.map(|(row, column)| height(row, column)).collect();
        let field = HeightField::new(heights, columns as u32, size);
        self.add_valid(field.map(ClothColliderShape::HeightField));
    }

    /// Leaves out shapes of these kinds.
    pub fn leave_out(&self, kinds: &str) {
        warn!("cloth does not collide with {kinds}");
    }

    fn add_valid(&mut self, shape: Result<ClothColliderShape, ClothErrorKind>) {
        match shape {
            Ok(shape) => self.add(shape),
            Err(error) => warn!("cloth does not collide with a shape: {error}"),
        }
    }
}

/// Defines the function `pieces(&dyn Shape) -> Vec<Piece>` for the parry at a path.
///
/// ```
/// mod shape {
///     tailorbird_bridge::convert_parry!(parry3d);
/// }
/// assert_eq!(shape::pieces(&parry3d::shape::Ball::new(0.5)).len(), 1);
/// ```
#[macro_export]
macro_rules! convert_parry {
    ($($parry:tt)+) => {
        use $($parry)+::shape::{HeightField, HeightFieldCellStatus, Shape, TypedShape};
        use $crate::{ClothColliderShape, Piece, ShapePart};

        /// The pieces of a shape; what cannot be converted is left out with a warning.
        pub(crate) fn pieces(shape: &dyn Shape) -> Vec<Piece> {
            let mut pieces = Vec::new();
            add(shape, ShapePart::whole(&mut pieces));
            pieces
        }

        fn add(shape: &dyn Shape, mut part: ShapePart<'_>) {
            match shape.as_typed_shape() {
                TypedShape::Ball(ball) => part.add(ClothColliderShape::Sphere { radius: ball.radius }),
                TypedShape::Cuboid(cuboid) => part.add(ClothColliderShape::Cuboid {
                    size: 2.0 * cuboid.half_extents,
                }),
                TypedShape::Cylinder(cylinder) => part.add(ClothColliderShape::Cylinder {
                    radius: cylinder.radius,
                    half_height: cylinder.half_height,
                }),
                TypedShape::Capsule(capsule) => {
                    part.add_capsule(capsule.segment.a, capsule.segment.b, capsule.radius)
                }
                TypedShape::Segment(line) => part.add_line(line.a, line.b),
                TypedShape::Polyline(lines) => {
                    lines.segments().for_each(|line| part.add_line(line.a, line.b))
                }
                TypedShape::HalfSpace(half_space) => part.add_half_space(half_space.normal),
                TypedShape::Cone(cone) => part.add_cone(cone.radius, cone.half_height),
                TypedShape::ConvexPolyhedron(hull) => part.add_hull(hull.points()),
                TypedShape::Triangle(triangle) => {
                    part.add_mesh(vec![triangle.a, triangle.b, triangle.c], vec![[0, 1, 2]])
                }
                TypedShape::TriMesh(mesh) => {
                    part.add_mesh(mesh.vertices().to_vec(), mesh.indices().to_vec())
                }
                TypedShape::HeightField(field) => add_height_field(field, part),
                TypedShape::Compound(compound) => {
                    for (pose, shape) in compound.shapes() {
                        add(&**shape, part.moved(pose.translation, pose.rotation));
                    }
                }
                TypedShape::RoundCuboid(it) => add(&it.inner_shape, part.rounded(it.border_radius)),
                TypedShape::RoundCylinder(it) => add(&it.inner_shape, part.rounded(it.border_radius)),
                TypedShape::RoundCone(it) => add(&it.inner_shape, part.rounded(it.border_radius)),
                TypedShape::RoundTriangle(it) => add(&it.inner_shape, part.rounded(it.border_radius)),
                TypedShape::RoundConvexPolyhedron(it) => {
                    add(&it.inner_shape, part.rounded(it.border_radius))
                }
                TypedShape::Voxels(_) | TypedShape::Custom(_) => {
                    part.leave_out("voxels and custom shapes")
                }
            }
        }

        /// Terrain; one with holes, or turned inside out, is a mesh.
        fn add_height_field(field: &HeightField, mut part: ShapePart<'_>) {
            let (grid, scale) = (field.heights(), field.scale());
            let removed = HeightFieldCellStatus::CELL_REMOVED;
            let cells = field.cells_statuses().data();
            if cells.iter().any(|cell| cell.contains(removed)) || scale.x <= 0.0 || scale.z <= 0.0 {
                let (positions, triangles) = field.to_trimesh();
                part.add_mesh(positions, triangles);
            } else {
                let height = |row, column| grid[(row, column)] * scale.y;
                part.add_height_field(grid.nrows(), grid.ncols(), height, [scale.x, scale.z].into());
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use bevy_math::{Quat, Vec2, Vec3};
    use parry3d::{math::Pose, shape::SharedShape, utils::Array2};

    crate::convert_parry!(parry3d);

    fn only(shape: &SharedShape) -> Piece {
        let mut all = pieces(&**shape);
        assert_eq!(all.len(), 1, "{all:?}");
        all.remove(0)
    }

    /// Terrain of 2 × 3 corners.
    fn terrain(scale: Vec3) -> HeightField {
        // Column by column.
        let heights = vec![0.0, 3.0, 1.0, 4.0, 2.0, 5.0];
        HeightField::new(Array2::new(2, 3, heights), scale)
    }

    #[test]
    fn capsules_lie_along_their_segment() {
        let (a, b) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 4.0));
        let piece = only(&SharedShape::capsule(a, b, 0.5));
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
        let piece = only(&SharedShape::round_cuboid(0.5, 1.0, 1.5, 0.1));
        assert_eq!(piece.margin, 0.1);
        let size = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(piece.shape, ClothColliderShape::Cuboid { size });
    }

    #[test]
    fn a_height_field_keeps_its_axes() {
        let parry = terrain(Vec3::new(4.0, 2.0, 6.0));
        let piece = only(&SharedShape::new(parry.clone()));
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
    fn a_height_field_with_a_hole_is_a_mesh() {
        let mut parry = terrain(Vec3::ONE);
        parry.set_cell_status(0, 1, HeightFieldCellStatus::CELL_REMOVED);
        let piece = only(&SharedShape::new(parry));
        let ClothColliderShape::TriMesh(mesh) = piece.shape else {
            panic!("{piece:?}");
        };
        assert_eq!(mesh.triangles().len(), 2);
    }

    #[test]
    fn a_half_space_looks_along_its_normal() {
        let normal = Vec3::new(0.6, 0.8, 0.0);
        let piece = only(&SharedShape::halfspace(normal));
        assert!((piece.at.rotation * Vec3::Y).distance(normal) < 1e-6);
    }

    #[test]
    fn parts_of_compounds_keep_their_places() {
        let turn = Quat::from_rotation_z(0.5);
        let ball = (Pose::from_parts(Vec3::X, turn), SharedShape::ball(0.5));
        let cone = (
            Pose::translation(0.0, 1.0, 0.0),
            SharedShape::cone(1.0, 1.0),
        );
        let all = pieces(&*SharedShape::compound(vec![ball, cone]));
        assert_eq!(all.len(), 2);
        assert!((all[0].at * Vec3::ZERO).distance(Vec3::X) < 1e-6);
        let ClothColliderShape::ConvexHull(cone) = &all[1].shape else {
            panic!("{all:?}");
        };
        // π r² h/3, less what is cut off between the corners of the circle.
        let volume = PI * 2.0 / 3.0;
        assert!((cone.volume() / volume - 1.0).abs() < 0.01);
    }
}
