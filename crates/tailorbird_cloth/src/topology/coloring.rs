//! Sorts pairs into batches that share no particle.

/// Gives each pair the lowest colour that neither of its particles has yet, and returns the pairs by colour.
///
/// Needs at most twice the largest number of pairs at a particle. Deterministic; keeps the order within a colour.
pub fn color(pairs: &[[u32; 2]], particles: usize) -> Vec<Vec<[u32; 2]>> {
    let mut degree = vec![0usize; particles];
    for &[a, b] in pairs {
        degree[a as usize] += 1;
        degree[b as usize] += 1;
    }
    // Enough words of bits at each particle for every colour that can come to meet it.
    let words = degree.iter().max().map_or(0, |most| most * 2 / 64 + 1);
    let mut used = vec![0u64; particles * words];
    let mut batches: Vec<Vec<[u32; 2]>> = Vec::new();
    for &[a, b] in pairs {
        let (a_bits, b_bits) = (a as usize * words, b as usize * words);
        let Some((word, free)) = (0..words)
            .map(|w| (w, !(used[a_bits + w] | used[b_bits + w])))
            .find(|(_, free)| *free != 0)
        else {
            continue;
        };
        let bit = free.trailing_zeros() as usize;
        used[a_bits + word] |= 1 << bit;
        used[b_bits + word] |= 1 << bit;
        let color = word * 64 + bit;
        if color >= batches.len() {
            batches.resize_with(color + 1, Vec::new);
        }
        batches[color].push([a, b]);
    }
    batches
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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
                for particle in batch.into_iter().flatten() {
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
