//! Balls and half-spaces as solids, for bodies that cloth pushes. For colliders that stay, or move by themselves, `sphere.rs` and
//! `half_space.rs` are faster.

use bevy_math::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::{
    lanes::{V3, Window},
    solid::{DistanceFunction, Distances},
};

/// A ball around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Radius \[m\].
    pub radius: f32,
}

impl DistanceFunction for Ball {
    #[inline(always)]
    fn size(&self) -> f32 {
        self.radius
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, _simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        let length = p.dot(p).sqrt();
        Distances {
            distance: length - self.radius,
            out: p,
            length,
        }
    }
}

/// Half-space of all points below the height `margin` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    pub margin: f32,
}

impl DistanceFunction for Ground {
    #[inline(always)]
    fn size(&self) -> f32 {
        f32::MAX
    }

    #[inline(always)]
    fn distances<S: Simd>(&self, simd: S, _window: Window, p: V3<S>) -> Distances<S> {
        Distances {
            distance: p.y - self.margin,
            out: V3::splat(simd, Vec3::Y),
            length: S::f32s::splat(simd, 1.0),
        }
    }
}
