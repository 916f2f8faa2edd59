//! The inside of terrain, which the engines do not know.

use bevy_math::Vec3;

/// Depth of a point below terrain of these triangles \[m\]; far above if it is not over any.
pub fn depth(triangles: impl Iterator<Item = [Vec3; 3]>, point: Vec3) -> f32 {
    let flat = |v: Vec3| bevy_math::Vec2::new(v.x, v.z);
    let heights = triangles.filter_map(|[a, b, c]| {
        let (u, v, w) = (flat(b - a), flat(c - a), flat(point - a));
        let area = u.perp_dot(v);
        let (s, t) = (w.perp_dot(v) / area, u.perp_dot(w) / area);
        let over = s >= 0.0 && t >= 0.0 && s + t <= 1.0;
        over.then_some(a.y + s * (b.y - a.y) + t * (c.y - a.y))
    });
    heights.fold(f32::MIN, f32::max) - point.y
}
