//! Search for chains and rings that share no particle.

use bevy_math::Vec3;

use super::{NONE, Weave};

/// Cosine of the angle between two edges at a particle below which they continue one another.
const CONTINUES: f32 = 0.5;

/// Number of edges of a family at a particle above which none continues another.
const FAN: usize = 16;

/// Chains that share no particle. A ring ends at the particle where it starts.
#[derive(Debug, Default)]
pub(super) struct Cover {
    /// Start of each chain in `particles` and `edges`; one more than there are chains.
    starts: Vec<usize>,
    particles: Vec<u32>,
    /// Edge from each particle to the next of its chain, [`NONE`] at its end.
    edges: Vec<u32>,
}

impl Cover {
    /// Chains of one edge each, by their edges and ends; no two share a particle.
    pub(super) fn single(edges: impl Iterator<Item = (u32, [u32; 2])>) -> Self {
        let mut cover = Self {
            starts: vec![0],
            ..Self::default()
        };
        for (edge, ends) in edges {
            cover.particles.extend(ends);
            cover.edges.extend([edge, NONE]);
            cover.starts.push(cover.particles.len());
        }
        cover
    }

    pub(super) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub(super) fn particles(&self, chain: usize) -> &[u32] {
        &self.particles[self.starts[chain]..self.starts[chain + 1]]
    }

    pub(super) fn is_ring(&self, chain: usize) -> bool {
        let particles = self.particles(chain);
        particles.len() > 2 && particles.first() == particles.last()
    }

    /// Particles of a chain, with the edge from each to the next.
    pub(super) fn links(
        &self,
        chain: usize,
        reversed: bool,
    ) -> impl Iterator<Item = (u32, u32)> + '_ {
        let range = self.starts[chain]..self.starts[chain + 1];
        let (start, end) = (range.start, range.end);
        range.map(move |i| {
            if reversed {
                let mirror = start + end - 1 - i;
                let edge = if mirror == start {
                    NONE
                } else {
                    self.edges[mirror - 1]
                };
                (self.particles[mirror], edge)
            } else {
                (self.particles[i], self.edges[i])
            }
        })
    }

    /// Sum of the squares of the chains' lengths in edges.
    pub(super) fn weight(&self) -> u64 {
        (0..self.len())
            .map(|chain| (self.particles(chain).len() as u64 - 1).pow(2))
            .sum()
    }

    /// Adds the parts of a path that touch no particle in `used` (marked with `pass`), and returns the edges left over.
    fn push(&mut self, path: &Walk, used: &mut [u32], pass: u32, left: &mut Vec<u32>) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        for (i, &particle) in path.particles.iter().enumerate() {
            let start = self.starts[self.starts.len() - 1];
            let free = used[particle as usize] != pass;
            if free {
                used[particle as usize] = pass;
                self.particles.push(particle);
                self.edges.push(NONE);
            }
            if i > 0 {
                let edge = path.edges[i - 1];
                if free && self.particles.len() > start + 1 {
                    let last = self.edges.len() - 2;
                    self.edges[last] = edge;
                } else {
                    left.push(edge);
                }
            }
            if !free || i + 1 == path.particles.len() {
                self.end(start, used);
            }
        }
    }

    /// Adds a path that is a ring and touches no particle in `used`. Returns whether it did.
    fn push_ring(&mut self, path: &Walk, used: &mut [u32], pass: u32) -> bool {
        let Some((last, particles)) = path.particles.split_last() else {
            return false;
        };
        if particles.len() < 3 || particles.first() != Some(last) {
            return false;
        }
        let marks: Vec<u32> = particles.iter().map(|i| used[*i as usize]).collect();
        let mut free = 0;
        for &i in particles {
            if std::mem::replace(&mut used[i as usize], pass) == pass {
                break;
            }
            free += 1;
        }
        if free < particles.len() {
            for (&i, mark) in particles.iter().zip(marks).take(free) {
                used[i as usize] = mark;
            }
            return false;
        }
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.particles.extend(&path.particles);
        self.edges.extend(&path.edges);
        self.edges.push(NONE);
        self.starts.push(self.particles.len());
        true
    }

    /// Ends the chain that began at `start`; a single particle is no chain.
    fn end(&mut self, start: usize, used: &mut [u32]) {
        match self.particles.len() - start {
            0 => {}
            1 => {
                if let Some(particle) = self.particles.pop() {
                    used[particle as usize] = 0;
                }
                self.edges.pop();
            }
            _ => self.starts.push(self.particles.len()),
        }
    }
}

/// A walk along edges that continue one another; may cross itself.
#[derive(Debug, Default)]
struct Walk {
    particles: Vec<u32>,
    edges: Vec<u32>,
}

/// Takes chains from `edges` and leaves there the edges that share a particle with them. Longest first; at each particle the edges that lie
/// most nearly opposite continue one another.
///
/// `used` has a mark for each particle; `pass` is a mark that none has yet, not 0.
pub(super) fn cover(
    edges: &mut Vec<u32>,
    rest_positions: &[Vec3],
    weave: &Weave,
    used: &mut [u32],
    pass: u32,
) -> Cover {
    let mut paths = paths(edges, rest_positions, weave);
    paths.sort_by_key(|path| std::cmp::Reverse(path.edges.len()));
    let mut cover = Cover::default();
    edges.clear();
    for path in &paths {
        if !cover.push_ring(path, used, pass) {
            cover.push(path, used, pass, edges);
        }
    }
    edges.sort_unstable();
    cover
}

fn paths(edges: &[u32], rest_positions: &[Vec3], weave: &Weave) -> Vec<Walk> {
    let ends = |local: u32| weave.ends[edges[local as usize / 2] as usize];
    let at = |half: u32| ends(half)[half as usize % 2];
    let next = continuations(edges, rest_positions, weave);
    let mut seen = vec![false; edges.len()];
    let mut paths = Vec::new();
    // Half 2 e + 0 or 1 is the lower or upper end of an edge. Open paths start at halves that nothing continues.
    let open = (0..next.len() as u32).filter(|half| next[*half as usize] == NONE);
    for start in open.chain(0..next.len() as u32) {
        if seen[start as usize / 2] {
            continue;
        }
        let mut path = Walk {
            particles: vec![at(start)],
            edges: Vec::new(),
        };
        let mut half = start;
        while half != NONE && !std::mem::replace(&mut seen[half as usize / 2], true) {
            path.edges.push(edges[half as usize / 2]);
            path.particles.push(at(half ^ 1));
            half = next[(half ^ 1) as usize];
        }
        if half == start {
            turn(&mut path, rest_positions);
        }
        paths.push(path);
    }
    paths
}

/// For each half (end of an edge) the half at the same particle that continues it, or [`NONE`].
fn continuations(edges: &[u32], rest_positions: &[Vec3], weave: &Weave) -> Vec<u32> {
    let mut halves: Vec<(u32, u32)> = edges
        .iter()
        .enumerate()
        .flat_map(|(e, edge)| {
            let [a, b] = weave.ends[*edge as usize];
            [(a, 2 * e as u32), (b, 2 * e as u32 + 1)]
        })
        .collect();
    halves.sort_unstable();
    let direction = |half: u32| {
        let [a, b] =
            weave.ends[edges[half as usize / 2] as usize].map(|i| rest_positions[i as usize]);
        let along = (b - a).normalize_or_zero();
        if half.is_multiple_of(2) {
            along
        } else {
            -along
        }
    };
    let mut next = vec![NONE; edges.len() * 2];
    let mut pairs = Vec::new();
    for fan in halves.chunk_by(|a, b| a.0 == b.0) {
        if fan.len() > FAN {
            continue;
        }
        pairs.clear();
        for (i, &(_, a)) in fan.iter().enumerate() {
            for &(_, b) in &fan[i + 1..] {
                let cosine = direction(a).dot(direction(b));
                if cosine < CONTINUES {
                    pairs.push((cosine, a, b));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, a, b) in &pairs {
            if next[a as usize] == NONE && next[b as usize] == NONE {
                next[a as usize] = b;
                next[b as usize] = a;
            }
        }
    }
    next
}

/// Rotates a closed path so that it starts at the particle that lies furthest in a direction along no axis: rings side by side then start
/// side by side. Its last edge comes from the neighbour with the lower index.
fn turn(path: &mut Walk, rest_positions: &[Vec3]) {
    let height = |path: &Walk, i: &usize| {
        let p = rest_positions[path.particles[*i] as usize];
        p.dot(Vec3::new(0.48, 0.71, 0.52))
    };
    let furthest = (0..path.edges.len()).max_by(|a, b| height(path, a).total_cmp(&height(path, b)));
    if let Some(start) = furthest {
        path.particles.pop();
        path.particles.rotate_left(start);
        path.edges.rotate_left(start);
        let last = path.particles.len() - 1;
        if height(path, &last) > height(path, &1) {
            path.particles[1..].reverse();
            path.edges.reverse();
        }
        path.particles.extend(path.particles.first().copied());
    }
}
