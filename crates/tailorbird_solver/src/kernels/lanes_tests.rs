use fearless_simd::dispatch;

use super::*;

/// Adds 1 to what is `offset` behind a range, window by window.
#[inline(always)]
fn count<S: Simd>(simd: S, numbers: &mut [f32], range: Range<usize>, offset: usize) {
    let numbers = Shared::new(numbers);
    each_window(
        simd,
        range.clone(),
        #[inline(always)]
        |window| {
            assert!(range.contains(&window.at));
            let value: S::f32s = numbers.load_at(simd, window, offset);
            numbers.store_at(simd, window, offset, value + 1.0);
        },
    );
}

#[test]
fn windows_are_the_elements_of_a_range_each_once() {
    for level in levels() {
        for (start, len, offset) in (0..40).flat_map(|len| [(0, len, 0), (3, len, 0), (2, len, 5)])
        {
            let (range, mut numbers) = (start..start + len, vec![0.0; 60]);
            dispatch!(level, simd => count(simd, &mut numbers, range.clone(), offset));
            for (i, number) in numbers.into_iter().enumerate() {
                let wanted = i >= offset && range.contains(&(i - offset));
                assert_eq!(number, f32::from(wanted), "{i} of {range:?} + {offset}");
            }
        }
    }
}

#[test]
fn scratch_starts_where_a_cache_line_does() {
    for len in [1, 15, 16, 17, 1000, 100_000] {
        with_scratch(len, |outer| {
            assert_eq!(outer.len(), len);
            assert_eq!(outer.as_ptr().align_offset(CACHE_LINE), 0);
            // Within a call there is another one.
            with_scratch(len, |inner| {
                assert_eq!(inner.as_ptr().align_offset(CACHE_LINE), 0);
            });
        });
    }
}
