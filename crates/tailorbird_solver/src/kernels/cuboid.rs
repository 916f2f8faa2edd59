//! Boxes. A margin makes them larger and leaves their edges sharp.

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, Window},
    solid::{DistanceFunction, Distances},
};

/// Box around the origin: all points within `half_size` of it along each axis \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    pub half_size: Vec3,
}

/// Distance from 0, and the direction away from it.
#[inline(always)]
pub(super) fn away<S: Simd>(simd: S, x: S::f32s) -> (S::f32s, S::f32s) {
    let zero = S::f32s::splat(simd, 0.0);
    let one = S::f32s::splat(simd, 1.0);
    (x.max(zero - x), x.simd_lt(zero).select(zero - one, one))
}

impl DistanceFunction for Cuboid {
    const COMMON: bool = true;

    #[inline(always)]
    fn size(&self) -> f32 {
        self.half_size.min_element()
    }

    /// Distance from the plane of the nearest face, which is less than that from an edge.
    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let zero = S::f32s::splat(simd, 0.0);
        let ((x, right), (y, up), (z, front)) = (away(simd, p.x), away(simd, p.y), away(simd, p.z));
        let x = x - self.half_size.x;
        let y = y - self.half_size.y;
        let z = z - self.half_size.z;
        let distance = x.max(y).max(z);
        let on_y = y.simd_ge(distance);
        let on_x = x.simd_ge(distance) & !on_y;
        let on_z = !(on_x | on_y);
        Distances {
            distance,
            out: V3 {
                x: on_x.select(right, zero),
                y: on_y.select(up, zero),
                z: on_z.select(front, zero),
            },
            length: S::f32s::splat(simd, 1.0),
        }
    }
}
