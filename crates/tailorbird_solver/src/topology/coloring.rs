//! Sorts pairs (or threes, or fours) of particles into batches that share no particle.

/// Number of tuples in a block of [`color_in_blocks`]: their particles fit the first level of cache.
const BLOCK: usize = 1536;

/// Gives each tuple the lowest colour that none of its particles has yet, and returns the indices of the tuples by colour.
///
/// Needs at most N times the largest number of tuples at a particle. Deterministic; keeps the order within a colour.
pub fn color<const N: usize>(tuples: &[[u32; N]], particles: usize) -> Vec<Vec<u32>> {
    let all: Vec<u32> = (0..tuples.len() as u32).collect();
    color_some(tuples, &all, particles)
}

/// Colours as [`color`], one block of tuples after the other, so that tuples of a batch also lie close together in memory. A batch has
/// tuples of one block alone, by their lowest particle.
pub fn color_in_blocks<const N: usize>(tuples: &[[u32; N]], particles: usize) -> Vec<Vec<u32>> {
    let mut sorted: Vec<u32> = (0..tuples.len() as u32).collect();
    sorted.sort_unstable_by_key(|&number| {
        let tuple = tuples[number as usize];
        (tuple.iter().min().copied(), tuple)
    });
    let blocks = sorted.chunks(BLOCK);
    blocks
        .flat_map(|block| color_some(tuples, block, particles))
        .collect()
}

fn color_some<const N: usize>(
    tuples: &[[u32; N]],
    numbers: &[u32],
    particles: usize,
) -> Vec<Vec<u32>> {
    let some = || {
        numbers
            .iter()
            .map(|&number| (number, tuples[number as usize]))
    };
    let mut degree = vec![0usize; particles];
    for particle in some().flat_map(|(_, tuple)| tuple) {
        degree[particle as usize] += 1;
    }
    // As many words of bits at each particle as its colours can need.
    let words = degree.iter().max().map_or(0, |most| most * N / 64 + 1);
    let mut used = vec![0u64; particles * words];
    let mut batches: Vec<Vec<u32>> = Vec::new();
    for (number, tuple) in some() {
        let bits = tuple.map(|particle| particle as usize * words);
        let Some((word, free)) = (0..words)
            .map(|w| (w, !bits.iter().fold(0, |taken, at| taken | used[at + w])))
            .find(|(_, free)| *free != 0)
        else {
            continue;
        };
        let bit = free.trailing_zeros() as usize;
        for at in bits {
            used[at + word] |= 1 << bit;
        }
        let color = word * 64 + bit;
        if color >= batches.len() {
            batches.resize_with(color + 1, Vec::new);
        }
        batches[color].push(number);
    }
    batches
}

#[cfg(test)]
mod tests {
    use crate::properties::*;

    use super::*;

    proptest! {
        #[test]
        fn no_two_pairs_of_a_batch_share_a_particle(
            pairs in prop::collection::vec((0u32..40, 0u32..40), 0..400)
        ) {
            let pairs: Vec<[u32; 2]> = pairs.into_iter().filter(|(a, b)| a != b).map(|(a, b)| [a, b]).collect();
            let batches = color(&pairs, 40);
            let total: usize = batches.iter().map(Vec::len).sum();
            prop_assert_eq!(total, pairs.len());
            for batch in batches {
                let mut seen = std::collections::HashSet::new();
                for particle in batch.into_iter().flat_map(|k| pairs[k as usize]) {
                    prop_assert!(seen.insert(particle));
                }
            }
        }
    }

    #[test]
    fn a_fan_of_many_spokes_needs_a_color_for_each() {
        let spokes: Vec<[u32; 2]> = (1..=500).map(|i| [0, i]).collect();
        assert_eq!(color(&spokes, 501).len(), 500);
    }
}
