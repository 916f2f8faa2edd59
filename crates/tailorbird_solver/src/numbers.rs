//! Numbers aligned to cache lines.

use std::{
    ops::{Deref, DerefMut},
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

/// Count of numbers in a cache line.
const LINE: usize = 16;

/// Length from which on an array starts further on than at the next cache line.
const LONG: usize = 4096;

/// Offset between the starts of successive long arrays, in cache lines, and the count of different starts. The kernels go through up to ten
/// arrays at once, which would all be in the same lines of a page if each started with one.
const APART: usize = 5;
const PLACES: usize = 16;

/// Numbers aligned to cache lines: loading a vector that lies in two lines takes twice as long. Otherwise like a [`Vec`].
#[derive(Debug, Default)]
pub struct Numbers {
    /// Unused numbers up to `start`, then the numbers.
    list: Vec<f32>,
    start: usize,
}

crate::memory_bytes!(Numbers: list);

impl Numbers {
    /// `len` zeros.
    pub fn zeroed(len: usize) -> Self {
        let mut numbers = Self::with_capacity(len);
        numbers.list.resize(numbers.start + len, 0.0);
        numbers
    }

    /// Space for `len` numbers.
    fn with_capacity(len: usize) -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        if len == 0 {
            return Self::default();
        }
        let further = if len < LONG {
            0
        } else {
            APART * NEXT.fetch_add(1, Relaxed) % PLACES * LINE
        };
        let mut list: Vec<f32> = Vec::with_capacity(len + LINE + further);
        let start = list
            .as_ptr()
            .align_offset(size_of::<f32>() * LINE)
            .min(LINE)
            + further;
        list.resize(start, 0.0);
        Self { list, start }
    }

    /// Removes all numbers and keeps the memory.
    pub fn clear(&mut self) {
        self.list.truncate(self.start);
    }

    /// Resizes to `len` numbers, with `value` for new ones.
    pub fn resize(&mut self, len: usize, value: f32) {
        if self.start + len > self.list.capacity() {
            let mut longer = Self::with_capacity(len);
            longer.list.extend_from_slice(self);
            *self = longer;
        }
        self.list.resize(self.start + len, value);
    }

    /// The number with this index: faster than by a slice.
    #[inline]
    pub fn at(&self, i: usize) -> f32 {
        self.list[self.start + i]
    }

    /// The number with this index, to change.
    #[inline]
    pub fn at_mut(&mut self, i: usize) -> &mut f32 {
        &mut self.list[self.start + i]
    }
}

impl Deref for Numbers {
    type Target = [f32];

    #[inline]
    fn deref(&self) -> &[f32] {
        &self.list[self.start..]
    }
}

impl DerefMut for Numbers {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.list[self.start..]
    }
}

impl Clone for Numbers {
    fn clone(&self) -> Self {
        self.iter().copied().collect()
    }

    fn clone_from(&mut self, other: &Self) {
        if self.len() == other.len() {
            self.copy_from_slice(other);
        } else {
            *self = other.clone();
        }
    }
}

impl PartialEq for Numbers {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl From<Vec<f32>> for Numbers {
    fn from(list: Vec<f32>) -> Self {
        let mut numbers = Self::with_capacity(list.len());
        numbers.list.extend_from_slice(&list);
        numbers
    }
}

impl FromIterator<f32> for Numbers {
    fn from_iter<I: IntoIterator<Item = f32>>(iter: I) -> Self {
        iter.into_iter().collect::<Vec<f32>>().into()
    }
}

impl<'a> IntoIterator for &'a Numbers {
    type Item = &'a f32;
    type IntoIter = std::slice::Iter<'a, f32>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Numbers {
    type Item = &'a mut f32;
    type IntoIter = std::slice::IterMut<'a, f32>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

/// Number from −1 to 1 that looks random, always the same for the same key.
pub fn unit_of(key: u32) -> f32 {
    let mut z = key.wrapping_add(0x9e37_79b9);
    z = (z ^ (z >> 16)).wrapping_mul(0x21f0_aaad);
    z = (z ^ (z >> 15)).wrapping_mul(0x735a_2d97);
    z ^= z >> 15;
    (z >> 8) as f32 / (1u32 << 23) as f32 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_as_a_vec_and_start_at_a_cache_line() {
        for len in [0, 1, 15, 16, 1000, 5000] {
            let mut list: Vec<f32> = (0..len).map(|i| i as f32).collect();
            let mut numbers = Numbers::from(list.clone());
            let mut other = Numbers::zeroed(3);
            for end in [len, len / 2, 2 * len, 0, 20] {
                numbers.resize(end, 7.0);
                list.resize(end, 7.0);
                assert_eq!(*numbers, list[..]);
                assert!(end == 0 || numbers.as_ptr().align_offset(64) == 0);
                other.clone_from(&numbers);
                assert_eq!(other, numbers);
                assert_eq!(numbers.clone(), numbers);
            }
            numbers.clear();
            assert!(numbers.is_empty());
        }
    }
}
