//! Directions in the planes of triangles.

use bevy_math::{Vec2, Vec3};

/// Least ratio of the square of a triangle's longest side to the sum of the other two squares for that side to be a diagonal. 1 is a right
/// angle.
const DIAGONAL: f32 = 0.9;

/// Direction in a triangle in which v grows and u is constant; `None` where the coordinates do not tell.
pub(super) fn along_v([a, b, c]: [Vec3; 3], [p, q, r]: [Vec2; 3]) -> Option<Vec3> {
    let [first, second] = [q - p, r - p];
    let area = first.perp_dot(second);
    let told = area.is_finite() && area.abs() > 1e-6 * first.length() * second.length();
    told.then(|| ((c - a) * first.x - (b - a) * second.x) * area.signum())
}

/// Coordinates in the plane of a triangle.
pub(super) struct TriangleFrame {
    /// Unit vector along the first side.
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) area: f32,
    /// Square of the length of each side \[m²\].
    pub(super) lengths: [f32; 3],
    /// Square of the direction of each side.
    pub(super) sides: [Vec2; 3],
    pub(super) diagonal: Option<usize>,
}

impl TriangleFrame {
    pub(super) fn new(corners: [Vec3; 3]) -> Self {
        let sides = [0, 1, 2].map(|k| corners[(k + 1) % 3] - corners[k]);
        let normal = sides[0].cross(sides[1]);
        let x = sides[0].normalize_or_zero();
        let mut frame = Self {
            x,
            y: normal.normalize_or_zero().cross(x),
            area: 0.5 * normal.length(),
            lengths: sides.map(Vec3::length_squared),
            sides: [Vec2::X; 3],
            diagonal: None,
        };
        frame.sides = sides.map(|side| square(frame.project(side).normalize_or(Vec2::X)));
        let sum: f32 = frame.lengths.iter().sum();
        frame.diagonal = (0..3)
            .max_by(|a, b| frame.lengths[*a].total_cmp(&frame.lengths[*b]))
            .filter(|k| frame.lengths[*k] >= DIAGONAL * (sum - frame.lengths[*k]));
        frame
    }

    pub(super) fn project(&self, v: Vec3) -> Vec2 {
        Vec2::new(v.dot(self.x), v.dot(self.y))
    }
}

pub(super) fn square(v: Vec2) -> Vec2 {
    v.rotate(v)
}

pub(super) fn conjugate(v: Vec2) -> Vec2 {
    Vec2::new(v.x, -v.y)
}

/// A square root of a unit number.
pub(super) fn root(v: Vec2) -> Vec2 {
    if v.x < 0.0 {
        Vec2::new(v.y, 1.0 - v.x).normalize_or(Vec2::Y)
    } else {
        Vec2::new(1.0 + v.x, v.y).normalize_or(Vec2::X)
    }
}
