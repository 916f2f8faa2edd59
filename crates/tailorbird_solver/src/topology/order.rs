//! The order in which particles are stored.

use std::sync::Arc;

use crate::memory::heap;

/// The permutation of particles between their original order and the order in which they are stored.
///
/// Users know a particle by its *given* number: its place in [`ClothShape::rest_positions`](crate::shape::ClothShape::rest_positions).
/// Everything inside works with *stored* numbers, which put particles side by side that are solved side by side. For grids the
/// two are the same.
#[derive(Clone, Debug, Default)]
pub struct ParticleOrder(Option<Arc<Numbers>>);

#[derive(Debug)]
struct Numbers {
    given: Vec<u32>,
    stored: Vec<u32>,
}

impl ParticleOrder {
    /// The order in which the particle stored as `i` has the given number `given[i]`, a permutation.
    pub(super) fn new(given: Vec<u32>) -> Self {
        if given.iter().enumerate().all(|(i, &g)| i == g as usize) {
            return Self::default();
        }
        let mut stored = vec![0; given.len()];
        for (i, &g) in given.iter().enumerate() {
            stored[g as usize] = i as u32;
        }
        Self(Some(Arc::new(Numbers { given, stored })))
    }

    /// Memory on the heap, shared by all clones \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.0
            .as_ref()
            .map_or(0, |numbers| heap(&numbers.given) + heap(&numbers.stored))
    }

    /// The stored number of a particle; of one that does not exist, what was given.
    #[inline]
    pub fn stored(&self, given: u32) -> u32 {
        self.0.as_ref().map_or(given, |numbers| {
            let number = numbers.stored.get(given as usize);
            number.copied().unwrap_or(given)
        })
    }

    /// The given number of a particle; of one that does not exist, what it is stored as.
    #[inline]
    pub fn given(&self, stored: u32) -> u32 {
        self.0.as_ref().map_or(stored, |numbers| {
            let number = numbers.given.get(stored as usize);
            number.copied().unwrap_or(stored)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_and_given_are_inverse() {
        let order = ParticleOrder::new(vec![2, 0, 3, 1]);
        assert_eq!([0, 1, 2, 3].map(|i| order.given(i)), [2, 0, 3, 1]);
        assert_eq!(
            [0, 1, 2, 3, 9].map(|i| order.given(order.stored(i))),
            [0, 1, 2, 3, 9]
        );
        assert!(ParticleOrder::new(vec![0, 1, 2]).0.is_none());
    }
}
