//! Capsules, straight and tapered: a row of balls on an axis.

use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, Window},
    solid::{DistanceFunction, Distances},
};

/// Convex hull of two balls on the y axis.
///
/// The ball at the height t has the radius r₀ − b t. For a point at the distance ρ from the axis, the nearest ball is the one for which the
/// direction to the point has the slope of the surface: t = y − ρ b/√(1 − b²), or the first or last ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Height of the lower ball \[m\].
    bottom: f32,
    /// Distance from the lower ball's centre to the upper one's \[m\].
    length: f32,
    /// Radius of the lower ball \[m\].
    radius: f32,
    /// Decrease of the radius along the axis, b [-].
    shrinks: f32,
    /// b/√(1 − b²) [-].
    slope: f32,
}

impl Capsule {
    /// Hull of two balls with these radii \[m\], `half_length` \[m\] below and above the origin, and all points within `margin` of it.
    pub fn new(bottom_radius: f32, top_radius: f32, half_length: f32, margin: f32) -> Self {
        let length = 2.0 * half_length;
        let difference = bottom_radius - top_radius;
        if difference.abs() >= length {
            // One ball contains the other.
            let bottom = if difference > 0.0 {
                -half_length
            } else {
                half_length
            };
            return Self {
                bottom,
                length: 0.0,
                radius: bottom_radius.max(top_radius) + margin,
                shrinks: 0.0,
                slope: 0.0,
            };
        }
        let shrinks = difference / length;
        Self {
            bottom: -half_length,
            length,
            radius: bottom_radius + margin,
            shrinks,
            slope: shrinks / (1.0 - shrinks * shrinks).sqrt(),
        }
    }
}

impl DistanceFunction for Capsule {
    const COMMON: bool = true;

    #[inline(always)]
    fn size(&self) -> f32 {
        self.radius.min(self.radius - self.shrinks * self.length)
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let zero = S::f32s::splat(simd, 0.0);
        let height = p.y - self.bottom;
        let mut ball = height;
        if self.slope != 0.0 {
            ball -= (p.x * p.x + p.z * p.z).sqrt() * self.slope;
        }
        let ball = ball.max(zero).min(S::f32s::splat(simd, self.length));
        let out = V3 {
            y: height - ball,
            ..p
        };
        let radius = S::f32s::splat(simd, self.radius) - ball * self.shrinks;
        let length = out.dot(out).sqrt();
        Distances {
            distance: length - radius,
            out,
            length,
        }
    }
}
