//! Memory use.

use std::sync::OnceLock;

/// Heap memory of a list \[byte\].
pub fn heap<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}

/// Heap memory in use.
pub trait Memory {
    /// Heap memory in use \[byte\].
    fn memory_bytes(&self) -> usize;
}

impl<T> Memory for Vec<T> {
    fn memory_bytes(&self) -> usize {
        heap(self)
    }
}

impl<T: Memory, const N: usize> Memory for [T; N] {
    fn memory_bytes(&self) -> usize {
        self.iter().map(T::memory_bytes).sum()
    }
}

impl<T: Memory> Memory for OnceLock<T> {
    fn memory_bytes(&self) -> usize {
        self.get().map_or(0, T::memory_bytes)
    }
}

/// Gives a type the method `memory_bytes`: the sum of that of some fields.
#[macro_export]
#[doc(hidden)]
macro_rules! memory_bytes {
    ($Type:ty: $($($field:tt).+),+) => {
        impl $Type {
            /// Heap memory in use \[byte\].
            pub fn memory_bytes(&self) -> usize {
                use $crate::memory::Memory as _;
                0 $(+ self.$($field).+.memory_bytes())+
            }
        }

        impl $crate::memory::Memory for $Type {
            fn memory_bytes(&self) -> usize {
                self.memory_bytes()
            }
        }
    };
}
