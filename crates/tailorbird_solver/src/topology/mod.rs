//! The topology of a cloth, computed once from its rest shape: particles, triangles, constraints. Immutable, shared.

pub mod alive;
pub mod chains;
pub mod coloring;
pub mod constraints;
pub mod copies;
pub mod edges;
pub mod fabric;
pub mod geodesic;
pub mod grid;
pub mod hinges;
pub mod lattice;
pub mod layout;
pub mod mesh_edges;
pub mod neighbors;
pub mod order;
mod orientation;
mod pieces;
pub mod recognize;
pub mod repair;
pub mod report;
#[cfg(test)]
pub mod test_meshes;
pub mod triangles;
pub mod weave;
pub mod weld;

use std::sync::OnceLock;

use bevy_math::{UVec2, Vec3};

use crate::{
    error::ClothShapeError,
    memory::heap,
    shape::{ClothShape, check_positions},
};
use constraints::DistanceConstraints;
use fabric::Fabric;
use hinges::HingeConstraints;
use lattice::Lattice;
use layout::Layout;
use neighbors::{NeighborLists, Neighbors};
use order::{ParticleOrder, Stored};
use repair::TriangleCopy;
use report::ClothMeshReport;
use triangles::Triangles;

/// Topology of a cloth, computed once from its rest shape. Particles are in storage order throughout.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Equal for equal shapes at equal scales, in every process; 0 is the empty one. Everything that is derived from a topology is
    /// rebuilt when this changes.
    pub revision: u64,
    /// The order in which the particles are stored.
    pub order: ParticleOrder,
    /// Rest positions in the cloth's frame, scale included \[m\].
    pub rest_positions: Vec<Vec3>,
    /// Layout of the particles: a sheet or a mesh.
    pub layout: Layout,
    /// Hinges, which resist bending; none in a flat sheet, whose lines do.
    pub hinges: HingeConstraints,
    /// True if the particles lie in one plane, nowhere on top of each other.
    pub flat: bool,
    /// The triangles of a mesh; none of a grid.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle which one of the source it is; empty where they are the same.
    source_triangles: Vec<u32>,
    /// The triangles of the source that are turned around, ascending.
    turned: Vec<u32>,
    /// The triangles of the source that are there twice.
    copies: Vec<TriangleCopy>,
    /// For each vertex of the source the particle that moves it; empty for grids, where they are the same.
    particle_of_vertex: Vec<u32>,
    /// The scale that is part of `rest_positions`.
    pub scale: Vec3,
    /// Area of each triangle of a mesh at rest \[m²\]; none of a grid.
    pub triangle_areas: Vec<f32>,
    /// A third of the area of the triangles around each particle \[m²\]; none of a sheet without copies.
    areas: Vec<f32>,
    /// For each particle beyond those of the rest shape the one that it is a copy of.
    origins: Vec<u32>,
    /// Mean area for each particle \[m²\].
    cell_area: f32,
    /// Made when they are asked for.
    constraints: OnceLock<DistanceConstraints>,
    /// Made when they are asked for; never for a lattice.
    neighbors: OnceLock<NeighborLists>,
    /// Errors of the parts that were left out.
    pub dropped: Vec<ClothShapeError>,
    /// Findings in a mesh; empty for a grid.
    pub report: ClothMeshReport,
}

impl Topology {
    /// Builds the topology of a shape that is scaled by `scale`.
    ///
    /// # Errors
    /// An invalid shape or scale. Faults of a mesh that can be repaired are, and are told in
    /// [`Topology::report`]; triangles that are left out are listed in [`Topology::dropped`] as well.
    pub fn build(shape: &ClothShape, scale: Vec3) -> Result<Self, ClothShapeError> {
        shape.check()?;
        if !scale.is_finite() || scale.to_array().contains(&0.0) {
            return Err(ClothShapeError::Scale { value: scale });
        }
        let mut topology = match shape {
            ClothShape::Grid { resolution, .. } => {
                let mut rest = shape.rest_positions();
                rest.iter_mut().for_each(|p| *p *= scale);
                grid::build(rest, *resolution)
            }
            ClothShape::Mesh {
                positions,
                indices,
                uvs,
                weld_distance,
            } => {
                check_positions(positions.iter().map(|p| *p * scale))?;
                edges::build(positions, indices, uvs, *weld_distance, scale)?
            }
        };
        topology.revision = shape.fingerprint(scale);
        topology.scale = scale;
        topology.measure_areas();
        Ok(topology)
    }

    /// The number of particles.
    pub fn particles(&self) -> usize {
        self.rest_positions.len()
    }

    /// Columns and rows, where particles lie in them.
    pub fn lattice(&self) -> Option<&Lattice> {
        match &self.layout {
            Layout::Sheet(sheet) => Some(&sheet.lattice),
            Layout::Mesh(_) => None,
        }
    }

    /// Chains and springs, where particles lie anywhere.
    pub fn fabric(&self) -> Option<&Fabric> {
        match &self.layout {
            Layout::Sheet(_) => None,
            Layout::Mesh(fabric) => Some(fabric),
        }
    }

    /// Columns and rows of a grid, whose cells are cut in one way: not of a mesh that turned out to be a sheet.
    pub fn grid_lattice(&self) -> Option<&Lattice> {
        self.lattice().filter(|_| self.triangles.is_empty())
    }

    /// The resolution of a grid.
    pub fn grid(&self) -> Option<UVec2> {
        let size = |lattice: &Lattice| UVec2::new(lattice.columns, lattice.rows);
        self.grid_lattice().map(size)
    }

    /// Returns whether the shape is a grid: then vertices and particles are the same.
    pub fn is_grid(&self) -> bool {
        self.grid_lattice().is_some()
    }

    /// Particles at the corners of each triangle, counter-clockwise seen from the front.
    #[inline]
    pub fn triangles(&self) -> Triangles<'_> {
        match self.grid() {
            Some(size) => Triangles::of_grid(size),
            None => Triangles::of_list(&self.triangles),
        }
    }

    /// For each triangle which one of the source it is.
    pub fn source_triangles(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        let of = |triangle| self.source_triangles.get(triangle).copied();
        (0..self.triangles().len()).map(move |triangle| of(triangle).unwrap_or(triangle as u32))
    }

    /// The triangles of the source that are turned around, and the copies of those, ascending.
    pub fn turned_triangles(&self) -> &[u32] {
        &self.turned
    }

    /// The triangles of the source that have the corners of one before, ascending.
    pub fn copied_triangles(&self) -> &[TriangleCopy] {
        &self.copies
    }

    /// The particle that moves a vertex of the source.
    ///
    /// # Panics
    /// When the vertex is out of range.
    #[inline]
    pub fn particle_of_vertex(&self, vertex: usize) -> Stored {
        if self.is_grid() {
            assert!(
                vertex < self.original_particles(),
                "vertex {vertex} of a grid"
            );
            return Stored(vertex as u32);
        }
        Stored(self.particle_of_vertex[vertex])
    }

    /// For each vertex of the source the particle that moves it.
    pub fn particles_of_vertices(&self) -> impl ExactSizeIterator<Item = Stored> + '_ {
        let vertices = if self.is_grid() {
            self.original_particles()
        } else {
            self.particle_of_vertex.len()
        };
        (0..vertices).map(|vertex| self.particle_of_vertex(vertex))
    }

    /// Area of each triangle at rest \[m²\].
    pub fn triangle_areas(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        let cell = self.lattice().map_or(0.0, Lattice::cell_area);
        let of = |triangle| self.triangle_areas.get(triangle).copied();
        (0..self.triangles().len()).map(move |triangle| of(triangle).unwrap_or(0.5 * cell))
    }

    /// For each particle a third of the area of the triangles around it, in a lattice a quarter of the cells around it
    /// \[m²\].
    pub fn areas(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        let of = |particle| match (&self.layout, self.areas.get(particle)) {
            (_, Some(area)) => *area,
            // However its cells are cut.
            (Layout::Sheet(sheet), None) => sheet.lattice.area_of(particle),
            (Layout::Mesh(_), None) => 0.0,
        };
        (0..self.particles()).map(of)
    }

    /// Springs of the classic solver, in batches that share no particle. They are made at the first call.
    pub fn constraints(&self) -> &DistanceConstraints {
        self.constraints.get_or_init(|| match self.grid() {
            Some(size) => grid::constraints(size.x, size.y, &self.rest_positions),
            None => edges::constraints(&self.triangles, &self.rest_positions),
        })
    }

    /// Number of springs of [`Self::constraints`]. For a grid they are not made.
    pub fn constraint_count(&self) -> usize {
        match self.grid() {
            Some(size) => grid::constraint_count(size.x as usize, size.y as usize),
            None => self.constraints().len(),
        }
    }

    /// Particles joined to one by an edge or a diagonal; none where the particle is out of range.
    pub fn neighbors(&self, particle: Stored) -> Neighbors<'_> {
        if let Layout::Sheet(sheet) = &self.layout {
            return Neighbors::in_sheet(sheet, particle);
        }
        let lists = self
            .neighbors
            .get_or_init(|| edges::neighbors(&self.triangles, &self.rest_positions));
        Neighbors::Listed(lists.of(particle))
    }

    /// Memory on the heap by now \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.rest_positions)
            + heap(&self.triangles)
            + heap(&self.source_triangles)
            + heap(&self.particle_of_vertex)
            + heap(&self.triangle_areas)
            + heap(&self.areas)
            + heap(&self.origins)
            + self.layout.memory_bytes()
            + heap(&self.dropped)
            + heap(&self.turned)
            + heap(&self.copies)
            + heap(&self.report.islands)
            + self.order.memory_bytes()
            + self.hinges.memory_bytes()
            + self
                .constraints
                .get()
                .map_or(0, DistanceConstraints::memory_bytes)
            + self.neighbors.get().map_or(0, NeighborLists::memory_bytes)
    }

    /// The ends and rest lengths \[m\] of the edges that hardly stretch: those along the threads.
    pub fn stretch_edges(&self) -> Vec<([u32; 2], f32)> {
        let measured = |[a, b]: [u32; 2]| {
            let [p, q] = [a, b].map(|i| self.rest_positions[i as usize]);
            ([a, b], p.distance(q))
        };
        match &self.layout {
            Layout::Sheet(sheet) => sheet.edges().map(measured).collect(),
            Layout::Mesh(fabric) => fabric.chains().edges().collect(),
        }
    }

    /// Mean area for each particle \[m²\].
    pub fn cell_area(&self) -> f32 {
        self.cell_area
    }

    fn measure_areas(&mut self) {
        if !self.is_grid() {
            let area = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(|i| self.rest_positions[i as usize]);
                0.5 * (b - a).cross(c - a).length()
            };
            self.triangle_areas = self.triangles.iter().map(area).collect();
        }
        if self.lattice().is_none() {
            self.areas = vec![0.0; self.particles()];
            for (triangle, area) in self.triangles.iter().zip(&self.triangle_areas) {
                for &i in triangle {
                    self.areas[i as usize] += area / 3.0;
                }
            }
        }
        self.cell_area = self.triangle_areas().sum::<f32>() / self.particles().max(1) as f32;
    }
}
