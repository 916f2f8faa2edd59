//! Points as three parallel arrays.

use bevy_math::Vec3;
use fearless_simd::Level;

use crate::solver::kernels::range::is_finite;

use crate::memory::heap;

/// Points (or vectors) stored as three arrays of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// First coordinates.
    pub x: Vec<f32>,
    /// Second coordinates.
    pub y: Vec<f32>,
    /// Third coordinates.
    pub z: Vec<f32>,
}

impl Points {
    /// `len` points at zero.
    pub fn zeroed(len: usize) -> Self {
        Self {
            x: vec![0.0; len],
            y: vec![0.0; len],
            z: vec![0.0; len],
        }
    }

    /// What they take on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.x) + heap(&self.y) + heap(&self.z)
    }

    /// The number of points.
    #[inline]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are as many as this of each coordinate.
    pub(crate) fn is_of(&self, len: usize) -> bool {
        [&self.x, &self.y, &self.z]
            .into_iter()
            .all(|values| values.len() == len)
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The point with this index.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Overwrites the point with this index.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn set(&mut self, i: usize, value: Vec3) {
        self.x[i] = value.x;
        self.y[i] = value.y;
        self.z[i] = value.z;
    }

    /// Adds to the point with this index.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn add(&mut self, i: usize, value: Vec3) {
        self.x[i] += value.x;
        self.y[i] += value.y;
        self.z[i] += value.z;
    }

    /// All points in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Makes this a copy of `other` without allocating where the lengths agree.
    pub fn copy_from(&mut self, other: &Self) {
        self.x.clone_from(&other.x);
        self.y.clone_from(&other.y);
        self.z.clone_from(&other.z);
    }

    /// Removes all points and keeps the memory.
    pub fn clear(&mut self) {
        self.each(Vec::clear);
    }

    /// Makes it `len` points, with `value` as the coordinates of new ones.
    pub fn resize(&mut self, len: usize, value: f32) {
        self.each(|values| values.resize(len, value));
    }

    fn each(&mut self, f: impl FnMut(&mut Vec<f32>)) {
        [&mut self.x, &mut self.y, &mut self.z]
            .into_iter()
            .for_each(f);
    }

    /// Overwrites every point.
    pub fn fill(&mut self, value: Vec3) {
        self.x.fill(value.x);
        self.y.fill(value.y);
        self.z.fill(value.z);
    }

    /// Whether no coordinate is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        let level = Level::new();
        [&self.x, &self.y, &self.z]
            .into_iter()
            .all(|values| is_finite(level, values))
    }
}

impl FromIterator<Vec3> for Points {
    fn from_iter<I: IntoIterator<Item = Vec3>>(iter: I) -> Self {
        let mut points = Self::default();
        let iter = iter.into_iter();
        points.each(|values| values.reserve_exact(iter.size_hint().0));
        for p in iter {
            points.x.push(p.x);
            points.y.push(p.y);
            points.z.push(p.z);
        }
        points.each(Vec::shrink_to_fit);
        points
    }
}
