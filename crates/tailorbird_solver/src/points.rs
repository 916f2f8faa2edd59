//! Points as three parallel arrays.

use bevy_math::Vec3;

use crate::{memory::Memory, numbers::Numbers};

/// Points (or vectors) stored as three arrays of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// First coordinates.
    pub x: Numbers,
    /// Second coordinates.
    pub y: Numbers,
    /// Third coordinates.
    pub z: Numbers,
}

impl Points {
    /// `len` points at zero.
    pub fn zeroed(len: usize) -> Self {
        Self {
            x: Numbers::zeroed(len),
            y: Numbers::zeroed(len),
            z: Numbers::zeroed(len),
        }
    }

    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.x.memory_bytes() + self.y.memory_bytes() + self.z.memory_bytes()
    }

    /// The number of points.
    #[inline]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Returns whether there are `len` of each coordinate.
    pub fn is_of(&self, len: usize) -> bool {
        [&self.x, &self.y, &self.z]
            .into_iter()
            .all(|values| values.len() == len)
    }

    /// Returns whether there are at least `len` of each coordinate.
    pub fn has(&self, len: usize) -> bool {
        [&self.x, &self.y, &self.z]
            .into_iter()
            .all(|values| values.len() >= len)
    }

    /// Returns whether there are none.
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
        Vec3::new(self.x.at(i), self.y.at(i), self.z.at(i))
    }

    /// Overwrites the point with this index.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn set(&mut self, i: usize, value: Vec3) {
        *self.x.at_mut(i) = value.x;
        *self.y.at_mut(i) = value.y;
        *self.z.at_mut(i) = value.z;
    }

    /// Adds to the point with this index.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn add(&mut self, i: usize, value: Vec3) {
        *self.x.at_mut(i) += value.x;
        *self.y.at_mut(i) += value.y;
        *self.z.at_mut(i) += value.z;
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
        self.each(Numbers::clear);
    }

    /// Resizes to `len` points, with `value` as the coordinates of new ones.
    pub fn resize(&mut self, len: usize, value: f32) {
        self.each(|values| values.resize(len, value));
    }

    fn each(&mut self, f: impl FnMut(&mut Numbers)) {
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
}

impl Memory for Points {
    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl FromIterator<Vec3> for Points {
    fn from_iter<I: IntoIterator<Item = Vec3>>(iter: I) -> Self {
        let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
        for p in iter {
            x.push(p.x);
            y.push(p.y);
            z.push(p.z);
        }
        Self {
            x: x.into(),
            y: y.into(),
            z: z.into(),
        }
    }
}
