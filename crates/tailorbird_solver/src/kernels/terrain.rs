//! Height fields over a rectangle, solid below.

use bevy_math::{UVec2, Vec2};
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, WIDEST, Window},
    solid::{DistanceFunction, Distances},
};

/// Heights in a grid around the origin; each cell is two triangles.
#[derive(Clone, Copy, Debug)]
pub struct Terrain<'a> {
    /// Row by row \[m\], before `stretch`.
    pub heights: &'a [f32],
    /// Columns along x, rows along z.
    pub resolution: UVec2,
    /// Sides of a cell \[m\]; negative where it is mirrored.
    pub cell: Vec2,
    /// Factor of the heights [-].
    pub stretch: f32,
    /// Distance that is kept from the surface \[m\].
    pub margin: f32,
}

impl Terrain<'_> {
    /// Height of a corner \[m\].
    #[inline(always)]
    fn height(&self, column: usize, row: usize) -> f32 {
        let i = row * self.resolution.x as usize + column;
        self.heights.get(i).copied().unwrap_or(0.0) * self.stretch
    }
}

impl DistanceFunction for Terrain<'_> {
    const CONVEX: bool = false;

    #[inline(always)]
    fn size(&self) -> f32 {
        f32::MAX
    }

    /// Distance from the plane of the triangle above or below the point.
    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let one = S::f32s::splat(simd, 1.0);
        let zero = S::f32s::splat(simd, 0.0);
        let last = (self.resolution - UVec2::ONE).as_vec2();
        let x = p.x * self.cell.x.recip() + 0.5 * last.x;
        let z = p.z * self.cell.y.recip() + 0.5 * last.y;
        let inside = x.simd_ge(zero)
            & z.simd_ge(zero)
            & x.simd_le(S::f32s::splat(simd, last.x))
            & z.simd_le(S::f32s::splat(simd, last.y));
        let column = x.max(zero).min(S::f32s::splat(simd, last.x - 1.0)).floor();
        let row = z.max(zero).min(S::f32s::splat(simd, last.y - 1.0)).floor();
        let (x, z) = (x - column, z - row);
        // True for the triangle that has the corner at the lowest x and z to itself, false for that of the highest.
        let low = (x + z).simd_le(one);
        let own = low.select(zero, one);
        let mut heights = [[0.0; WIDEST]; 3];
        for (k, own) in own.as_slice().iter().enumerate() {
            let (column, row) = (column.as_slice()[k] as usize, row.as_slice()[k] as usize);
            let own = *own as usize;
            heights[0][k] = self.height(column + own, row + own);
            heights[1][k] = self.height(column + 1, row);
            heights[2][k] = self.height(column, row + 1);
        }
        let own = S::f32s::from_slice(simd, &heights[0][..S::f32s::LEN]);
        let right = S::f32s::from_slice(simd, &heights[1][..S::f32s::LEN]);
        let back = S::f32s::from_slice(simd, &heights[2][..S::f32s::LEN]);
        let a = low.select(right - own, own - back);
        let b = low.select(back - own, own - right);
        let height = own + a * low.select(x, x - one) + b * low.select(z, z - one);
        let height = inside.select(height, S::f32s::splat(simd, f32::MIN));
        let a = inside.select(a, zero) * self.cell.x.recip();
        let b = inside.select(b, zero) * self.cell.y.recip();
        let length = (a * a + b * b + one).sqrt();
        Distances {
            distance: (p.y - height) / length - self.margin,
            out: V3 {
                x: zero - a,
                y: one,
                z: zero - b,
            },
            length,
        }
    }
}
