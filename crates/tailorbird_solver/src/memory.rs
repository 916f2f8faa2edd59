//! How much memory things take.

/// What a list takes on the heap \[byte\].
pub fn heap<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}
