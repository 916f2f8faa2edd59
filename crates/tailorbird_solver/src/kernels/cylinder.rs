//! Cylinders. A margin makes them larger and leaves their edges sharp.

use fearless_simd::{Simd, prelude::*};

use super::{
    cuboid::away,
    lanes::{V3, Window},
    solid::{DistanceFunction, Distances},
};

/// Cylinder along y around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius \[m\].
    pub radius: f32,
    /// Half its height \[m\].
    pub half_height: f32,
}

impl DistanceFunction for Cylinder {
    #[inline(always)]
    fn size(&self) -> f32 {
        self.radius.min(self.half_height)
    }

    /// Distance from its side, or from the plane of its nearest end.
    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let zero = S::f32s::splat(simd, 0.0);
        let (y, up) = away(simd, p.y);
        let end = y - self.half_height;
        let from_axis = (p.x * p.x + p.z * p.z).sqrt();
        let side = from_axis - self.radius;
        let on_end = end.simd_ge(side);
        Distances {
            distance: end.max(side),
            out: V3 {
                x: on_end.select(zero, p.x),
                y: on_end.select(up, zero),
                z: on_end.select(zero, p.z),
            },
            length: on_end.select(S::f32s::splat(simd, 1.0), from_axis),
        }
    }
}
