//! Convex solids given by planes.

use bevy_math::{Vec3, Vec4};
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, Window},
    solid::{Near, Solid},
};

/// All that is behind each of these planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes<'a> {
    /// Unit normals and distances from the origin \[m\].
    pub planes: &'a [Vec4],
    /// Distance that is kept from the planes \[m\].
    pub margin: f32,
    /// Radius of the largest ball inside, about \[m\].
    pub size: f32,
}

impl Solid for Planes<'_> {
    #[inline(always)]
    fn size(&self) -> f32 {
        self.size
    }

    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Near<S> {
        let mut distance = S::f32s::splat(simd, f32::MIN);
        let mut out = V3::splat(simd, Vec3::Y);
        for plane in self.planes {
            let normal = V3::splat(simd, plane.truncate());
            let above = normal.dot(p) - plane.w;
            let nearer = above.simd_gt(distance);
            distance = nearer.select(above, distance);
            out = normal.select(nearer, out);
        }
        Near {
            distance: distance - self.margin,
            out,
        }
    }
}
