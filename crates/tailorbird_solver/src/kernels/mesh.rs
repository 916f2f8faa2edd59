//! The constraints of a triangle mesh, in the form that the vector kernels want.
//!
//! Chains are gathered, one into each lane, into scratch that has the form of the columns of a sheet, solved by the kernel of those
//! columns, and scattered back. A lane whose chain has ended goes on with copies of its last particle and edges of length 0, which have no
//! effect. Springs are taken one after the other.

use std::ops::Range;

use bevy_math::Vec4;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::{
    edges::MeshLines,
    lanes::{Shared, SharedPoints, V3, WIDEST, with_scratch},
    lattice::Block,
    line,
    lines::{FREE, Give, Lines, NO_MASS, PRESSED, TOUCHING},
    packed::{Packed, inv_mass, of_space, squared},
    rigid_motion::RigidMotion,
    ring,
};
use crate::{
    instruction_set::for_few,
    points::Points,
    topology::{
        chains::{ChainBatch, LANES, NONE},
        fabric::{Fabric, Springs},
    },
};

/// Smallest denominator [1/kg].
const HEAVIEST: f32 = 1e-30;

/// Particles of a mesh.
#[derive(Clone, Copy)]
pub struct Mesh<'a> {
    /// Constraints between the particles.
    pub fabric: &'a Fabric,
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 for particles without contact; `None` where nothing is in contact.
    pub normal: Option<SharedPoints<'a>>,
    /// Sums of the impulses on particles along their normals.
    pub pressed: Option<Shared<'a>>,
    /// Prescribed length of the edge of each slot of the chains \[m\].
    pub rest_length: &'a [f32],
    /// Limits of compliance and tension.
    pub give: Give,
}

impl Mesh<'_> {
    /// Checks that all particles of the fabric are there.
    ///
    /// # Panics
    /// When they are not.
    #[inline(always)]
    fn check(&self) {
        let n = self.fabric.particles;
        // Particles that are split off follow those of the mesh.
        assert!(
            self.position.has(n)
                && self.inv_mass.len() >= n
                && self.normal.is_none_or(|normal| normal.has(n))
                && self.pressed.is_none_or(|pressed| pressed.len() >= n)
                && self.rest_length.len() == self.fabric.chains.particle.len(),
            "a mesh of {n} particles"
        );
    }
}

/// Particles in the lanes of a vector: any particles, or consecutive ones from a first on.
#[derive(Clone, Copy)]
struct Lanes<'a> {
    particles: &'a [u32],
    run: bool,
}

impl<'a> Lanes<'a> {
    /// Particles of link `k` of the chains that start at the slot `start` and at those after it.
    #[inline(always)]
    fn of_link<S: Simd>(fabric: &Fabric, slots: &'a [u32], start: usize, k: usize) -> Self {
        let at = start + k * LANES;
        Self {
            particles: &slots[at..][..S::f32s::LEN],
            run: fabric.runs[at / LANES],
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

    /// Stores all lanes but the lanes of [`NONE`].
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
pub fn solve_chains(level: Level, mesh: Mesh, stretch: f32, batches: Range<usize>) {
    mesh.check();
    let batches = &mesh.fabric.chains.batches[batches];
    let longest = batches.iter().map(|batch| batch.length).max().unwrap_or(0);
    with_scratch(longest * WIDEST * 13, |scratch| {
        for batch in batches {
            if mesh.pressed.is_some() {
                for_few!(level, simd => solve_batch::<_, true>(simd, mesh, stretch, batch, scratch));
            } else {
                dispatch!(level, simd => solve_batch::<_, false>(simd, mesh, stretch, batch, scratch));
            }
        }
    });
}

#[inline(always)]
fn solve_batch<S: Simd, const BODIES: bool>(
    simd: S,
    mesh: Mesh,
    stretch: f32,
    batch: &ChainBatch,
    scratch: &mut [f32],
) {
    let (m, n) = (batch.length, S::f32s::LEN);
    let chains = &mesh.fabric.chains;
    let (factors, rest) = scratch.split_at_mut(2 * m * n);
    let factors = Shared::new(factors);
    let block = Block::new(rest, m, n);
    for first in (0..LANES).step_by(n) {
        let start = batch.slots.start + first;
        if chains.particle[start] == NONE {
            // Lanes are taken in order.
            break;
        }
        let quarter = S::f32s::splat(simd, 0.25);
        let mut lightest = S::f32s::splat(simd, NO_MASS);
        for k in 0..m {
            let lanes = Lanes::of_link::<S>(mesh.fabric, &mesh.fabric.particle_or_last, start, k);
            let w = lanes.load(simd, mesh.inv_mass);
            // As in `line`, a particle at an end counts half; only the end at the start of a chain is known here.
            lightest = lightest.max(if k == 0 { w * 0.5 } else { w });
            block
                .position
                .store(k * n, lanes.load_points(simd, mesh.position));
            block.inv_mass.store::<S>(k * n, w);
            if let Some(normal) = mesh.normal {
                block.normal.store(k * n, lanes.load_points(simd, normal));
            }
            if let (true, Some(pressed)) = (BODIES, mesh.pressed) {
                block.pressed.store::<S>(k * n, lanes.load(simd, pressed));
            }
        }
        let edges = MeshLines {
            rest_length: &mesh.rest_length[start..batch.slots.end],
            scale: &chains.scale[start..batch.slots.end],
            stretch,
            stride: LANES,
        };
        let bears = quarter / lightest;
        let lines = block.lines(m, n, mesh.give);
        let closing = batch.closing.as_ref().map(|all| &all[first..first + n]);
        if BODIES {
            solve_lines::<S, PRESSED>(simd, lines, edges, bears, closing, factors);
        } else if mesh.normal.is_some() {
            solve_lines::<S, TOUCHING>(simd, lines, edges, bears, closing, factors);
        } else {
            solve_lines::<S, FREE>(simd, lines, edges, bears, closing, factors);
        }
        for k in 0..m {
            let moved: V3<S> = block.position.load(simd, k * n);
            let lanes = Lanes::of_link::<S>(mesh.fabric, &chains.particle, start, k);
            lanes.store_points(mesh.position, moved);
            if let (true, Some(pressed)) = (BODIES, mesh.pressed) {
                lanes.store::<S>(pressed, block.pressed.load(simd, k * n));
            }
        }
    }
}

/// Solves open chains, or rings and open chains.
#[inline(always)]
fn solve_lines<S: Simd, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    edges: MeshLines,
    bears: S::f32s,
    closing: Option<&[u32]>,
    factors: Shared,
) {
    if let Some(closing) = closing {
        // A function of its own: few meshes have any rings.
        simd.vectorize(
            #[inline(always)]
            || ring::solve::<S, _, CONTACT>(simd, lines, edges, bears, closing, factors),
        );
    } else {
        line::solve::<S, _, CONTACT>(simd, lines, edges, bears, factors);
    }
}

/// Projects the springs across the threads to these lengths \[m\]. `alpha_tilde` is that of a spring whose scale is 1 [1/kg].
///
/// # Panics
/// When a particle is not below the number of particles.
pub fn solve_shear(springs: &Springs, rest_length: &[f32], alpha_tilde: f32, all: &mut [Packed]) {
    let least = Vec4::splat(HEAVIEST);
    let springs = springs.ends.iter().zip(rest_length).zip(&springs.scale);
    for ((ends, &length), &scale) in springs {
        let ends = ends.map(|i| i as usize);
        let [a, b] = ends.map(|i| Vec4::from_array(all[i]));
        let l2 = Vec4::splat(length * length);
        let alpha = Vec4::splat(scale * alpha_tilde);
        let d = b - a;
        let q = squared(d);
        let excess = q - l2;
        let [w_a, w_b] = [a, b].map(inv_mass);
        // As for bending: see `line`.
        let w = w_a + w_b;
        let w = (w * 0.5 + alpha).max(w).max(least);
        let push = of_space((excess + excess) / ((q * 3.0 + l2) * w) * d);
        all[ends[0]] = (a + w_a * push).to_array();
        all[ends[1]] = (b - w_b * push).to_array();
    }
}

/// Internal viscosity: neighbours exchange momentum in proportion to the difference of their velocities x − x⁻, after the rigid motion of
/// the whole was subtracted; x⁻ moves. The rounding error of x⁻ is added to `lost` \[m\], so that momentum is kept. `viscosity` is the
/// viscosity times the time \[m²\], `areal_density` in kg/m².
///
/// # Panics
/// When there are not as many particles as the fabric has.
pub fn exchange(
    fabric: &Fabric,
    position: &Points,
    previous: &mut Points,
    lost: &mut Points,
    inv_masses: &[f32],
    motion: RigidMotion,
    viscosity: f32,
    areal_density: f32,
) {
    let n = fabric.particles;
    assert!(
        position.has(n) && previous.has(n) && lost.has(n) && inv_masses.len() >= n,
        "a mesh of {n} particles"
    );
    with_scratch(8 * n, |scratch| {
        // Velocity of each particle, and the momentum that it gets.
        let moving = scratch.as_chunks_mut::<8>().0;
        for axis in 0..3 {
            // The two other axes, in cyclic order.
            let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
            let [x, y, z] = [axis, next, last].map(|k| [&position.x, &position.y, &position.z][k]);
            let before = [&previous.x, &previous.y, &previous.z][axis];
            let [moved, turn_y, turn_z] = [
                motion.displacement[axis],
                motion.rotation[next],
                motion.rotation[last],
            ];
            let [center_y, center_z] = [motion.center[next], motion.center[last]];
            let places = x.iter().zip(y).zip(z).zip(before);
            for ((((x, y), z), before), moving) in places.zip(&mut *moving) {
                let rigid = moved + (turn_y * (z - center_z) - turn_z * (y - center_y));
                moving[axis] = x - before - rigid;
            }
        }
        for moving in &mut *moving {
            moving[3..].fill(0.0);
        }
        for exchange in &fabric.exchanges {
            let [a, b] = exchange.ends.map(|i| i as usize);
            let conductance = areal_density * exchange.weight * viscosity.min(exchange.limit);
            let halves = |i: usize| {
                let [v, momentum] = [&moving[i][..4], &moving[i][4..]];
                [Vec4::from_slice(v), Vec4::from_slice(momentum)]
            };
            let [[v_a, of_a], [v_b, of_b]] = [halves(a), halves(b)];
            let flow = conductance * (v_b - v_a);
            (of_a + flow).write_to_slice(&mut moving[a][4..]);
            (of_b - flow).write_to_slice(&mut moving[b][4..]);
        }
        let axes = [
            (&mut previous.x, &mut lost.x),
            (&mut previous.y, &mut lost.y),
            (&mut previous.z, &mut lost.z),
        ];
        for (axis, (previous, lost)) in axes.into_iter().enumerate() {
            let some = previous.iter_mut().zip(lost).zip(inv_masses);
            for (((previous, lost), w), moving) in some.zip(&*moving) {
                let change = moving[4 + axis] * w;
                let before = *previous;
                *previous = before - change;
                *lost += change - (before - *previous);
            }
        }
    });
}
