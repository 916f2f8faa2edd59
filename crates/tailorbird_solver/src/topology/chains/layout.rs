//! Batches of chains that are solved side by side, and the numbering of particles.

use bevy_math::Vec3;

use super::{LANES, NONE, Weave, cover::Cover};

/// Least ratio of the lengths of two chains of a batch.
const SIMILAR: f32 = 0.85;

/// Up to [`LANES`] chains, each with a flag: it runs from its end to its start.
#[derive(Debug, Default)]
pub(super) struct LaneChains {
    pub(super) lanes: Vec<(usize, bool)>,
    /// Particles along the longest chain.
    pub(super) length: usize,
}

/// Batches of chains that lie side by side on the mesh and run in the same direction.
pub(super) fn side_by_side(
    cover: &Cover,
    rest_positions: &[Vec3],
    weave: &Weave,
) -> Vec<LaneChains> {
    let chord = |chain: usize| {
        let particles = cover.particles(chain);
        let [first, last] = [0, particles.len() - 1].map(|i| rest_positions[particles[i] as usize]);
        last - first
    };
    let mut reversed = vec![false; cover.len()];
    let walk = walk(cover, rest_positions.len(), weave);
    let chains = walk.into_iter().map(|(chain, before)| {
        if let Some(before) = before {
            reversed[chain] = reversed[before] != (chord(chain).dot(chord(before)) < 0.0);
        }
        (chain, reversed[chain])
    });
    pack(cover, chains)
}

/// Batches of chains in the order of their particles' storage numbers.
pub(super) fn by_number(cover: &Cover, number: &[u32]) -> Vec<LaneChains> {
    let mut chains: Vec<(u32, usize, bool)> = (0..cover.len())
        .map(|chain| {
            let particles = cover.particles(chain);
            let [first, last] = [0, particles.len() - 1].map(|i| number[particles[i] as usize]);
            (first.min(last), chain, first > last)
        })
        .collect();
    chains.sort_unstable();
    pack(
        cover,
        chains
            .into_iter()
            .map(|(_, chain, reversed)| (chain, reversed)),
    )
}

/// Fills batches with chains of similar length, or rings, in the order of the iterator as far as that allows.
fn pack(cover: &Cover, chains: impl Iterator<Item = (usize, bool)>) -> Vec<LaneChains> {
    let mut batches: Vec<LaneChains> = Vec::new();
    // The batches that still have room, with the length of their first chain, and whether it is a ring.
    let mut open: Vec<(usize, f32, bool)> = Vec::new();
    for (chain, reversed) in chains {
        let length = cover.particles(chain).len();
        let fits = |like: f32| SIMILAR * like <= length as f32 && SIMILAR * length as f32 <= like;
        let place = open
            .iter()
            .position(|(_, like, ring)| fits(*like) && *ring == cover.is_ring(chain))
            .unwrap_or_else(|| {
                open.push((batches.len(), length as f32, cover.is_ring(chain)));
                batches.push(LaneChains::default());
                open.len() - 1
            });
        let batch = &mut batches[open[place].0];
        batch.lanes.push((chain, reversed));
        batch.length = batch.length.max(length);
        if batch.lanes.len() == LANES {
            open.remove(place);
        }
    }

    let mut rest: Vec<(usize, bool)> = open
        .iter()
        .flat_map(|(batch, ..)| std::mem::take(&mut batches[*batch].lanes))
        .collect();
    rest.sort_by_key(|(chain, _)| std::cmp::Reverse(cover.particles(*chain).len()));
    batches.retain(|batch| !batch.lanes.is_empty());
    batches.extend(rest.chunks(LANES).map(|lanes| {
        LaneChains {
            lanes: lanes.to_vec(),
            length: lanes
                .iter()
                .map(|l| cover.particles(l.0).len())
                .max()
                .unwrap_or(0),
        }
    }));
    batches
}

/// Original index of each particle in storage order: first the particles of the batches, then the others, each near its neighbours.
pub(super) fn order(
    cover: &Cover,
    batches: &[LaneChains],
    particles: usize,
    weave: &Weave,
) -> Vec<u32> {
    let mut order = Vec::with_capacity(particles);
    let mut number = vec![NONE; particles];
    for batch in batches {
        for k in 0..batch.length {
            for &(chain, reversed) in &batch.lanes {
                let chain = cover.particles(chain);
                if k < chain.len() {
                    let particle = chain[if reversed { chain.len() - 1 - k } else { k }];
                    // The last particle of a ring is its first.
                    if number[particle as usize] == NONE {
                        number[particle as usize] = order.len() as u32;
                        order.push(particle);
                    }
                }
            }
        }
    }
    let mut beside = number.clone();
    for &[a, b] in &weave.ends {
        for (from, to) in [(a, b), (b, a)] {
            let near = &mut beside[to as usize];
            *near = number[from as usize].min(*near);
        }
    }
    let mut others: Vec<u32> = (0..particles as u32)
        .filter(|i| number[*i as usize] == NONE)
        .collect();
    others.sort_by_key(|i| beside[*i as usize]);
    order.extend(others);
    order
}

/// All chains in an order in which neighbours follow each other where possible; with each, a chain beside it that comes earlier.
fn walk(cover: &Cover, particles: usize, weave: &Weave) -> Vec<(usize, Option<usize>)> {
    let beside = Adjacency::new(cover, particles, weave);
    let mut seen = vec![false; cover.len()];
    let mut walk: Vec<(usize, Option<usize>)> = Vec::with_capacity(cover.len());
    let mut marks = vec![0; cover.len()];
    for chain in 0..cover.len() {
        if seen[chain] {
            continue;
        }
        let far = beside.furthest(chain, &mut marks, 2 * chain + 1);
        let start = beside.furthest(far, &mut marks, 2 * chain + 2);
        let mut oldest = walk.len();
        let mut next = Some((start, None));
        while let Some((chain, before)) = next {
            seen[chain] = true;
            walk.push((chain, before));
            let best = |from: usize| beside.best(from, &seen).map(|to| (to, Some(from)));
            next = best(chain);
            while next.is_none() && oldest < walk.len() {
                next = best(walk[oldest].0);
                if next.is_none() {
                    oldest += 1;
                }
            }
        }
    }
    walk
}

/// Adjacency of chains, with the number of edges between two.
struct Adjacency {
    starts: Vec<usize>,
    chains: Vec<(u32, u32)>,
}

impl Adjacency {
    fn new(cover: &Cover, particles: usize, weave: &Weave) -> Self {
        let mut chain_of = vec![NONE; particles];
        for chain in 0..cover.len() {
            for &particle in cover.particles(chain) {
                chain_of[particle as usize] = chain as u32;
            }
        }
        let mut pairs: Vec<[u32; 2]> = weave
            .ends
            .iter()
            .map(|ends| ends.map(|i| chain_of[i as usize]))
            .filter(|[a, b]| a != b && *a != NONE && *b != NONE)
            .flat_map(|[a, b]| [[a, b], [b, a]])
            .collect();
        pairs.sort_unstable();
        let mut beside = Self {
            starts: Vec::with_capacity(cover.len() + 1),
            chains: Vec::new(),
        };
        let mut groups = pairs.chunk_by(|a, b| a == b).peekable();
        for chain in 0..cover.len() as u32 {
            beside.starts.push(beside.chains.len());
            while let Some(group) = groups.next_if(|group| group[0][0] == chain) {
                beside.chains.push((group[0][1], group.len() as u32));
            }
        }
        beside.starts.push(beside.chains.len());
        beside
    }

    fn of(&self, chain: usize) -> &[(u32, u32)] {
        &self.chains[self.starts[chain]..self.starts[chain + 1]]
    }

    /// Chain beside this one with the most edges between them that is not `seen` yet.
    fn best(&self, chain: usize, seen: &[bool]) -> Option<usize> {
        let fresh = self.of(chain).iter().filter(|c| !seen[c.0 as usize]);
        fresh
            .max_by_key(|(chain, edges)| (*edges, std::cmp::Reverse(*chain)))
            .map(|(chain, _)| *chain as usize)
    }

    /// Chain most steps away. `mark` is one that no chain has yet.
    fn furthest(&self, chain: usize, marks: &mut [usize], mark: usize) -> usize {
        let mut queue = vec![chain];
        marks[chain] = mark;
        let mut next = 0;
        while let Some(&chain) = queue.get(next) {
            next += 1;
            for &(other, _) in self.of(chain) {
                if std::mem::replace(&mut marks[other as usize], mark) != mark {
                    queue.push(other as usize);
                }
            }
        }
        queue.last().copied().unwrap_or(chain)
    }
}
