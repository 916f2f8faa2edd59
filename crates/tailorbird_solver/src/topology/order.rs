//! The order in which particles are stored.

use std::sync::Arc;

use crate::memory::heap;

/// Number of a particle by which users know it: its place in
/// [`ClothShape::rest_positions`](crate::shape::ClothShape::rest_positions).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Given(pub u32);

/// Number of a particle in storage order: its place in arrays of particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Stored(pub u32);

impl Given {
    /// The number as an index.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl Stored {
    /// The number as an index.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// The permutation of particles between their original order and the order in which they are stored.
///
/// Storage order puts particles side by side that are solved side by side. For grids the two are the same.
#[derive(Clone, Debug, Default)]
pub struct ParticleOrder(Option<Arc<Permutation>>);

#[derive(Debug)]
struct Permutation {
    given: Vec<Given>,
    stored: Vec<Stored>,
}

impl ParticleOrder {
    /// The order in which the particle stored as `i` has the given number `given[i]`, a permutation.
    pub(super) fn new(given: Vec<u32>) -> Self {
        if given.iter().enumerate().all(|(i, &g)| i == g as usize) {
            return Self::default();
        }
        let given: Vec<Given> = given.into_iter().map(Given).collect();
        let mut stored = vec![Stored(0); given.len()];
        for (i, g) in given.iter().enumerate() {
            stored[g.index()] = Stored(i as u32);
        }
        Self(Some(Arc::new(Permutation { given, stored })))
    }

    /// Memory on the heap, shared by all clones \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.0
            .as_ref()
            .map_or(0, |numbers| heap(&numbers.given) + heap(&numbers.stored))
    }

    /// The stored number of a particle; of one that does not exist, what was given.
    #[inline]
    pub fn stored(&self, given: Given) -> Stored {
        let same = Stored(given.0);
        self.0.as_ref().map_or(same, |numbers| {
            let number = numbers.stored.get(given.index());
            number.copied().unwrap_or(same)
        })
    }

    /// The given number of a particle; of one that does not exist, what it is stored as.
    #[inline]
    pub fn given(&self, stored: Stored) -> Given {
        let same = Given(stored.0);
        self.0.as_ref().map_or(same, |numbers| {
            let number = numbers.given.get(stored.index());
            number.copied().unwrap_or(same)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_and_given_are_inverse() {
        let order = ParticleOrder::new(vec![2, 0, 3, 1]);
        let given = [0, 1, 2, 3].map(|i| order.given(Stored(i)));
        assert_eq!(given, [2, 0, 3, 1].map(Given));
        let all = [0, 1, 2, 3, 9].map(Given);
        assert_eq!(all.map(|i| order.given(order.stored(i))), all);
        assert!(ParticleOrder::new(vec![0, 1, 2]).0.is_none());
    }
}
