//! Chains of edges that are solved exactly, sixteen side by side.

use std::ops::Range;

use bevy_math::Vec3;

use super::{
    coloring::color_in_blocks,
    weave::{EdgeFamily, Weave},
};
use crate::memory_bytes;

mod cover;
mod layout;

use cover::{Cover, cover};

/// Number of chains solved side by side.
pub const LANES: usize = 16;

/// Number of passes after which the edges that are left are taken one by one: looking for chains once more takes as long as it did at
/// first.
const MOST_COVERS: usize = 64;

/// In [`Chains::particle`]: no particle.
pub const NONE: u32 = u32::MAX;

/// In [`ChainBatch::closing`]: no ring.
pub const OPEN: u32 = u32::MAX;

/// Up to [`LANES`] chains of similar length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChainBatch {
    /// Range of slots: [`LANES`] for each link.
    pub slots: Range<usize>,
    /// Particles along the longest chain, at least 2.
    pub length: usize,
    /// For each lane the edge that closes a ring, whose last particle is its first one, or [`OPEN`]; `None` where all chains are open.
    pub closing: Option<[u32; LANES]>,
}

/// Batches that share no particle and can be solved in any order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChainPass {
    /// Threads that the edges follow: the warp or the weft.
    pub family: EdgeFamily,
    /// Range of batches.
    pub batches: Range<usize>,
}

/// Chains of the edges along warp and weft, every edge in one of them. A closed chain is a ring: its last link is its first particle once
/// more.
///
/// Slot `batch.slots.start + k * LANES + lane` is the `k`-th link of a chain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chains {
    /// Passes, solved one after the other: first all of the family whose chains are longer; of each family the longest chains first.
    pub passes: Vec<ChainPass>,
    /// Batches of all passes.
    pub batches: Vec<ChainBatch>,
    /// Particle of each slot, [`NONE`] where the chain has ended or the lane is empty.
    pub particle: Vec<u32>,
    /// Rest length of the edge from each slot to the next link \[m\]; 0 without an edge.
    pub rest_length: Vec<f32>,
    /// [`Weave::scale`] of that edge \[-\]; 0 without an edge.
    pub scale: Vec<f32>,
    /// [`Weave::along_warp`] of that edge \[-\]; 0 without an edge.
    pub along_warp: Vec<f32>,
}

memory_bytes!(Chains: passes, batches, particle, rest_length, scale, along_warp);

impl Chains {
    /// Covers the edges along warp and weft with chains, and renumbers the particles so that the particles of the first pass lie one after
    /// the other.
    ///
    /// Returns the chains, in storage order, and the original index of each particle in storage order. In each batch of the first pass
    /// storage order runs along the lanes, then to the next link; adjacent lanes and adjacent batches lie side by side on the mesh.
    /// `rest_positions` \[m\] and `weave` are in original order.
    pub fn build(rest_positions: &[Vec3], weave: &Weave) -> (Self, Vec<u32>) {
        let mut families = [EdgeFamily::Warp, EdgeFamily::Weft]
            .map(|family| (family, covers(rest_positions, weave, family)));
        let weight = |covers: &[Cover]| covers.first().map_or(0, Cover::weight);
        if weight(&families[1].1) > weight(&families[0].1) {
            families.swap(0, 1);
        }

        let mut chains = Self::default();
        let mut order = Vec::new();
        let mut number = Vec::new();
        for (family, covers) in &families {
            for cover in covers {
                let batches = if number.is_empty() {
                    let batches = layout::side_by_side(cover, rest_positions, weave);
                    order = layout::order(cover, &batches, rest_positions.len(), weave);
                    number = inverse(&order);
                    batches
                } else {
                    layout::by_number(cover, &number)
                };
                chains.push(*family, cover, &batches, &number, rest_positions, weave);
            }
        }
        if order.is_empty() {
            order = (0..rest_positions.len() as u32).collect();
        }
        (chains, order)
    }

    /// Ends and rest lengths \[m\] of all edges.
    pub fn edges(&self) -> impl Iterator<Item = ([u32; 2], f32)> + '_ {
        self.slots()
            .map(|(slot, ends)| (ends, self.rest_length[slot]))
    }

    /// Slots that have an edge, with its ends.
    pub fn slots(&self) -> impl Iterator<Item = (usize, [u32; 2])> + '_ {
        let next = self.particle.get(LANES..).unwrap_or_default();
        let ends = self.particle.iter().zip(next).zip(&self.rest_length);
        ends.enumerate()
            .filter(|(_, (_, length))| **length > 0.0)
            .map(|(slot, ((a, b), _))| (slot, [*a, *b]))
    }

    fn push(
        &mut self,
        family: EdgeFamily,
        cover: &Cover,
        batches: &[layout::LaneChains],
        number: &[u32],
        rest_positions: &[Vec3],
        weave: &Weave,
    ) {
        let first = self.batches.len();
        for batch in batches {
            let start = self.particle.len();
            let end = start + batch.length * LANES;
            self.particle.resize(end, NONE);
            self.rest_length.resize(end, 0.0);
            self.scale.resize(end, 0.0);
            self.along_warp.resize(end, 0.0);
            let mut closing = [OPEN; LANES];
            for (lane, &(chain, reversed)) in batch.lanes.iter().enumerate() {
                if cover.is_ring(chain) {
                    closing[lane] = cover.particles(chain).len() as u32 - 2;
                }
                for (k, (particle, edge)) in cover.links(chain, reversed).enumerate() {
                    let slot = start + k * LANES + lane;
                    self.particle[slot] = number[particle as usize];
                    if let Some(&[a, b]) = weave.ends.get(edge as usize) {
                        let [a, b] = [a, b].map(|i| rest_positions[i as usize]);
                        self.rest_length[slot] = a.distance(b);
                        self.scale[slot] = weave.scale[edge as usize];
                        self.along_warp[slot] = weave.along_warp[edge as usize];
                    }
                }
            }
            self.batches.push(ChainBatch {
                slots: start..end,
                length: batch.length,
                closing: (closing != [OPEN; LANES]).then_some(closing),
            });
        }
        self.passes.push(ChainPass {
            family,
            batches: first..self.batches.len(),
        });
    }
}

/// Storage index of each particle in original order, from the `order` that [`Chains::build`] returns.
pub fn inverse(order: &[u32]) -> Vec<u32> {
    let mut number = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    number
}

/// Chains for all edges of a family, one cover for each pass.
fn covers(rest_positions: &[Vec3], weave: &Weave, family: EdgeFamily) -> Vec<Cover> {
    let mut edges: Vec<u32> = (0..weave.ends.len() as u32)
        .filter(|edge| weave.family[*edge as usize] == family)
        .collect();
    let mut used = vec![0; rest_positions.len()];
    let mut covers = Vec::new();
    while !edges.is_empty() {
        let pass = covers.len() as u32 + 1;
        if covers.len() == MOST_COVERS {
            // The edges of a fan at one particle, of which each pass takes one.
            let spokes: Vec<[u32; 2]> = edges.iter().map(|e| weave.ends[*e as usize]).collect();
            for batch in color_in_blocks(&spokes, rest_positions.len()) {
                let batch = batch.into_iter();
                covers.push(Cover::single(
                    batch.map(|k| (edges[k as usize], spokes[k as usize])),
                ));
            }
            break;
        }
        covers.push(cover(&mut edges, rest_positions, weave, &mut used, pass));
    }
    covers
}

#[cfg(test)]
mod tests;
