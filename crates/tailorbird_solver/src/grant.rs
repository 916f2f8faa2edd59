//! Additional length of the threads of a strained cloth.
//!
//! If holds or colliders ask for more than a fabric has, its lines contradict each other: each takes what it can from those that cross
//! it, and single edges take the rest. So the fabric is granted a strain along the warp and one along the weft for each particle, smoothed
//! over its neighbourhood, that grows towards the mean strain there. Then the lines agree again, and the demand is shared evenly. The grant
//! is taken back at a rate, whether or not the demand lasts; so stretch comes back without becoming speed.

mod trial;

use trial::Trial;

use crate::{
    effort::Effort,
    kernels::{lanes::Shared, lattice::Lengths},
    memory_bytes,
    points::Points,
    topology::{
        chains::Chains,
        fabric::Springs,
        layout::{Layout, SheetLayout},
    },
};

/// Rate at which the grant grows towards the demand [1/s].
const GROWTH: f32 = 40.0;

/// Rates at which the grant is taken back: constant [1/s], of its value [1/s], of its square [1/s].
const TAKEN_BACK: [f32; 3] = [0.05, 1.5, 6.0];

/// Factor of these rates while no edge is strained [-].
const UNUSED: f32 = 4.0;

/// Rate at which an edge that is shorter than its granted length is made longer [1/s].
const PUSH: f32 = 0.5;

/// Strain that a strained fabric bears without a grant [-].
const BORNE: f32 = 0.01;

/// Number of times that the demand is averaged with that of neighbours.
const ROUNDS: usize = 4;

/// Largest granted strain [-].
const MOST: f32 = 1.0;

/// Mean grant above which it is much [-].
const MUCH: f32 = 5e-3;

/// Largest grant below which there is none [-].
const LEAST: f32 = 1e-3;

/// Granted strain of a cloth; empty where nothing is granted.
#[derive(Clone, Debug, Default)]
pub struct Grant {
    /// Strain along warp and weft of each particle [-].
    strain: Vec<[f32; 2]>,
    /// Largest of those strains, and their mean [-].
    largest: f32,
    mean: f32,
    /// Granted length of the edge of each slot of the chains \[m\]; of a sheet, for each particle the edge to the next of its row.
    chains: Vec<f32>,
    /// Granted length of each spring across the threads \[m\]; of a sheet, for each particle the diagonals of the cell beyond it.
    springs: Vec<f32>,
    /// For each particle of a sheet, the granted length of the edge to the next of its column \[m\].
    columns: Vec<f32>,
    /// Trial that tells a demand from a load.
    trial: Trial,
    /// Normal equations of the strain around each particle; scratch.
    neighborhoods: [Vec<Neighborhood>; 2],
    /// Strain demanded around each particle, and no more than there is [-]; scratch.
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
    /// Number of edges.
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

    /// Strains (u, v), drawn a little towards 0; 0 without edges.
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

memory_bytes!(Grant: strain, asked, chains, springs, columns, neighborhoods);

impl Grant {
    /// Returns whether nothing is granted.
    pub fn is_empty(&self) -> bool {
        self.strain.is_empty()
    }

    /// Returns whether much is granted, and not in one place alone.
    pub fn is_much(&self) -> bool {
        self.mean > MUCH
    }

    /// Largest granted strain [-].
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Granted strain as one number for all of the cloth [-]: the strain itself if it is the same everywhere, and less if it is granted in
    /// one place alone.
    pub fn overall(&self) -> f32 {
        (self.mean * self.largest).sqrt()
    }

    /// Granted lengths of the edges of the chains \[m\].
    pub fn chains<'a>(&'a self, chains: &'a Chains) -> &'a [f32] {
        if self.chains.len() == chains.rest_length.len() {
            &self.chains
        } else {
            &chains.rest_length
        }
    }

    /// Granted lengths of the springs across the threads \[m\].
    pub fn springs<'a>(&'a self, springs: &'a Springs) -> &'a [f32] {
        if self.springs.len() == springs.rest_length.len() {
            &self.springs
        } else {
            &springs.rest_length
        }
    }

    /// Granted lengths of the edges of a sheet; `None` where they are as at rest.
    pub fn sheet(&mut self, particles: usize) -> Option<Lengths<'_>> {
        (self.columns.len() == particles && particles > 0).then(|| Lengths {
            rows: Shared::new(&mut self.chains),
            columns: Shared::new(&mut self.columns),
            diagonals: Shared::new(&mut self.springs),
        })
    }

    /// Withdraws the whole grant.
    pub fn clear(&mut self) {
        self.strain.clear();
        (self.largest, self.mean) = (0.0, 0.0);
        self.trial = Trial::None;
        self.rescale();
    }

    /// Forgets the lengths, because the cloth has another scale: they are computed again at the end of the next step.
    pub fn rescale(&mut self) {
        self.chains.clear();
        self.springs.clear();
        self.columns.clear();
    }

    /// Grants the demand of a cloth that is asked for more than the fabric has, and takes back what was granted, at the end of a step.
    pub fn renew(&mut self, layout: &Layout, position: &Points, seconds: f32, effort: Effort) {
        let n = layout.particles();
        if self.strain.len() != n {
            self.clear();
            // The chains of a mesh contradict one another at once.
            let lasts = effort.lasts() || matches!(layout, Layout::Mesh(_));
            if !effort.is_asked || !lasts {
                return;
            }
            self.strain.resize(n, [0.0; 2]);
        }
        self.asked.clear();
        let mut growth = 0.0;
        if effort.is_asked {
            self.measure(layout, position);
            let [granted, asked] = [&self.strain, &self.asked].map(|strain| {
                let sum: f32 = strain.iter().flatten().map(|part| part.max(0.0)).sum();
                sum / n as f32
            });
            if self.trial.grows(effort.stands(), [granted, asked]) {
                growth = 1.0 - (-GROWTH * seconds).exp();
            }
        }
        self.asked.resize(n, [0.0; 2]);
        // Unused grants are taken back faster.
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
        self.lengthen(layout, position, seconds);
    }

    /// Measures the demand around each particle: the mean strain of its neighbourhood. Where there is less, others have more.
    fn measure(&mut self, layout: &Layout, position: &Points) {
        let [neighborhoods, next] = &mut self.neighborhoods;
        neighborhoods.clear();
        neighborhoods.resize(layout.particles(), Neighborhood::default());
        layout.each_edge(|ends, rest_length, c| {
            let [a, b] = ends.map(|i| position.get(i as usize));
            let strain = (a.distance(b) / rest_length - 1.0).min(2.0 * MOST);
            for i in ends {
                neighborhoods[i as usize].add(c, strain);
            }
        });
        for round in 0..ROUNDS {
            next.clone_from(neighborhoods);
            layout.each_edge(|ends, _, _| {
                let [a, b] = ends.map(|i| i as usize);
                next[a].add_part(&neighborhoods[b], 1.0);
                next[b].add_part(&neighborhoods[a], 1.0);
            });
            for (mean, sum) in neighborhoods.iter_mut().zip(&*next) {
                *mean = Neighborhood::default();
                mean.add_part(sum, 1.0 / sum.count.max(1.0));
            }
            if round == 0 {
                self.asked
                    .extend(neighborhoods.iter().map(Neighborhood::strain));
            }
        }
        for (asked, neighborhoods) in self.asked.iter_mut().zip(neighborhoods) {
            for (asked, mean) in asked.iter_mut().zip(neighborhoods.strain()) {
                *asked = asked.min(mean);
            }
        }
    }

    /// Computes the lengths of the edges.
    fn lengthen(&mut self, layout: &Layout, position: &Points, seconds: f32) {
        let strain = &self.strain;
        let push = PUSH * seconds;
        let length = |ends: [u32; 2], rest_length: f32, c: f32| {
            let [a, b] = ends.map(|i| strain[i as usize]);
            let granted = 0.5 * (c * (a[0] + b[0]) + (1.0 - c) * (a[1] + b[1]));
            let [a, b] = ends.map(|i| position.get(i as usize));
            let is = a.distance(b) + push * rest_length;
            (rest_length * (1.0 + granted)).min(is.max(rest_length))
        };
        match layout {
            Layout::Sheet(SheetLayout { lattice, .. }) => {
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
            Layout::Mesh(fabric) => {
                let chains = &fabric.chains;
                self.chains.clone_from(&chains.rest_length);
                for (slot, ends) in chains.slots() {
                    self.chains[slot] = length(ends, self.chains[slot], chains.along_warp[slot]);
                }
                let springs = &fabric.shear;
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

/// Rate at which a granted strain is taken back [1/s].
fn taken_back(strain: f32) -> f32 {
    let [of_all, of_it, of_square] = TAKEN_BACK;
    of_all + strain * (of_it + strain * of_square)
}

impl Layout {
    fn particles(&self) -> usize {
        match self {
            Self::Sheet(SheetLayout { lattice, .. }) => {
                lattice.columns as usize * lattice.rows as usize
            }
            Self::Mesh(fabric) => fabric.particles,
        }
    }

    /// Calls `f` with the ends, rest length \[m\] and [`Chains::along_warp`] of each edge; for a sheet without the diagonals.
    fn each_edge(&self, mut f: impl FnMut([u32; 2], f32, f32)) {
        match self {
            Self::Sheet(SheetLayout { lattice, .. }) => {
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
                let chains = &fabric.chains;
                for (slot, ends) in chains.slots() {
                    f(ends, chains.rest_length[slot], chains.along_warp[slot]);
                }
                let springs = &fabric.shear;
                for (k, ends) in springs.ends.iter().enumerate() {
                    f(*ends, springs.rest_length[k], springs.along_warp[k]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
