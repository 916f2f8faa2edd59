//! Numbers side by side: the common part of the vector kernels.
//!
//! A kernel is written once, for a vector of [`Simd::f32s`] whose width the instruction set decides. Each lane is a chain, a constraint or
//! a particle of its own and takes the same IEEE operations in the same order whatever the width, so that every instruction set gives the
//! same bits.

#![expect(
    unsafe_code,
    reason = "several tasks write parts of one array that are no slices, such as columns"
)]

use std::{cell::RefCell, marker::PhantomData, ops::Range, ptr::NonNull};

use fearless_simd::{Simd, f32x4, prelude::*};

pub use super::vectors::{Factor, V3};
use crate::points::Points;

/// Width of the widest vector of all instruction sets.
pub const WIDEST: usize = 16;

/// Lanes of a vector as an array of numbers.
type Lanes<S> = <<S as Simd>::f32s as SimdBase<S>>::Array;

/// An array that several tasks read and write, each at its own elements.
///
/// Indices are checked in builds with debug assertions, such as those of the tests; the kernels check the size of the whole once
/// ([`super::lattice::Sheet::check`]). Checking each of the 14 accesses of a vector of springs took as long as the springs themselves.
#[derive(Clone, Copy)]
pub struct Shared<'a> {
    start: NonNull<f32>,
    len: usize,
    array: PhantomData<&'a mut [f32]>,
}

// SAFETY: in each phase of the solver a task touches elements of its own alone (its rows, or its columns, or what its
// constraints name, of which no two share one); a phase ends when all its parts are done (`crate::workers`).
unsafe impl Send for Shared<'_> {}
// SAFETY: as above.
unsafe impl Sync for Shared<'_> {}

impl<'a> Shared<'a> {
    #[inline(always)]
    pub fn new(array: &'a mut [f32]) -> Self {
        Self {
            len: array.len(),
            start: NonNull::from(array).cast(),
            array: PhantomData,
        }
    }

    #[inline(always)]
    pub fn len(self) -> usize {
        self.len
    }

    #[inline(always)]
    pub fn is_empty(self) -> bool {
        self.len == 0
    }

    #[inline(always)]
    pub fn load<S: Simd>(self, simd: S, i: usize) -> S::f32s {
        debug_assert!(i + S::f32s::LEN <= self.len, "lanes out of range");
        // SAFETY: in range, and no other task writes these elements now.
        let values = unsafe { self.start.add(i).cast::<Lanes<S>>().as_ref() };
        S::f32s::load_array_ref(simd, values)
    }

    #[inline(always)]
    pub fn store<S: Simd>(self, i: usize, value: S::f32s) {
        debug_assert!(i + S::f32s::LEN <= self.len, "lanes out of range");
        // SAFETY: in range, and no other task uses these elements now.
        let values = unsafe { self.start.add(i).cast::<Lanes<S>>().as_mut() };
        value.store_array(values);
    }

    #[inline(always)]
    pub fn load_four<S: Simd>(self, simd: S, i: usize) -> f32x4<S> {
        debug_assert!(i + 4 <= self.len, "lanes out of range");
        // SAFETY: in range, and no other task writes these elements now.
        let values = unsafe { self.start.add(i).cast::<[f32; 4]>().as_ref() };
        f32x4::load_array_ref(simd, values)
    }

    #[inline(always)]
    pub fn store_four<S: Simd>(self, i: usize, value: f32x4<S>) {
        debug_assert!(i + 4 <= self.len, "lanes out of range");
        // SAFETY: in range, and no other task uses these elements now.
        let values = unsafe { self.start.add(i).cast::<[f32; 4]>().as_mut() };
        value.store_array(values);
    }

    #[inline(always)]
    pub fn get(self, i: usize) -> f32 {
        debug_assert!(i < self.len, "index out of range");
        // SAFETY: in range, and no other task writes this element now.
        unsafe { self.start.add(i).read() }
    }

    #[inline(always)]
    pub fn set(self, i: usize, value: f32) {
        debug_assert!(i < self.len, "index out of range");
        // SAFETY: in range, and no other task uses this element now.
        unsafe { self.start.add(i).write(value) }
    }

    /// Loads the elements of a window, `offset` further on. Lanes beyond a short window are 0.
    #[inline(always)]
    pub fn load_at<S: Simd>(self, simd: S, window: Window, offset: usize) -> S::f32s {
        let i = window.at + offset;
        if window.short == 0 {
            return self.load(simd, i);
        }
        let mut lanes = [0.0; WIDEST];
        for (k, lane) in lanes[..window.short].iter_mut().enumerate() {
            *lane = self.get(i + k);
        }
        S::f32s::from_slice(simd, &lanes[..S::f32s::LEN])
    }

    /// Stores the lanes that belong to the window, `offset` further on.
    #[inline(always)]
    pub fn store_at<S: Simd>(self, simd: S, window: Window, offset: usize, value: S::f32s) {
        let i = window.at + offset;
        if window.short != 0 {
            for (k, lane) in value.as_slice()[..window.short].iter().enumerate() {
                self.set(i + k, *lane);
            }
        } else if window.done != 0 {
            let value = window.todo(simd).select(value, self.load(simd, i));
            self.store::<S>(i, value);
        } else {
            self.store::<S>(i, value);
        }
    }
}

/// An array that tasks read.
#[derive(Clone, Copy)]
pub struct Reading<'a>(pub &'a [f32]);

impl Reading<'_> {
    /// Loads the elements of a window. Lanes beyond a short window are 0.
    #[inline(always)]
    pub fn load_at<S: Simd>(self, simd: S, window: Window) -> S::f32s {
        if window.short == 0 {
            return S::f32s::from_slice(simd, &self.0[window.at..][..S::f32s::LEN]);
        }
        let mut lanes = [0.0; WIDEST];
        lanes[..window.short].copy_from_slice(&self.0[window.at..window.at + window.short]);
        S::f32s::from_slice(simd, &lanes[..S::f32s::LEN])
    }
}

/// Range of elements that a vector covers: as many as it has lanes, without gaps, in ranges of any length.
///
/// The last window of a range lies at its end and so overlaps the window before; elements of the overlap belong to the window before. Only
/// a range that is shorter than a vector has a short window, whose elements are loaded one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first element.
    pub at: usize,
    /// Number of the first lanes that belong to the window before.
    done: usize,
    /// Number of lanes of a short window; 0 for a full one.
    short: usize,
}

impl Window {
    /// The first `count` elements, less than a vector.
    #[inline(always)]
    pub fn short(count: usize) -> Self {
        Self {
            at: 0,
            done: 0,
            short: count,
        }
    }

    /// Window of one element.
    #[inline(always)]
    pub fn single(at: usize) -> Self {
        Self {
            at,
            done: 0,
            short: 1,
        }
    }

    /// The last window of a range, of whose elements `left` are still to be done: fewer than a vector has.
    #[inline(always)]
    fn last<S: Simd>(_simd: S, range: &Range<usize>, left: usize) -> Self {
        let lanes = S::f32s::LEN;
        if range.end - range.start >= lanes {
            Self {
                at: range.end - lanes,
                done: lanes - left,
                short: 0,
            }
        } else {
            Self {
                at: range.start,
                done: 0,
                short: left,
            }
        }
    }

    /// Mask of the lanes that belong to this window.
    #[inline(always)]
    pub fn todo<S: Simd>(self, simd: S) -> S::mask32s {
        lane_numbers(simd).simd_ge(S::f32s::splat(simd, self.done as f32))
    }
}

/// Size of a cache line \[byte\].
const CACHE_LINE: usize = 64;

thread_local! {
    static SCRATCH: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Calls `f` with scratch of `len` numbers, which is kept for the next call on this thread. The scratch starts at a cache line, because
/// loading a vector that lies in two lines takes twice as long.
pub fn with_scratch<R>(len: usize, f: impl FnOnce(&mut [f32]) -> R) -> R {
    SCRATCH.with(|scratch| {
        let mut own = Vec::new();
        let mut kept = scratch.try_borrow_mut();
        let scratch = kept.as_deref_mut().unwrap_or(&mut own);
        if scratch.len() < len + WIDEST {
            scratch.resize(len + WIDEST, 0.0);
        }
        let start = scratch.as_ptr().align_offset(CACHE_LINE).min(WIDEST);
        f(&mut scratch[start..start + len])
    })
}

/// Calls `f` for the windows of a range, the last window first. That window overlaps its neighbour, and its stores have reached the cache
/// when the neighbour loads the same elements.
#[inline(always)]
pub fn each_window<S: Simd>(simd: S, range: Range<usize>, mut f: impl FnMut(Window)) {
    let lanes = S::f32s::LEN;
    let left = (range.end - range.start) % lanes;
    if left != 0 {
        f(Window::last(simd, &range, left));
    }
    let mut at = range.start;
    while at + lanes <= range.end {
        f(Window {
            at,
            done: 0,
            short: 0,
        });
        at += lanes;
    }
}

/// 0, 1, 2 and so on.
#[inline(always)]
pub fn lane_numbers<S: Simd>(simd: S) -> S::f32s {
    S::f32s::from_slice(simd, &LANE_NUMBERS[..S::f32s::LEN])
}

const LANE_NUMBERS: [f32; WIDEST] = [
    0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
];

/// [`Points`] that several tasks read and write.
#[derive(Clone, Copy)]
pub struct SharedPoints<'a> {
    pub x: Shared<'a>,
    pub y: Shared<'a>,
    pub z: Shared<'a>,
}

impl<'a> SharedPoints<'a> {
    #[inline(always)]
    pub fn new(points: &'a mut Points) -> Self {
        Self {
            x: Shared::new(&mut points.x),
            y: Shared::new(&mut points.y),
            z: Shared::new(&mut points.z),
        }
    }

    /// Returns whether there are exactly `len` of each coordinate.
    #[inline(always)]
    pub fn is_of(self, len: usize) -> bool {
        [self.x, self.y, self.z].map(Shared::len) == [len; 3]
    }

    /// Returns whether there are at least `len` of each coordinate.
    #[inline(always)]
    pub fn has(self, len: usize) -> bool {
        [self.x, self.y, self.z].iter().all(|axis| axis.len >= len)
    }

    #[inline(always)]
    pub fn load<S: Simd>(self, simd: S, i: usize) -> V3<S> {
        V3 {
            x: self.x.load(simd, i),
            y: self.y.load(simd, i),
            z: self.z.load(simd, i),
        }
    }

    #[inline(always)]
    pub fn store<S: Simd>(self, i: usize, value: V3<S>) {
        self.x.store::<S>(i, value.x);
        self.y.store::<S>(i, value.y);
        self.z.store::<S>(i, value.z);
    }

    #[inline(always)]
    pub fn load_at<S: Simd>(self, simd: S, window: Window, offset: usize) -> V3<S> {
        V3 {
            x: self.x.load_at(simd, window, offset),
            y: self.y.load_at(simd, window, offset),
            z: self.z.load_at(simd, window, offset),
        }
    }

    #[inline(always)]
    pub fn store_at<S: Simd>(self, simd: S, window: Window, offset: usize, value: V3<S>) {
        self.x.store_at::<S>(simd, window, offset, value.x);
        self.y.store_at::<S>(simd, window, offset, value.y);
        self.z.store_at::<S>(simd, window, offset, value.z);
    }
}

impl Points {
    /// The points of a window, `offset` further on. Lanes beyond a short window are 0.
    #[inline(always)]
    pub fn window<S: Simd>(&self, simd: S, window: Window, offset: usize) -> V3<S> {
        V3 {
            x: Reading(&self.x[offset..]).load_at(simd, window),
            y: Reading(&self.y[offset..]).load_at(simd, window),
            z: Reading(&self.z[offset..]).load_at(simd, window),
        }
    }
}

/// Calls `f` for the lanes that a mask names.
#[inline(always)]
pub fn each_lane<S: Simd>(simd: S, mask: S::mask32s, mut f: impl FnMut(usize)) {
    if mask.any_true() {
        let [zero, one] = [0.0, 1.0].map(|value| S::f32s::splat(simd, value));
        let named = mask.select(one, zero);
        for (k, lane) in named.as_slice().iter().enumerate() {
            if *lane != 0.0 {
                f(k);
            }
        }
    }
}

#[cfg(test)]
pub use crate::instruction_set::levels;

#[cfg(test)]
#[path = "lanes_tests.rs"]
mod tests;
