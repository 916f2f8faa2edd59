//! Constraints of a triangle mesh that is no grid: chains along the threads, springs across them.

use std::ops::Range;

use bevy_math::Vec3;

use super::{
    chains::{Chains, LANES, NONE},
    coloring::color_in_blocks,
    mesh_edges::MeshEdges,
    weave::{EdgeFamily, Weave},
};
use crate::memory::heap;

/// Weight below which an edge has no flow across it: such is the diagonal of a right-angled cell.
const LEAST_WEIGHT: f32 = 1e-3;

/// Largest part of the change to their common velocity that neighbours come in a substep [-].
const MOST_EXCHANGE: f32 = 0.5;

/// Compliance of a spring along a diagonal, as a part of that for shear: a shear angle γ stretches the diagonals of a square cell by γ/2,
/// and energy goes with the square of it.
const DIAGONAL: f32 = 0.25;

/// Constraints of a mesh that is no grid, in storage order.
#[derive(Clone, Debug, Default)]
pub struct Fabric {
    chains: Chains,
    /// Particle of each slot of the chains; the last particle where the chain has ended.
    particle_or_last: Vec<u32>,
    /// For each link of a batch, true if its particles lie one after the other.
    runs: Vec<bool>,
    shear: Springs,
    exchanges: Vec<Exchange>,
    particles: usize,
    size: f32,
}

/// Springs in batches that share no particle.
#[derive(Clone, Debug, Default)]
pub struct Springs {
    /// Particles at the ends.
    pub ends: Vec<[u32; 2]>,
    /// Rest lengths \[m\].
    pub rest_length: Vec<f32>,
    /// Ratio of the spring's compliance to that of the fabric for shear \[m/N\] [-].
    pub scale: Vec<f32>,
    /// Square of the cosine of the angle to the warp [-].
    pub along_warp: Vec<f32>,
    /// Springs of each batch.
    pub batches: Vec<Range<usize>>,
}

/// Exchange of momentum between two neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Exchange {
    /// The two particles.
    pub ends: [u32; 2],
    /// Weight of the edge in the discrete Laplacian: half the sum of the cotangents of the angles opposite to it [-].
    pub weight: f32,
    /// Largest product of viscosity and time \[m²\].
    pub limit: f32,
}

impl Fabric {
    /// Fabric of a mesh whose particles, `chains` and `weave` are in storage order.
    pub(super) fn new(
        rest_positions: &[Vec3],
        triangles: &[[u32; 3]],
        chains: Chains,
        weave: &Weave,
    ) -> Self {
        let (low, high) = rest_positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let mut fabric = Self {
            shear: Springs::new(rest_positions, weave),
            exchanges: exchanges(rest_positions, triangles),
            particles: rest_positions.len(),
            size: low.distance(high),
            particle_or_last: chains.particle.clone(),
            runs: Vec::with_capacity(chains.particle.len() / LANES),
            chains,
        };
        for batch in &fabric.chains.batches {
            for slot in batch.slots.clone() {
                if fabric.particle_or_last[slot] == NONE {
                    let last = (slot >= batch.slots.start + LANES)
                        .then(|| fabric.particle_or_last[slot - LANES]);
                    fabric.particle_or_last[slot] = last.unwrap_or(0);
                }
            }
        }
        for link in fabric.chains.particle.as_chunks::<LANES>().0 {
            let run = link[0] < NONE - LANES as u32
                && (link[0]..).zip(link).all(|(expected, i)| expected == *i);
            fabric.runs.push(run);
        }
        fabric
    }

    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.chains.memory_bytes()
            + heap(&self.particle_or_last)
            + heap(&self.runs)
            + self.shear.memory_bytes()
            + heap(&self.exchanges)
    }

    /// Chains of the edges along the threads.
    pub fn chains(&self) -> &Chains {
        &self.chains
    }

    /// Particle of each slot of the chains; the last particle where the chain has ended.
    pub fn particle_or_last(&self) -> &[u32] {
        &self.particle_or_last
    }

    /// For each link of a batch ([`LANES`] slots), true if its particles lie one after the other.
    pub fn runs(&self) -> &[bool] {
        &self.runs
    }

    /// Springs of the edges across the threads.
    pub fn shear(&self) -> &Springs {
        &self.shear
    }

    /// Pairs that exchange momentum by viscosity.
    pub fn exchanges(&self) -> &[Exchange] {
        &self.exchanges
    }

    /// Number of particles; all indices are below.
    pub fn particles(&self) -> usize {
        self.particles
    }

    /// Diagonal of the box around the rest shape \[m\].
    pub fn size(&self) -> f32 {
        self.size
    }
}

impl Springs {
    fn memory_bytes(&self) -> usize {
        heap(&self.ends)
            + heap(&self.rest_length)
            + heap(&self.scale)
            + heap(&self.along_warp)
            + heap(&self.batches)
    }

    fn new(rest_positions: &[Vec3], weave: &Weave) -> Self {
        let edges: Vec<usize> = (0..weave.ends.len())
            .filter(|edge| weave.family[*edge] == EdgeFamily::Shear)
            .collect();
        let pairs: Vec<[u32; 2]> = edges.iter().map(|edge| weave.ends[*edge]).collect();
        let mut springs = Self::default();
        for batch in color_in_blocks(&pairs, rest_positions.len()) {
            let start = springs.ends.len();
            for k in batch {
                let ends = pairs[k as usize];
                let [a, b] = ends.map(|i| rest_positions[i as usize]);
                springs.ends.push(ends);
                springs.rest_length.push(a.distance(b));
                let edge = edges[k as usize];
                springs.scale.push(DIAGONAL * weave.scale[edge]);
                springs.along_warp.push(weave.along_warp[edge]);
            }
            springs.batches.push(start..springs.ends.len());
        }
        springs
    }
}

fn exchanges(rest_positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Exchange> {
    let edges = MeshEdges::new(rest_positions.len(), triangles);
    let mut weights = vec![0.0f32; edges.len()];
    let mut areas = vec![0.0f32; rest_positions.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        for side in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|k| rest_positions[triangle[(side + k) % 3] as usize]);
            let (a, b) = (p - r, q - r);
            let double_area = a.cross(b).length();
            weights[edges.edge_of_side[3 * t + side] as usize] += 0.5 * a.dot(b) / double_area;
            areas[triangle[side] as usize] += double_area / 6.0;
        }
    }
    let counts = |weight: &f32| *weight > LEAST_WEIGHT && weight.is_finite();
    let mut sums = vec![0.0f32; rest_positions.len()];
    for (ends, weight) in edges.ends.iter().zip(&weights) {
        for &i in ends {
            sums[i as usize] += if counts(weight) { *weight } else { 0.0 };
        }
    }
    let some = edges.ends.iter().zip(&weights);
    let exchanges: Vec<Exchange> = some
        .filter(|(_, weight)| counts(weight))
        .map(|(&ends, &weight)| Exchange {
            ends,
            weight,
            limit: ends
                .map(|i| MOST_EXCHANGE * areas[i as usize] / sums[i as usize])
                .into_iter()
                .fold(f32::INFINITY, f32::min),
        })
        .collect();
    // Successive exchanges mostly share no particle: then none has to wait for the stores of the one before.
    let pairs: Vec<[u32; 2]> = exchanges.iter().map(|exchange| exchange.ends).collect();
    let batches = color_in_blocks(&pairs, rest_positions.len());
    let order = batches.into_iter().flatten();
    order.map(|k| exchanges[k as usize]).collect()
}
