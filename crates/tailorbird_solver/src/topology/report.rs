//! Findings in a mesh, and their places.

use std::fmt;

use bevy_math::Vec3;
use bevy_reflect::prelude::*;

/// Findings in the mesh of a cloth, collected when its [`Topology`](super::Topology) was built. Its `Display` is a line for each
/// finding.
///
/// | finding | treatment |
/// | --- | --- |
/// | [`welded`](Self::welded) | one particle moves all vertices at a place; each keeps its UV, colour and so on |
/// | [`isolated`](Self::isolated) | has no particle |
/// | [`degenerate`](Self::degenerate) | drawn, not simulated |
/// | [`duplicate`](Self::duplicate) | drawn, not simulated: the first one is |
/// | [`backs`](Self::backs) | drawn with the normal of its side, not simulated: the first one is |
/// | [`turned`](Self::turned) | turned around, so that front and back are told apart as by most triangles of the island |
/// | [`one_sided`](Self::one_sided) | simulated; the island (a Möbius strip) stays as it is, and at such an edge its front becomes its back: smooth normals cancel there, flat ones are right |
/// | [`non_manifold`](Self::non_manifold) | simulated; bending is resisted between the two triangles that lie flattest, then between the next two, and none that are folded by more than 60° or of more than eight |
/// | [`islands`](Self::islands) | simulated as one cloth |
#[derive(Clone, Debug, Default, PartialEq, Reflect)]
pub struct ClothMeshReport {
    /// Number of vertices of the mesh.
    pub vertices: usize,
    /// Number of triangles of the mesh.
    pub triangles: usize,
    /// Number of particles of the cloth.
    pub particles: usize,
    /// Vertices that share the particle of an earlier one.
    pub welded: Finding,
    /// Vertices that belong to no triangle with an area.
    pub isolated: Finding,
    /// Triangles without area: of fewer than three particles, or with corners in a line, or smaller than a micrometre.
    pub degenerate: Finding,
    /// Triangles that have the corners of an earlier one, and face the same way.
    pub duplicate: Finding,
    /// Triangles that have the corners of an earlier one, and face the other way: the backs of double-sided faces.
    pub backs: Finding,
    /// Triangles that faced another way than most of their island.
    pub turned: Finding,
    /// Edges at which the triangles of an island without a front face opposite ways.
    pub one_sided: Finding,
    /// Edges of more than two triangles.
    pub non_manifold: Finding,
    /// Number of edges that belong to one triangle; a closed surface has none.
    pub border_edges: usize,
    /// Pieces that no particle joins, in the order of their first triangles.
    pub islands: Vec<Island>,
}

/// Number of occurrences of something, and the place of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct Finding {
    /// Number of occurrences.
    pub count: usize,
    /// First vertex or, for triangles and edges, first triangle, as the mesh numbers them.
    pub first: u32,
    /// Position of that vertex, or the middle of that triangle or edge, in the entity's own space \[m\].
    pub at: Vec3,
}

/// A piece of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct Island {
    /// Number of triangles.
    pub triangles: usize,
    /// First triangle of the piece, as the mesh numbers them.
    pub first: u32,
    /// Middle of that triangle, in the entity's own space \[m\].
    pub at: Vec3,
}

impl Finding {
    pub(super) fn add(&mut self, first: u32, at: impl FnOnce() -> Vec3) {
        if self.count == 0 {
            (self.first, self.at) = (first, at());
        }
        self.count += 1;
    }

    /// Returns whether it was found at all.
    pub fn is_some(&self) -> bool {
        self.count > 0
    }
}

impl ClothMeshReport {
    /// Returns whether the triangles are those of the mesh, unchanged, and form a surface with two sides.
    pub fn is_clean(&self) -> bool {
        let found = [
            self.degenerate,
            self.duplicate,
            self.backs,
            self.turned,
            self.one_sided,
            self.non_manifold,
        ];
        !found.iter().any(Finding::is_some)
    }
}

impl fmt::Display for ClothMeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} vertices and {} triangles became {} particles in {} pieces with {} border edges",
            self.vertices,
            self.triangles,
            self.particles,
            self.islands.len(),
            self.border_edges
        )?;
        let findings = [
            (self.welded, "welded vertices", "vertex"),
            (self.isolated, "isolated vertices", "vertex"),
            (self.degenerate, "triangles without area", "triangle"),
            (self.duplicate, "triangles there twice", "triangle"),
            (self.backs, "backs of double-sided faces", "triangle"),
            (self.turned, "triangles turned around", "triangle"),
            (self.one_sided, "edges where front meets back", "triangle"),
            (
                self.non_manifold,
                "edges of more than two triangles",
                "triangle",
            ),
        ];
        for (Finding { count, first, at }, what, of) in findings {
            if count > 0 {
                write!(f, "\n{count} {what}, the first at {of} {first}, {at} m")?;
            }
        }
        for island in self.islands.iter().skip(1).take(8) {
            write!(
                f,
                "\na piece of {} triangles from triangle {}, {} m",
                island.triangles, island.first, island.at
            )?;
        }
        Ok(())
    }
}
