//! Convex solids as intersections of half-spaces.

use bevy_math::{Vec3, Vec4};
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{Reading, V3, WIDEST, Window, each_window},
    solid::{DistanceFunction, Distances, lane},
};
use crate::{numbers::Numbers, points::Points};

/// Number of planes from which on only those are searched that can be the nearest to any point of a group.
const MANY: usize = 32;

/// Planes side by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneList {
    /// Unit normals.
    normal: Points,
    /// Distances from the origin \[m\].
    offset: Numbers,
}

impl PlaneList {
    /// Planes by their unit normals and distances from the origin \[m\]. The list is filled up with planes at infinity.
    pub fn new(planes: &[Vec4]) -> Self {
        let len = planes.len().next_multiple_of(WIDEST);
        let nowhere = std::iter::repeat_n(Vec4::W * f32::MAX, len - planes.len());
        let all = || planes.iter().copied().chain(nowhere.clone());
        let mut offset = Numbers::zeroed(len);
        for (to, plane) in offset.iter_mut().zip(all()) {
            *to = plane.w;
        }
        Self {
            normal: all().map(Vec4::truncate).collect(),
            offset,
        }
    }

    /// Height of a point above the planes of a window \[m\].
    #[inline(always)]
    fn above<S: Simd>(&self, simd: S, window: Window, point: V3<S>) -> S::f32s {
        let offset = Reading(&self.offset).load_at(simd, window);
        self.normal.window(simd, window, 0).dot(point) - offset
    }
}

/// Intersection of the half-spaces behind these planes.
#[derive(Clone, Copy, Debug)]
pub struct Planes<'a> {
    pub planes: &'a PlaneList,
    /// Distance that is kept from the planes \[m\].
    pub margin: f32,
    /// Approximate radius of the largest ball inside \[m\].
    pub size: f32,
}

/// Nearest plane so far, for each point.
#[derive(Clone, Copy)]
struct Nearest<S: Simd> {
    distance: S::f32s,
    out: V3<S>,
}

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    fn with(self, simd: S, planes: &PlaneList, k: usize, p: V3<S>) -> Self {
        let normal = V3::splat(simd, planes.normal.get(k));
        let above = normal.dot(p) - planes.offset[k];
        let nearer = above.simd_gt(self.distance);
        Self {
            distance: nearer.select(above, self.distance),
            out: normal.select(nearer, self.out),
        }
    }
}

impl Planes<'_> {
    /// Finds the nearest planes of points that lie near each other.
    ///
    /// Let m be the plane nearest to the middle of the points, and ρ the largest distance of a point from the middle. Plane k can be nearer
    /// than m to a point only if it is no further from the middle than m by |n′ − n| ρ, with n and n′ their normals.
    #[inline(always)]
    fn of_some<S: Simd>(&self, simd: S, p: V3<S>, mut nearest: Nearest<S>) -> Nearest<S> {
        let middle = Vec3::new(middle::<S>(p.x), middle::<S>(p.y), middle::<S>(p.z));
        let center = V3::splat(simd, middle);
        let apart = p - center;
        let apart = apart.dot(apart);
        let mut apart2 = 0.0f32;
        for lane in apart.as_slice() {
            apart2 = apart2.max(*lane);
        }
        let len = self.planes.offset.len();
        let mut most = Nearest {
            distance: S::f32s::splat(simd, f32::MIN),
            out: V3::splat(simd, Vec3::Y),
        };
        each_window(
            simd,
            0..len,
            #[inline(always)]
            |window| {
                let above = self.planes.above(simd, window, center);
                let nearer = above.simd_gt(most.distance);
                let normal = self.planes.normal.window(simd, window, 0);
                most = Nearest {
                    distance: nearer.select(above, most.distance),
                    out: normal.select(nearer, most.out),
                };
            },
        );
        let mut best = 0;
        for (k, distance) in most.distance.as_slice().iter().enumerate() {
            if *distance > most.distance.as_slice()[best] {
                best = k;
            }
        }
        let (highest, normal) = (most.distance.as_slice()[best], lane(most.out, best));
        let rounding = 1e-5 * (highest.abs() + middle.abs().max_element() + apart2.sqrt());
        let highest = S::f32s::splat(simd, highest - rounding);
        let normal = V3::splat(simd, normal);
        let one = S::f32s::splat(simd, 1.0);
        let zero = S::f32s::splat(simd, 0.0);
        each_window(
            simd,
            0..len,
            #[inline(always)]
            |window| {
                let further = (highest - self.planes.above(simd, window, center)).max(zero);
                let turned = self.planes.normal.window(simd, window, 0) - normal;
                let turned2 = turned.dot(turned) * (1.001 * apart2);
                let candidates = (further * further).simd_le(turned2);
                if candidates.any_true() {
                    let lanes = candidates.select(one, zero);
                    for (k, lane) in lanes.as_slice().iter().enumerate() {
                        if *lane != 0.0 {
                            nearest = nearest.with(simd, self.planes, window.at + k, p);
                        }
                    }
                }
            },
        );
        nearest
    }
}

/// Mean of the lowest and the highest of some numbers side by side.
#[inline(always)]
fn middle<S: Simd>(values: S::f32s) -> f32 {
    let values = values.as_slice();
    let (mut low, mut high) = (values[0], values[0]);
    for &value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    0.5 * (low + high)
}

impl DistanceFunction for Planes<'_> {
    #[inline(always)]
    fn size(&self) -> f32 {
        self.size
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let mut nearest = Nearest {
            distance: S::f32s::splat(simd, f32::MIN),
            out: V3::splat(simd, Vec3::Y),
        };
        let len = self.planes.offset.len();
        if len < MANY {
            for k in 0..len {
                nearest = nearest.with(simd, self.planes, k, p);
            }
        } else {
            nearest = self.of_some(simd, p, nearest);
        }
        Distances {
            distance: nearest.distance - self.margin,
            out: nearest.out,
            length: S::f32s::splat(simd, 1.0),
        }
    }
}
