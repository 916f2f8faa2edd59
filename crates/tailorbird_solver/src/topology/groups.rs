//! Lists of items, one for each key, in one array.

use super::order::Stored;
use crate::memory_bytes;

/// Items of each key.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups<T = u32> {
    /// Start of the items of each key; one more than there are keys.
    offsets: Vec<u32>,
    items: Vec<T>,
}

memory_bytes!(Groups<Stored>: offsets, items);

impl<T: Copy + Default> Groups<T> {
    /// Groups of items with their keys, which are below `count`. The items of a key keep their order. Linear time.
    pub fn new(count: usize, items: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut offsets = vec![0u32; count + 1];
        for (key, _) in items.clone() {
            offsets[key as usize + 1] += 1;
        }
        for key in 0..count {
            offsets[key + 1] += offsets[key];
        }
        let mut next = offsets.clone();
        let mut list = vec![T::default(); offsets[count] as usize];
        for (key, item) in items {
            let next = &mut next[key as usize];
            list[*next as usize] = item;
            *next += 1;
        }
        Self {
            offsets,
            items: list,
        }
    }

    /// Items of a key; none where it is out of range.
    pub fn of(&self, key: u32) -> &[T] {
        let key = key as usize;
        match (self.offsets.get(key), self.offsets.get(key + 1)) {
            (Some(&start), Some(&end)) => &self.items[start as usize..end as usize],
            _ => &[],
        }
    }
}
