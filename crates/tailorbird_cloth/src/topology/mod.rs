//! What is computed once from the rest shape: particles, triangles, constraints. Immutable, shared.

pub mod chains;
pub mod coloring;
pub mod constraints;
pub mod edges;
pub mod fabric;
pub mod geodesic;
pub mod grid;
pub mod hinges;
pub mod lattice;
pub mod mesh_edges;
pub mod order;
pub mod recognize;
#[cfg(test)]
pub(crate) mod test_meshes;
pub mod weave;
pub mod weld;

use std::{
    ops::Deref,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec3};
use bevy_reflect::prelude::*;

use crate::{cloth::ClothShape, error::ClothErrorKind, memory::heap, validate::check_shape};
use constraints::{ConstraintFamily, DistanceConstraints};
use fabric::Fabric;
use hinges::HingeConstraints;
use lattice::Lattice;
use order::ParticleOrder;

/// The [`Topology`] of this cloth, shared. Written by [`build_topology`](crate::build::build_topology) alone; empty until then.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTopology(#[reflect(ignore)] pub(crate) Arc<Topology>);

impl Deref for ClothTopology {
    type Target = Topology;

    fn deref(&self) -> &Topology {
        &self.0
    }
}

/// What is computed once from the rest shape. Particles are in storage order throughout.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Different for each topology that was ever built; 0 is the empty one. What is derived from a topology is
    /// rebuilt when this changes.
    pub revision: u64,
    /// The order in which the particles are stored.
    pub order: ParticleOrder,
    /// Where the particles lie at rest, in the cloth's frame, scale included \[m\].
    pub rest_positions: Vec<Vec3>,
    /// Columns and rows, where the cloth is a grid.
    pub grid: Option<UVec2>,
    /// Where the particles lie in columns and rows at equal spacing.
    pub lattice: Option<Lattice>,
    /// What holds it together where they do not.
    pub fabric: Option<Fabric>,
    /// What resists bending, but in a flat lattice.
    pub hinges: HingeConstraints,
    /// Whether the particles lie in one plane, nowhere on top of each other.
    pub flat: bool,
    /// Particles at the corners of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle which one of the source it is.
    pub source_triangles: Vec<u32>,
    /// For each vertex of the source the particle that moves it.
    pub particle_of_vertex: Vec<u32>,
    /// The scale that is part of `rest_positions`.
    pub scale: Vec3,
    /// Area of each triangle at rest \[m²\].
    pub triangle_areas: Vec<f32>,
    /// A third of the area of the triangles around each particle, in a lattice a quarter of the cells around it \[m²\].
    pub areas: Vec<f32>,
    /// The springs, in batches that share no particle.
    pub constraints: DistanceConstraints,
    /// Particles joined to each particle by an edge.
    pub neighbors: Neighbors,
    /// What was left out.
    pub dropped: Vec<ClothErrorKind>,
}

/// For each particle the particles at the other ends of its edges.
#[derive(Clone, Debug, Default)]
pub struct Neighbors {
    /// Where the list of each particle starts in `particles`; one more than there are particles.
    offsets: Vec<u32>,
    particles: Vec<u32>,
}

impl Neighbors {
    fn new(particles: usize, edges: impl Iterator<Item = [u32; 2]> + Clone) -> Self {
        let mut offsets = vec![0u32; particles + 1];
        for [a, b] in edges.clone() {
            offsets[a as usize + 1] += 1;
            offsets[b as usize + 1] += 1;
        }
        for i in 0..particles {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut list = vec![0; offsets[particles] as usize];
        for [a, b] in edges {
            for (from, to) in [(a, b), (b, a)] {
                list[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        Self {
            offsets,
            particles: list,
        }
    }

    /// The neighbours of one particle; none where the particle is out of range.
    pub fn of(&self, particle: u32) -> &[u32] {
        let i = particle as usize;
        match (self.offsets.get(i), self.offsets.get(i + 1)) {
            (Some(&start), Some(&end)) => &self.particles[start as usize..end as usize],
            _ => &[],
        }
    }
}

static REVISION: AtomicU64 = AtomicU64::new(1);

impl Topology {
    /// Builds the topology of a shape that is scaled by `scale`.
    ///
    /// # Errors
    /// What is wrong with the shape or the scale. Degenerate and duplicate triangles are left out and listed in
    /// [`Topology::dropped`].
    pub fn build(shape: &ClothShape, scale: Vec3) -> Result<Self, ClothErrorKind> {
        check_shape(shape)?;
        if !scale.is_finite() || scale.to_array().contains(&0.0) {
            return Err(ClothErrorKind::Scale { value: scale });
        }
        let mut topology = match shape {
            ClothShape::Grid { resolution, .. } => {
                let rest = shape
                    .rest_positions()
                    .into_iter()
                    .map(|p| p * scale)
                    .collect();
                grid::build(rest, *resolution)
            }
            ClothShape::Mesh {
                positions,
                indices,
                weld_distance,
            } => edges::build(positions, indices, *weld_distance, scale)?,
        };
        topology.revision = REVISION.fetch_add(1, Ordering::Relaxed);
        topology.scale = scale;
        topology.measure_areas();
        Ok(topology)
    }

    /// The number of particles.
    pub fn particles(&self) -> usize {
        self.rest_positions.len()
    }

    /// What a grid takes on the heap, shared by all clones \[byte\]; what only meshes have is not counted.
    pub fn memory_bytes(&self) -> usize {
        let constraints = &self.constraints;
        heap(&self.rest_positions)
            + heap(&self.triangles)
            + heap(&self.source_triangles)
            + heap(&self.particle_of_vertex)
            + heap(&self.triangle_areas)
            + heap(&self.areas)
            + heap(&constraints.ends)
            + heap(&constraints.rest_lengths)
            + heap(&constraints.batches)
            + heap(&self.neighbors.offsets)
            + heap(&self.neighbors.particles)
            + heap(&self.dropped)
    }

    /// The ends and rest lengths \[m\] of the edges that hardly stretch: those along the threads.
    pub fn stretch_edges(&self) -> Vec<([u32; 2], f32)> {
        self.fabric.as_ref().map_or_else(
            || self.constraints.family(ConstraintFamily::Stretch).collect(),
            |fabric| fabric.chains().edges().collect(),
        )
    }

    /// Mean area for each particle \[m²\].
    pub fn cell_area(&self) -> f32 {
        self.triangle_areas.iter().sum::<f32>() / self.particles().max(1) as f32
    }

    fn measure_areas(&mut self) {
        self.areas = vec![0.0; self.particles()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| self.rest_positions[i as usize]);
            let area = 0.5 * (b - a).cross(c - a).length();
            self.triangle_areas.push(area);
            for &i in triangle {
                self.areas[i as usize] += area / 3.0;
            }
        }
        // However its cells are cut.
        if let Some(lattice) = self.lattice {
            let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
            let quarter = 0.25 * lattice.spacing.x * lattice.spacing.y;
            let beside = |at: usize, len: usize| if at == 0 || at + 1 == len { 1.0 } else { 2.0 };
            for (i, area) in self.areas.iter_mut().enumerate() {
                *area = quarter * beside(i % columns, columns) * beside(i / columns, rows);
            }
        }
    }
}
