//! Heights over a rectangle, solid below.

use bevy_math::{UVec2, Vec2};
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, WIDEST, Window},
    solid::{Near, Solid},
};

/// Heights in a grid around the origin; each cell is two triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terrain<'a> {
    /// Row by row \[m\], before `stretch`.
    pub heights: &'a [f32],
    /// Columns along x, rows along z.
    pub resolution: UVec2,
    /// Sides of a cell \[m\]; negative where it is mirrored.
    pub cell: Vec2,
    /// What heights are multiplied by.
    pub stretch: f32,
    /// Distance that is kept \[m\].
    pub margin: f32,
}

/// The plane of a triangle, at a point.
#[derive(Clone, Copy)]
struct Slope {
    height: f32,
    along_x: f32,
    along_z: f32,
}

impl Terrain<'_> {
    /// The surface at x and z; deep below everything where there is none.
    fn at(&self, x: f32, z: f32) -> Slope {
        let last = self.resolution - UVec2::ONE;
        let at = Vec2::new(x, z) / self.cell + 0.5 * last.as_vec2();
        if !(at.min_element() >= 0.0 && at.cmple(last.as_vec2()).all()) {
            return Slope {
                height: f32::MIN,
                along_x: 0.0,
                along_z: 0.0,
            };
        }
        let corner = at.as_uvec2().min(last - UVec2::ONE);
        let part = at - corner.as_vec2();
        let height = |right: u32, back: u32| {
            let i = (corner.y + back) * self.resolution.x + corner.x + right;
            self.heights.get(i as usize).copied().unwrap_or(0.0) * self.stretch
        };
        let (right, back) = (height(1, 0), height(0, 1));
        let near = part.x + part.y <= 1.0;
        let third = if near { height(0, 0) } else { height(1, 1) };
        // From the corner that the triangle has to itself.
        let (along_x, along_z) = if near {
            (right - third, back - third)
        } else {
            (third - back, third - right)
        };
        let from = if near { part } else { part - Vec2::ONE };
        Slope {
            height: third + along_x * from.x + along_z * from.y,
            along_x: along_x / self.cell.x,
            along_z: along_z / self.cell.y,
        }
    }
}

impl Solid for Terrain<'_> {
    const CONVEX: bool = false;

    #[inline(always)]
    fn size(&self) -> f32 {
        f32::MAX
    }

    /// The distance from the plane of the triangle above or below.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Near<S> {
        let mut lanes = [[0.0; WIDEST]; 3];
        let points = p.x.as_slice().iter().zip(p.z.as_slice());
        for (k, (x, z)) in points.enumerate() {
            let slope = self.at(*x, *z);
            lanes[0][k] = slope.height;
            lanes[1][k] = slope.along_x;
            lanes[2][k] = slope.along_z;
        }
        let [height, a, b] = lanes.map(
            #[inline(always)]
            |lanes| S::f32s::from_slice(simd, &lanes[..S::f32s::LEN]),
        );
        let one = S::f32s::splat(simd, 1.0);
        let zero = S::f32s::splat(simd, 0.0);
        let length = (a * a + b * b + one).sqrt();
        Near {
            distance: (p.y - height) / length - self.margin,
            out: V3 {
                x: zero - a,
                y: one,
                z: zero - b,
            },
        }
    }
}
