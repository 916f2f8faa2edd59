//! Repair of a mesh: from the triangles of the source to those that can be simulated.

use std::collections::{HashMap, hash_map::Entry};

use bevy_math::{Vec2, Vec3};

use super::{
    mesh_edges::MeshEdges,
    orientation::Orientation,
    pieces::pieces,
    report::{ClothMeshReport, Island},
    weld::weld,
};
use crate::error::ClothShapeError;

/// Ratio of a triangle's area to the square of its longest edge below which it counts as degenerate.
const DEGENERATE: f32 = 1e-6;

/// Length of a triangle's longest edge \[m\] below which it counts as degenerate.
const SHORTEST: f32 = 1e-6;

/// A triangle of the mesh that has the three corners of an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleCopy {
    /// Index of the copy in the mesh.
    pub source: u32,
    /// Triangle that is simulated.
    pub triangle: u32,
    /// True if the copy faces the other way.
    pub back: bool,
}

/// A mesh that can be simulated. Particles are in the order of the first vertex of each.
#[derive(Clone, Debug, Default)]
pub struct Repaired {
    /// Positions of the particles, in the entity's own space \[m\].
    pub positions: Vec<Vec3>,
    /// Particle of each vertex. For an isolated vertex it is a particle of its triangle, else the first.
    pub particle_of_vertex: Vec<u32>,
    /// Vertices of no triangle with an area, ascending.
    pub isolated: Vec<u32>,
    /// Particles at the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Index of each triangle in the mesh.
    pub source_triangles: Vec<u32>,
    /// Triangles of the mesh that are turned around, and their copies, ascending.
    pub turned: Vec<u32>,
    /// Triangles of the mesh that are there twice, ascending.
    pub copies: Vec<TriangleCopy>,
    /// Edges of `triangles`.
    pub edges: MeshEdges,
    /// Findings.
    pub report: ClothMeshReport,
}

impl Repaired {
    /// Texture coordinates at the corners of each triangle, of a mesh with these indices and these coordinates of its vertices.
    pub fn corner_uvs(&self, indices: &[u32], uvs: &[Vec2]) -> Vec<[Vec2; 3]> {
        let source = self.triangles.iter().zip(&self.source_triangles);
        let corners = source.map(|(particles, source)| {
            let vertices = &indices[3 * *source as usize..][..3];
            particles.map(|particle| {
                let is_there = |v: &&u32| self.particle_of_vertex[**v as usize] == particle;
                let vertex = vertices.iter().find(is_there);
                vertex.map_or(Vec2::NAN, |vertex| uvs[*vertex as usize])
            })
        });
        corners.collect()
    }

    /// Welds the vertices that are no further apart than `weld_distance` \[m\], leaves out triangles that are degenerate (in the
    /// entity's own space or scaled) or there already, and turns around those that face the wrong way.
    ///
    /// The indices of the particles do not depend on the scale.
    ///
    /// # Panics
    /// When an index is not below the number of positions.
    pub fn new(positions: &[Vec3], indices: &[u32], weld_distance: f32, scale: Vec3) -> Self {
        let welded = weld(positions, weld_distance);
        let mut repaired = Self {
            positions: welded.positions,
            particle_of_vertex: welded.particle_of_vertex,
            ..Self::default()
        };
        repaired.report.vertices = positions.len();
        repaired.report.triangles = indices.len() / 3;
        repaired.find_welded(positions);
        let used = repaired.take_triangles(indices, scale);
        repaired.leave_out_isolated(positions, indices, &used);
        repaired.edges = MeshEdges::new(repaired.positions.len(), &repaired.triangles);
        repaired.turn();
        repaired.find_edges();
        repaired.find_islands();
        repaired
    }

    /// Weights of the particles, from those of the vertices.
    pub fn weights(&self, weight_of_vertex: &[f32]) -> Vec<f32> {
        let mut weight_of_vertex = weight_of_vertex.to_vec();
        for &vertex in &self.isolated {
            if let Some(weight) = weight_of_vertex.get_mut(vertex as usize) {
                *weight = 0.0;
            }
        }
        let particles = self.positions.len();
        of_particles(particles, &self.particle_of_vertex, &weight_of_vertex)
    }

    /// Triangles and vertices that were left out of the simulation though they were meant to be part of it.
    pub(super) fn dropped(&self) -> Vec<ClothShapeError> {
        let (degenerate, duplicate) = (self.report.degenerate, self.report.duplicate);
        let mut dropped = Vec::new();
        if degenerate.is_some() {
            dropped.push(ClothShapeError::DegenerateTriangles {
                count: degenerate.count,
                first: degenerate.first as usize,
            });
        }
        if duplicate.is_some() {
            dropped.push(ClothShapeError::DuplicateTriangles {
                count: duplicate.count,
                first: duplicate.first as usize,
            });
        }
        dropped
    }

    fn middle(&self, triangle: [u32; 3]) -> Vec3 {
        let sum: Vec3 = triangle.iter().map(|i| self.positions[*i as usize]).sum();
        sum / 3.0
    }

    fn find_welded(&mut self, positions: &[Vec3]) {
        let mut next = 0;
        for (vertex, &particle) in self.particle_of_vertex.iter().enumerate() {
            if particle < next {
                let at = || positions[vertex];
                self.report.welded.add(vertex as u32, at);
            } else {
                next = particle + 1;
            }
        }
    }

    /// Fills in the triangles, and returns which particles they use.
    fn take_triangles(&mut self, indices: &[u32], scale: Vec3) -> Vec<bool> {
        let mut report = std::mem::take(&mut self.report);
        let mut used = vec![false; self.positions.len()];
        let mut seen: HashMap<[u32; 3], u32> = HashMap::with_capacity(indices.len() / 3);
        for (source, corners) in indices.as_chunks::<3>().0.iter().enumerate() {
            let source = source as u32;
            let triangle = corners.map(|v| self.particle_of_vertex[v as usize]);
            let places = triangle.map(|i| self.positions[i as usize]);
            let flat = is_degenerate(places, 0.0);
            if !flat {
                triangle.iter().for_each(|i| used[*i as usize] = true);
            }
            if flat || is_degenerate(places.map(|p| p * scale), SHORTEST) {
                report.degenerate.add(source, || self.middle(triangle));
                continue;
            }
            let mut sorted = triangle;
            sorted.sort_unstable();
            match seen.entry(sorted) {
                Entry::Vacant(entry) => {
                    entry.insert(self.triangles.len() as u32);
                    self.triangles.push(triangle);
                    self.source_triangles.push(source);
                }
                Entry::Occupied(entry) => {
                    let first = *entry.get();
                    let back = !is_rotated(triangle, self.triangles[first as usize]);
                    let finding = if back {
                        &mut report.backs
                    } else {
                        &mut report.duplicate
                    };
                    finding.add(source, || self.middle(triangle));
                    self.copies.push(TriangleCopy {
                        source,
                        triangle: first,
                        back,
                    });
                }
            }
        }
        self.report = report;
        used
    }

    /// Leaves out the particles that are not `used`, and renumbers the others.
    fn leave_out_isolated(&mut self, positions: &[Vec3], indices: &[u32], used: &[bool]) {
        for (vertex, &particle) in self.particle_of_vertex.iter().enumerate() {
            if !used[particle as usize] {
                self.report
                    .isolated
                    .add(vertex as u32, || positions[vertex]);
                self.isolated.push(vertex as u32);
            }
        }
        if !self.report.isolated.is_some() {
            self.report.particles = self.positions.len();
            return;
        }
        let mut number = vec![u32::MAX; used.len()];
        let in_use = number.iter_mut().zip(used).filter(|(_, used)| **used);
        for (next, (number, _)) in (0..).zip(in_use) {
            *number = next;
        }
        // The vertices of slivers stay with the cloth, so that the area that these fill stays filled.
        let mut beside = vec![0; used.len()];
        for corners in indices.as_chunks::<3>().0 {
            let triangle = corners.map(|v| self.particle_of_vertex[v as usize] as usize);
            if let Some(&near) = triangle.iter().find(|i| used[**i]) {
                triangle.iter().for_each(|i| beside[*i] = number[near]);
            }
        }
        for particle in &mut self.particle_of_vertex {
            let i = *particle as usize;
            *particle = if used[i] { number[i] } else { beside[i] };
        }
        for i in self.triangles.iter_mut().flatten() {
            *i = number[*i as usize];
        }
        let mut used = used.iter();
        self.positions
            .retain(|_| used.next().copied().unwrap_or_default());
        self.report.particles = self.positions.len();
    }

    /// Makes the triangles face one way.
    fn turn(&mut self) {
        let Orientation { turned, one_sided } = Orientation::new(&self.edges, &self.triangles);
        for &edge in &one_sided {
            let (source, at) = self.place_of_edge(edge);
            self.report.one_sided.add(source, || at);
        }
        for &t in &turned {
            let triangle = &mut self.triangles[t as usize];
            triangle.swap(1, 2);
            let (triangle, source) = (*triangle, self.source_triangles[t as usize]);
            let at = self.middle(triangle);
            self.report.turned.add(source, || at);
            self.turned.push(source);
        }
        if turned.is_empty() {
            return;
        }
        self.edges = MeshEdges::new(self.positions.len(), &self.triangles);
        let with_copies = self
            .copies
            .iter()
            .filter(|copy| turned.binary_search(&copy.triangle).is_ok());
        self.turned.extend(with_copies.map(|copy| copy.source));
        self.turned.sort_unstable();
    }

    fn find_edges(&mut self) {
        for edge in 0..self.edges.len() as u32 {
            match self.edges.sides(edge).len() {
                1 => self.report.border_edges += 1,
                2 => {}
                _ => {
                    let (source, at) = self.place_of_edge(edge);
                    self.report.non_manifold.add(source, || at);
                }
            }
        }
    }

    /// First triangle of an edge, as the mesh numbers them, and the middle of the edge.
    fn place_of_edge(&self, edge: u32) -> (u32, Vec3) {
        let [a, b] = self.edges.ends[edge as usize].map(|i| self.positions[i as usize]);
        let first = self
            .edges
            .sides(edge)
            .iter()
            .min()
            .map_or(0, |side| side / 3);
        (self.source_triangles[first as usize], a.midpoint(b))
    }

    fn find_islands(&mut self) {
        let pieces = pieces(self.positions.len(), self.triangles.iter().copied());
        let mut island_of_piece = vec![u32::MAX; pieces.len()];
        for (t, &triangle) in self.triangles.iter().enumerate() {
            let island = &mut island_of_piece[pieces[triangle[0] as usize] as usize];
            if *island == u32::MAX {
                *island = self.report.islands.len() as u32;
                self.report.islands.push(Island {
                    triangles: 0,
                    first: self.source_triangles[t],
                    at: self.middle(triangle),
                });
            }
            self.report.islands[*island as usize].triangles += 1;
        }
    }
}

/// Returns whether a triangle has no area to speak of, or its longest edge is shorter than `shortest` \[m\].
fn is_degenerate([a, b, c]: [Vec3; 3], shortest: f32) -> bool {
    let longest = (b - a)
        .length_squared()
        .max((c - b).length_squared())
        .max((a - c).length_squared());
    let area = 0.5 * (b - a).cross(c - a).length();
    area.is_nan() || area <= DEGENERATE * longest || longest < shortest * shortest
}

/// Returns whether two triangles with the same corners name them in the same cyclic order.
fn is_rotated(a: [u32; 3], b: [u32; 3]) -> bool {
    (0..3).any(|k| [b[k], b[(k + 1) % 3], b[(k + 2) % 3]] == a)
}

#[cfg(test)]
#[path = "repair_tests.rs"]
mod tests;

/// Weights of particles from those of vertices, by the particle of each vertex: the greatest counts. Weights that are not numbers count as
/// 0.
fn of_particles(
    particles: usize,
    particle_of_vertex: &[u32],
    weight_of_vertex: &[f32],
) -> Vec<f32> {
    let mut weights = vec![0.0f32; particles];
    for (&particle, &weight) in particle_of_vertex.iter().zip(weight_of_vertex) {
        if let Some(most) = weights.get_mut(particle as usize) {
            *most = most.max(weight);
        }
    }
    weights
}
