//! Vectors of space side by side.

use std::ops::{Add, Mul, Sub};

use fearless_simd::{Simd, prelude::*};

/// Vectors of space side by side.
#[derive(Clone, Copy)]
pub struct V3<S: Simd> {
    pub x: S::f32s,
    pub y: S::f32s,
    pub z: S::f32s,
}

impl<S: Simd> V3<S> {
    #[inline(always)]
    pub fn splat(simd: S, value: bevy_math::Vec3) -> Self {
        Self {
            x: S::f32s::splat(simd, value.x),
            y: S::f32s::splat(simd, value.y),
            z: S::f32s::splat(simd, value.z),
        }
    }

    /// This vector where `mask` holds, else `other`.
    #[inline(always)]
    pub fn select(self, mask: S::mask32s, other: Self) -> Self {
        Self {
            x: mask.select(self.x, other.x),
            y: mask.select(self.y, other.y),
            z: mask.select(self.z, other.z),
        }
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> S::f32s {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
}

impl<S: Simd> Add for V3<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl<S: Simd> Sub for V3<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

/// Each vector by the factor of its lane. (A factor of type `S::f32s` would overlap with other operators.)
#[derive(Clone, Copy)]
pub struct Factor<S: Simd>(pub S::f32s);

impl<S: Simd> Mul<V3<S>> for Factor<S> {
    type Output = V3<S>;

    #[inline(always)]
    fn mul(self, v: V3<S>) -> V3<S> {
        V3 {
            x: self.0 * v.x,
            y: self.0 * v.y,
            z: self.0 * v.z,
        }
    }
}
