//! How much longer than at rest the threads of a strained cloth may be.
//!
//! Where holds or colliders ask for more than a fabric has, its lines contradict each other: each takes what it can from those that cross
//! it, and single edges take what is left. So the fabric is granted what is asked for: a strain along the warp and one along the weft for
//! each particle, spread over its surroundings, that grows towards the mean strain around there. Then the lines agree again, and the demand
//! is shared evenly. What was granted is taken back at a rate, whether or not the demand still stands; so what was stretched comes back without
//! becoming speed.

mod trial;

use trial::Trial;

use crate::{
    effort::Effort,
    kernels::{lanes::Shared, lattice::Lengths},
    memory::heap,
    points::Points,
    topology::{
        chains::Chains,
        fabric::{Fabric, Springs},
        lattice::Lattice,
    },
};

/// The rate at which what is granted grows towards what is asked for [1/s].
const GROWTH: f32 = 40.0;

/// The rates at which it is taken back: of all [1/s], of it [1/s], of its square [1/s].
const TAKEN_BACK: [f32; 3] = [0.05, 1.5, 6.0];

/// How many times as fast what no edge needs is taken back [-].
const UNUSED: f32 = 4.0;

/// How fast what is shorter than it may be is made longer [1/s].
const PUSH: f32 = 0.5;

/// What a strained fabric bears without being granted anything [-].
const BORNE: f32 = 0.01;

/// How many times what is asked for is averaged with that of neighbours.
const ROUNDS: usize = 4;

/// What is granted at most [-].
const MOST: f32 = 1.0;

/// More than this in the mean is much [-].
const MUCH: f32 = 5e-3;

/// Less than this is nothing [-].
const LEAST: f32 = 1e-3;

/// What holds a cloth together.
#[derive(Clone, Copy)]
pub enum Threads<'a> {
    /// Rows and columns.
    Sheet(Lattice),
    /// Chains and springs.
    Mesh(&'a Fabric),
}

/// What is granted to a cloth; empty where nothing is.
#[derive(Clone, Debug, Default)]
pub struct Grant {
    /// For each particle the strain along warp and weft [-].
    strain: Vec<[f32; 2]>,
    /// The largest of those, and their mean [-].
    largest: f32,
    mean: f32,
    /// For each slot of the chains how long its edge may be; of a sheet for each particle the edge to the next of its row \[m\].
    chains: Vec<f32>,
    /// The same for each spring across the threads; for each particle the diagonals of the cell beyond it.
    springs: Vec<f32>,
    /// For each particle of a sheet the same for the edge to the next of its column.
    columns: Vec<f32>,
    /// Whether a demand stands, or a load pulls.
    trial: Trial,
    /// What the strain of the edges of particles says of warp and weft; scratch.
    around: [Vec<Neighborhood>; 2],
    /// The strain that is asked for around each particle, and not more than there is [-]; scratch.
    asked: Vec<[f32; 2]>,
}

/// Normal equations for the strains (u, v) along warp and weft of edges whose strain is c u + (1 − c) v, c being the square of the cosine of their
/// angle to the warp.
#[derive(Clone, Copy, Debug, Default)]
struct Neighborhood {
    /// Σ c², Σ c (1 − c), Σ (1 − c)².
    matrix: [f32; 3],
    /// Σ c ε, Σ (1 − c) ε.
    side: [f32; 2],
    /// How many.
    count: f32,
}

impl Neighborhood {
    fn add(&mut self, c: f32, strain: f32) {
        let s = 1.0 - c;
        self.matrix[0] += c * c;
        self.matrix[1] += c * s;
        self.matrix[2] += s * s;
        self.side[0] += c * strain;
        self.side[1] += s * strain;
        self.count += 1.0;
    }

    fn add_part(&mut self, other: &Self, part: f32) {
        let values = (self.matrix.iter_mut().chain(&mut self.side))
            .zip(other.matrix.iter().chain(&other.side));
        for (value, other) in values {
            *value += part * other;
        }
        self.count += part * other.count;
    }

    /// The strains (u, v), drawn a little towards 0; 0 where nothing is known.
    fn strain(&self) -> [f32; 2] {
        if self.count == 0.0 {
            return [0.0; 2];
        }
        let least = 1e-3 * self.count;
        let [a, b, d] = self.matrix;
        let (a, d) = (a + least, d + least);
        let det = a * d - b * b;
        let [p, q] = self.side;
        [(p * d - q * b) / det, (q * a - p * b) / det]
    }
}

impl Grant {
    /// Nothing is granted.
    pub fn is_empty(&self) -> bool {
        self.strain.is_empty()
    }

    /// Whether much is granted, and not in some place alone.
    pub fn is_much(&self) -> bool {
        self.mean > MUCH
    }

    /// The largest strain that is granted [-].
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// The strain that is granted, as a number for all of the cloth [-]: it if that is the same everywhere, and less where it is so in some
    /// place alone.
    pub fn overall(&self) -> f32 {
        (self.mean * self.largest).sqrt()
    }

    /// How long the edges of the chains may be \[m\].
    pub fn chains<'a>(&'a self, chains: &'a Chains) -> &'a [f32] {
        if self.chains.len() == chains.rest_length.len() {
            &self.chains
        } else {
            &chains.rest_length
        }
    }

    /// How long the springs across the threads may be \[m\].
    pub fn springs<'a>(&'a self, springs: &'a Springs) -> &'a [f32] {
        if self.springs.len() == springs.rest_length.len() {
            &self.springs
        } else {
            &springs.rest_length
        }
    }

    /// How long the edges of a sheet may be; none where they are as at rest.
    pub fn sheet(&mut self, particles: usize) -> Option<Lengths<'_>> {
        (self.columns.len() == particles && particles > 0).then(|| Lengths {
            rows: Shared::new(&mut self.chains),
            columns: Shared::new(&mut self.columns),
            diagonals: Shared::new(&mut self.springs),
        })
    }

    /// Nothing is granted any more.
    pub fn clear(&mut self) {
        self.strain.clear();
        (self.largest, self.mean) = (0.0, 0.0);
        self.trial = Trial::None;
        self.rescale();
    }

    /// The cloth has another scale: how long edges may be is known at the end of the next step.
    pub fn rescale(&mut self) {
        self.chains.clear();
        self.springs.clear();
        self.columns.clear();
    }

    /// What it takes on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.strain)
            + heap(&self.asked)
            + heap(&self.chains)
            + heap(&self.springs)
            + heap(&self.columns)
            + self.around.iter().map(heap).sum::<usize>()
    }

    /// Grants what is asked for, where more than the fabric has is, and takes back what was, at the end of a step.
    pub fn renew(&mut self, threads: Threads, position: &Points, seconds: f32, effort: Effort) {
        let n = threads.particles();
        if self.strain.len() != n {
            self.clear();
            // The chains of a mesh contradict one another at once.
            let lasts = effort.lasts() || matches!(threads, Threads::Mesh(_));
            if !effort.is_asked || !lasts {
                return;
            }
            self.strain.resize(n, [0.0; 2]);
        }
        self.asked.clear();
        let mut growth = 0.0;
        if effort.is_asked {
            self.measure(threads, position);
            let [granted, asked] = [&self.strain, &self.asked].map(|strain| {
                let sum: f32 = strain.iter().flatten().map(|part| part.max(0.0)).sum();
                sum / n as f32
            });
            if self.trial.grows(effort.stands(), [granted, asked]) {
                growth = 1.0 - (-GROWTH * seconds).exp();
            }
        }
        self.asked.resize(n, [0.0; 2]);
        // Nobody needs it.
        let times = if effort.is_strained() { 1.0 } else { UNUSED };
        self.largest = 0.0;
        let mut sum = 0.0;
        for (strain, asked) in self.strain.iter_mut().zip(&self.asked) {
            for (strain, asked) in strain.iter_mut().zip(asked) {
                *strain += growth * (asked.min(MOST) - BORNE - *strain).max(0.0);
                *strain = (*strain - times * taken_back(*strain) * seconds).max(0.0);
            }
            let [warp, weft] = *strain;
            sum += warp.max(weft);
            self.largest = self.largest.max(warp).max(weft);
        }
        self.mean = sum / n as f32;
        if self.largest < LEAST {
            self.clear();
            return;
        }
        self.lengthen(threads, position, seconds);
    }

    /// What is asked for around each particle: the mean over its surroundings. Where there is less, others have more.
    fn measure(&mut self, threads: Threads, position: &Points) {
        let [around, next] = &mut self.around;
        around.clear();
        around.resize(threads.particles(), Neighborhood::default());
        threads.each_edge(|ends, rest_length, c| {
            let [a, b] = ends.map(|i| position.get(i as usize));
            let strain = (a.distance(b) / rest_length - 1.0).min(2.0 * MOST);
            for i in ends {
                around[i as usize].add(c, strain);
            }
        });
        for round in 0..ROUNDS {
            next.clone_from(around);
            threads.each_edge(|ends, _, _| {
                let [a, b] = ends.map(|i| i as usize);
                next[a].add_part(&around[b], 1.0);
                next[b].add_part(&around[a], 1.0);
            });
            for (mean, sum) in around.iter_mut().zip(&*next) {
                *mean = Neighborhood::default();
                mean.add_part(sum, 1.0 / sum.count.max(1.0));
            }
            if round == 0 {
                self.asked.extend(around.iter().map(Neighborhood::strain));
            }
        }
        for (asked, around) in self.asked.iter_mut().zip(around) {
            for (asked, mean) in asked.iter_mut().zip(around.strain()) {
                *asked = asked.min(mean);
            }
        }
    }

    /// How long edges are to be.
    fn lengthen(&mut self, threads: Threads, position: &Points, seconds: f32) {
        let strain = &self.strain;
        let push = PUSH * seconds;
        let length = |ends: [u32; 2], rest_length: f32, c: f32| {
            let [a, b] = ends.map(|i| strain[i as usize]);
            let granted = 0.5 * (c * (a[0] + b[0]) + (1.0 - c) * (a[1] + b[1]));
            let [a, b] = ends.map(|i| position.get(i as usize));
            let is = a.distance(b) + push * rest_length;
            (rest_length * (1.0 + granted)).min(is.max(rest_length))
        };
        match threads {
            Threads::Sheet(lattice) => {
                let [dx, dy] = lattice.spacing.to_array();
                for lengths in [&mut self.chains, &mut self.columns, &mut self.springs] {
                    lengths.clear();
                    lengths.resize(strain.len(), 0.0);
                }
                for [a, b] in lattice.edges() {
                    let (i, is_row) = (a as usize, b == a + 1);
                    if is_row {
                        self.chains[i] = length([a, b], dx, 0.0);
                    } else {
                        self.columns[i] = length([a, b], dy, 1.0);
                    }
                }
                let columns = lattice.columns as usize;
                for (i, diagonal) in self.springs.iter_mut().enumerate() {
                    let [right, below] = [i + 1, i + columns].map(|k| k.min(strain.len() - 1));
                    let row = 0.5 * (self.chains[i] + self.chains[below]);
                    let column = 0.5 * (self.columns[i] + self.columns[right]);
                    *diagonal = row.hypot(column);
                }
            }
            Threads::Mesh(fabric) => {
                let chains = fabric.chains();
                self.chains.clone_from(&chains.rest_length);
                for (slot, ends) in chains.slots() {
                    self.chains[slot] = length(ends, self.chains[slot], chains.along_warp[slot]);
                }
                let springs = fabric.shear();
                self.springs.clear();
                let all = springs
                    .ends
                    .iter()
                    .zip(&springs.rest_length)
                    .zip(&springs.along_warp);
                self.springs
                    .extend(all.map(|((ends, rest), c)| length(*ends, *rest, *c)));
            }
        }
    }
}

/// The rate at which a strain that is granted is taken back [1/s].
fn taken_back(strain: f32) -> f32 {
    let [of_all, of_it, of_square] = TAKEN_BACK;
    of_all + strain * (of_it + strain * of_square)
}

impl Threads<'_> {
    fn particles(self) -> usize {
        match self {
            Self::Sheet(lattice) => lattice.columns as usize * lattice.rows as usize,
            Self::Mesh(fabric) => fabric.particles(),
        }
    }

    /// Calls `f` with the ends, rest length \[m\] and [`Chains::along_warp`] of each edge; of a sheet without the diagonals.
    fn each_edge(self, mut f: impl FnMut([u32; 2], f32, f32)) {
        match self {
            Self::Sheet(lattice) => {
                let [dx, dy] = lattice.spacing.to_array();
                for ends in lattice.edges() {
                    if ends[1] == ends[0] + 1 {
                        f(ends, dx, 0.0);
                    } else {
                        f(ends, dy, 1.0);
                    }
                }
            }
            Self::Mesh(fabric) => {
                let chains = fabric.chains();
                for (slot, ends) in chains.slots() {
                    f(ends, chains.rest_length[slot], chains.along_warp[slot]);
                }
                let springs = fabric.shear();
                for (k, ends) in springs.ends.iter().enumerate() {
                    f(*ends, springs.rest_length[k], springs.along_warp[k]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
