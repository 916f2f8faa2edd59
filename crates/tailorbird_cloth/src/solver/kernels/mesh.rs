//! The constraints of a triangle mesh, in the form that the vector kernels want.
//!
//! Chains are gathered, one into each lane, into scratch that has the form of columns of a sheet, solved by the same kernel as
//! those, and scattered back. A lane whose chain has ended goes on with copies of its last particle and edges of length 0,
//! of which nothing comes. Springs are gathered as well, from batches that share no particle.

use std::ops::Range;

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    lanes::{Factor, Shared, SharedPoints, V3, WIDEST, with_scratch},
    lattice::Block,
    line::{self, MeshLines},
    viscosity::RigidMotion,
};
use crate::{
    points::Points,
    topology::{
        chains::{ChainBatch, LANES, NONE},
        fabric::Fabric,
    },
};

/// Denominators below this [1/kg] count as this.
const HEAVIEST: f32 = 1e-30;

/// The particles of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Mesh<'a> {
    /// What joins them.
    pub fabric: &'a Fabric,
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 where there is none; empty where nothing is in contact.
    pub normal: Option<SharedPoints<'a>>,
}

impl Mesh<'_> {
    /// Makes sure that all particles of the fabric are there.
    ///
    /// # Panics
    /// Where they are not.
    #[inline(always)]
    fn check(&self) {
        let n = self.fabric.particles();
        let points = |p: SharedPoints| [p.x.len(), p.y.len(), p.z.len()] == [n; 3];
        assert!(
            points(self.position) && self.inv_mass.len() == n && self.normal.is_none_or(points),
            "a mesh of {n} particles"
        );
    }
}

/// Particles that belong to the lanes of a vector: any ones, or from a first one on.
#[derive(Clone, Copy)]
struct Lanes<'a> {
    particles: &'a [u32],
    run: bool,
}

impl<'a> Lanes<'a> {
    /// The particles of link `k` of the chains that start at the slot `start` and those after it.
    #[inline(always)]
    fn of_link<S: Simd>(fabric: &Fabric, slots: &'a [u32], start: usize, k: usize) -> Self {
        let at = start + k * LANES;
        Self {
            particles: &slots[at..][..S::f32s::LEN],
            run: fabric.runs()[at / LANES],
        }
    }

    #[inline(always)]
    fn load<S: Simd>(self, simd: S, from: Shared) -> S::f32s {
        if self.run {
            return from.load(simd, self.particles[0] as usize);
        }
        let mut lanes = [0.0; WIDEST];
        for (lane, &i) in lanes.iter_mut().zip(&self.particles[..S::f32s::LEN]) {
            *lane = from.get(i as usize);
        }
        S::f32s::from_slice(simd, &lanes[..S::f32s::LEN])
    }

    #[inline(always)]
    fn load_points<S: Simd>(self, simd: S, from: SharedPoints) -> V3<S> {
        V3 {
            x: self.load(simd, from.x),
            y: self.load(simd, from.y),
            z: self.load(simd, from.z),
        }
    }

    /// Stores all lanes but those of [`NONE`].
    #[inline(always)]
    fn store<S: Simd>(self, to: Shared, value: S::f32s) {
        if self.run {
            to.store::<S>(self.particles[0] as usize, value);
            return;
        }
        for (&i, &lane) in self.particles.iter().zip(value.as_slice()) {
            if i != NONE {
                to.set(i as usize, lane);
            }
        }
    }

    #[inline(always)]
    fn store_points<S: Simd>(self, to: SharedPoints, value: V3<S>) {
        self.store::<S>(to.x, value.x);
        self.store::<S>(to.y, value.y);
        self.store::<S>(to.z, value.z);
    }
}

/// Solves the chains of a range of batches. `stretch` is α̃ of an edge whose scale is 1 [1/kg].
pub(crate) fn solve_chains(level: Level, mesh: Mesh, stretch: f32, batches: Range<usize>) {
    mesh.check();
    let batches = &mesh.fabric.chains().batches[batches];
    let longest = batches.iter().map(|batch| batch.length).max().unwrap_or(0);
    with_scratch(longest * WIDEST * 9, |scratch| {
        for batch in batches {
            dispatch!(level, simd => solve_batch(simd, mesh, stretch, batch, scratch));
        }
    });
}

#[inline(always)]
fn solve_batch<S: Simd>(
    simd: S,
    mesh: Mesh,
    stretch: f32,
    batch: &ChainBatch,
    scratch: &mut [f32],
) {
    let (m, n) = (batch.length, S::f32s::LEN);
    let chains = mesh.fabric.chains();
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let block = Block::new(rest, m, n);
    for first in (0..LANES).step_by(n) {
        let start = batch.slots.start + first;
        if chains.particle[start] == NONE {
            // Lanes are taken in order.
            break;
        }
        for k in 0..m {
            let lanes = Lanes::of_link::<S>(mesh.fabric, mesh.fabric.particle_or_last(), start, k);
            block
                .position
                .store(k * n, lanes.load_points(simd, mesh.position));
            block
                .inv_mass
                .store::<S>(k * n, lanes.load(simd, mesh.inv_mass));
            if let Some(normal) = mesh.normal {
                block.normal.store(k * n, lanes.load_points(simd, normal));
            }
        }
        let edges = MeshLines {
            rest_length: &chains.rest_length[start..batch.slots.end],
            scale: &chains.scale[start..batch.slots.end],
            stretch,
            stride: LANES,
        };
        let lines = block.lines(m, n);
        if mesh.normal.is_some() {
            line::solve::<S, _, false, true>(simd, lines, edges, 0.0, factors);
        } else {
            line::solve::<S, _, false, false>(simd, lines, edges, 0.0, factors);
        }
        for k in 0..m {
            let moved: V3<S> = block.position.load(simd, k * n);
            Lanes::of_link::<S>(mesh.fabric, &chains.particle, start, k)
                .store_points(mesh.position, moved);
        }
    }
}

/// Projects the springs across the threads. `alpha_tilde` is that of a spring whose scale is 1 [1/kg].
pub(crate) fn solve_shear(level: Level, mesh: Mesh, alpha_tilde: f32) {
    mesh.check();
    dispatch!(level, simd => solve_shear_with(simd, mesh, alpha_tilde));
}

#[inline(always)]
fn solve_shear_with<S: Simd>(simd: S, mesh: Mesh, alpha_tilde: f32) {
    let springs = mesh.fabric.shear();
    let n = S::f32s::LEN;
    for batch in &springs.batches {
        let mut k = batch.start;
        while k < batch.end {
            let count = (batch.end - k).min(n);
            // Lanes beyond the end stand for a spring from a particle to itself.
            let (mut near, mut far) = ([NONE; WIDEST], [NONE; WIDEST]);
            let (mut rest, mut scale) = ([0.0; WIDEST], [0.0; WIDEST]);
            for lane in 0..count {
                [near[lane], far[lane]] = springs.ends[k + lane];
                rest[lane] = springs.rest_length[k + lane];
                scale[lane] = springs.scale[k + lane];
            }
            spring(simd, mesh, count, [&near, &far], &rest, &scale, alpha_tilde);
            k += count;
        }
    }
}

#[inline(always)]
fn spring<S: Simd>(
    simd: S,
    mesh: Mesh,
    count: usize,
    [near, far]: [&[u32; WIDEST]; 2],
    rest: &[f32; WIDEST],
    scale: &[f32; WIDEST],
    alpha_tilde: f32,
) {
    let n = S::f32s::LEN;
    let valid = |ends: &[u32; WIDEST]| {
        let mut valid = *ends;
        valid[count..].fill(ends[0]);
        valid
    };
    let (load_near, load_far) = (valid(near), valid(far));
    let lanes = |particles| Lanes {
        particles,
        run: false,
    };
    let a: V3<S> = lanes(&load_near[..n]).load_points(simd, mesh.position);
    let b: V3<S> = lanes(&load_far[..n]).load_points(simd, mesh.position);
    let w_a: S::f32s = lanes(&load_near[..n]).load(simd, mesh.inv_mass);
    let w_b: S::f32s = lanes(&load_far[..n]).load(simd, mesh.inv_mass);
    let length = S::f32s::from_slice(simd, &rest[..n]);
    let l2 = length * length;
    let alpha = S::f32s::from_slice(simd, &scale[..n]) * alpha_tilde;
    let least = S::f32s::splat(simd, HEAVIEST);
    let d = b - a;
    let q = d.dot(d);
    let excess = q - l2;
    // As for bending: see `line`.
    let w = w_a + w_b;
    let w = (w * 0.5 + alpha).max(w).max(least);
    let push = Factor((excess + excess) / ((q * 3.0 + l2) * w)) * d;
    lanes(&near[..n]).store_points(mesh.position, a + Factor(w_a) * push);
    lanes(&far[..n]).store_points(mesh.position, b - Factor(w_b) * push);
}

/// Internal viscosity: neighbours exchange momentum in proportion to the difference of their velocities x − x⁻, after the
/// rigid motion of the whole was subtracted; x⁻ moves. What rounding takes from that is added to `lost` \[m\], so
/// that momentum is kept. `viscosity` is that times the time \[m²\], `areal_density` in kg/m².
///
/// # Panics
/// When there are not as many particles as the fabric has.
pub fn exchange(
    fabric: &Fabric,
    position: &Points,
    previous: &mut Points,
    lost: &mut Points,
    inv_mass: &[f32],
    motion: RigidMotion,
    viscosity: f32,
    areal_density: f32,
) {
    let n = fabric.particles();
    with_scratch(6 * n, |scratch| {
        let (velocity, momentum) = scratch.split_at_mut(3 * n);
        let (velocity, _) = velocity.as_chunks_mut::<3>();
        let (momentum, _) = momentum.as_chunks_mut::<3>();
        momentum.fill([0.0; 3]);
        for (i, v) in velocity.iter_mut().enumerate() {
            let x = position.get(i);
            let rigid = motion.displacement + motion.rotation.cross(x - motion.center);
            *v = (x - previous.get(i) - rigid).to_array();
        }
        for exchange in fabric.exchanges() {
            let [a, b] = exchange.ends.map(|i| i as usize);
            let conductance = areal_density * exchange.weight * viscosity.min(exchange.limit);
            for axis in 0..3 {
                let flow = conductance * (velocity[b][axis] - velocity[a][axis]);
                momentum[a][axis] += flow;
                momentum[b][axis] -= flow;
            }
        }
        for (i, (momentum, w)) in momentum.iter().zip(inv_mass).enumerate() {
            let (change, before) = (Vec3::from_array(*momentum) * *w, previous.get(i));
            let after = before - change;
            lost.add(i, change - (before - after));
            previous.set(i, after);
        }
    });
}
