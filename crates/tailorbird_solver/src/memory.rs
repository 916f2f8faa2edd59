//! Memory use.

/// Heap memory of a list \[byte\].
pub fn heap<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}
