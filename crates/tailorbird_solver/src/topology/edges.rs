//! Triangle meshes: edges, diagonals and the springs across them.

use std::collections::HashSet;

use bevy_math::{Vec2, Vec3};

use super::{
    Topology,
    chains::{Chains, inverse},
    constraints::{ConstraintFamily, DistanceConstraints},
    fabric::Fabric,
    groups::Groups,
    hinges::HingeConstraints,
    lattice::Lattice,
    layout::{Layout, SheetLayout},
    mesh_edges::MeshEdges,
    order::ParticleOrder,
    order::Stored,
    recognize::Recognized,
    repair::Repaired,
    weave::Weave,
};
use crate::error::ClothShapeError;

/// Tolerance of a plane mesh: distance of a particle from the plane, as a part of the square root of twice the area.
const FLAT: f32 = 1e-4;

/// Least ratio of the square of a triangle's longest edge to the sum of the other two squares for that edge to be a diagonal. 1 is a right
/// angle.
const DIAGONAL: f32 = 0.9;

/// Builds the topology of a triangle mesh. Areas and revision are left to the caller.
pub(super) fn build(
    positions: &[Vec3],
    indices: &[u32],
    uvs: &[Vec2],
    weld_distance: f32,
    scale: Vec3,
) -> Result<Topology, ClothShapeError> {
    let repaired = Repaired::new(positions, indices, weld_distance, scale);
    if repaired.triangles.is_empty() {
        return Err(ClothShapeError::NoTriangles {
            vertices: positions.len(),
            triangles: 0,
        });
    }
    let uvs = (!uvs.is_empty()).then(|| repaired.corner_uvs(indices, uvs));
    let mut topology = Topology {
        dropped: repaired.dropped(),
        rest_positions: repaired.positions.iter().map(|p| *p * scale).collect(),
        particle_of_vertex: repaired.particle_of_vertex,
        triangles: repaired.triangles,
        turned: repaired.turned,
        copies: repaired.copies,
        report: repaired.report,
        ..Default::default()
    };
    if topology.triangles.len() * 3 < indices.len() {
        topology.source_triangles = repaired.source_triangles;
    }
    arrange(&mut topology, &repaired.edges, uvs.as_deref());
    Ok(topology)
}

/// The springs of the triangles, in batches that share no particle.
pub(super) fn constraints(triangles: &[[u32; 3]], rest_positions: &[Vec3]) -> DistanceConstraints {
    let mut constraints = DistanceConstraints::default();
    let springs = springs(triangles, rest_positions);
    for (family, pairs) in ConstraintFamily::ALL.into_iter().zip(&springs) {
        constraints.push_colored(family, rest_positions, pairs);
    }
    constraints
}

/// Neighbours of each particle by an edge or a diagonal.
pub(super) fn neighbors(triangles: &[[u32; 3]], rest_positions: &[Vec3]) -> Groups<Stored> {
    let [_, shear, stretch] = springs(triangles, rest_positions);
    let edges = stretch.iter().chain(&shear);
    let both = edges.flat_map(|&[a, b]| [(a, Stored(b)), (b, Stored(a))]);
    Groups::new(rest_positions.len(), both)
}

/// Looks for a grid, else for threads; brings the particles into the order that suits the solver.
fn arrange(topology: &mut Topology, edges: &MeshEdges, uvs: Option<&[[Vec2; 3]]>) {
    topology.flat = is_flat(&topology.rest_positions, &topology.triangles);
    let (rest, triangles) = (&topology.rest_positions, &topology.triangles);
    if let Some(grid) = Recognized::detect(rest, triangles, edges, uvs) {
        topology.layout = Layout::Sheet(SheetLayout::from(Lattice {
            columns: grid.columns as u32,
            rows: grid.rows as u32,
            spacing: grid.spacing,
        }));
        reorder(topology, grid.order);
    } else {
        let mut weave = Weave::new(rest, triangles, edges, uvs);
        let (chains, order) = Chains::build(rest, &weave);
        weave.renumber(&inverse(&order));
        reorder(topology, order);
        let (rest, triangles) = (&topology.rest_positions, &topology.triangles);
        let fabric = Fabric::new(rest, triangles, chains, &weave);
        topology.layout = Layout::Mesh(Box::new(fabric));
    }
    if !(topology.flat && topology.lattice().is_some()) {
        topology.hinges = HingeConstraints::new(&topology.triangles, &topology.rest_positions);
    }
}

/// Stores the particle with the original index `order[i]` as `i`.
fn reorder(topology: &mut Topology, order: Vec<u32>) {
    let number = inverse(&order);
    let rest = &topology.rest_positions;
    topology.rest_positions = order.iter().map(|i| rest[*i as usize]).collect();
    let named = topology.triangles.iter_mut().flatten();
    for i in named.chain(&mut topology.particle_of_vertex) {
        *i = number[*i as usize];
    }
    topology.order = ParticleOrder::new(order);
}

/// Returns whether all triangles lie in one plane and face one way.
fn is_flat(rest_positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let corners = |t: &[u32; 3]| t.map(|i| rest_positions[i as usize]);
    let areas = triangles.iter().map(|t| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a)
    });
    let largest = |n: Vec3, m: Vec3| {
        if m.length_squared() > n.length_squared() {
            m
        } else {
            n
        }
    };
    let normal = areas.clone().fold(Vec3::ZERO, largest).normalize_or_zero();
    let heights = triangles
        .iter()
        .flatten()
        .map(|i| rest_positions[*i as usize].dot(normal));
    let (low, high) = heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| {
        (low.min(height), high.max(height))
    });
    let size = areas.clone().map(Vec3::length).sum::<f32>().sqrt();
    high - low <= FLAT * size && areas.into_iter().all(|area| area.dot(normal) > 0.0)
}

/// One side of an edge: the edge with the lower particle first, the opposite corner, and a flag: the edge is the triangle's diagonal.
type Side = ([u32; 2], u32, bool);

/// Pairs of particles joined by springs, by family in the order of [`ConstraintFamily::ALL`].
///
/// An edge that is the longest of a right-angled or obtuse triangle on every side is a diagonal: it and the other diagonal of its quad
/// resist shear. Every other edge resists stretch, and the corners opposite to it are joined against bending.
fn springs(triangles: &[[u32; 3]], rest_positions: &[Vec3]) -> [Vec<[u32; 2]>; 3] {
    let mut sides: Vec<Side> = Vec::with_capacity(triangles.len() * 3);
    for &[a, b, c] in triangles {
        for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            let [p, q, o] = [from, to, opposite].map(|i| rest_positions[i as usize]);
            let others = (p - o).length_squared() + (q - o).length_squared();
            let diagonal = (q - p).length_squared() >= DIAGONAL * others;
            sides.push(([from.min(to), from.max(to)], opposite, diagonal));
        }
    }
    sides.sort_unstable();

    let mut joined: HashSet<[u32; 2]> = sides.iter().map(|side| side.0).collect();
    let [mut bend, mut shear, mut stretch] = [const { Vec::new() }; 3];
    for sides in sides.chunk_by(|a, b| a.0 == b.0) {
        let edge = sides[0].0;
        let diagonal = sides.len() > 1 && sides.iter().all(|side| side.2);
        if diagonal { &mut shear } else { &mut stretch }.push(edge);
        for pair in sides.windows(2) {
            let across = [pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1)];
            if across[0] != across[1] && joined.insert(across) {
                if diagonal { &mut shear } else { &mut bend }.push(across);
            }
        }
    }
    [bend, shear, stretch]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::ClothShape;

    /// A sheet of 3 × 3 vertices, one unit apart, whose cells are cut along the same diagonal.
    fn sheet() -> (Vec<Vec3>, Vec<u32>) {
        let positions = (0..9)
            .map(|i| Vec3::new((i % 3) as f32, -((i / 3) as f32), 0.0))
            .collect();
        let indices = [0u32, 1, 3, 4]
            .into_iter()
            .flat_map(|v| [v, v + 3, v + 4, v, v + 4, v + 1])
            .collect();
        (positions, indices)
    }

    fn count(topology: &Topology, family: ConstraintFamily) -> usize {
        topology.constraints().family(family).count()
    }

    #[test]
    fn diagonals_of_a_triangulated_grid_are_shear_springs() {
        let (positions, indices) = sheet();
        let topology =
            Topology::build(&ClothShape::mesh(positions, indices), Vec3::ONE).expect("valid");
        assert_eq!(count(&topology, ConstraintFamily::Stretch), 12);
        assert_eq!(count(&topology, ConstraintFamily::Shear), 8);
        assert_eq!(count(&topology, ConstraintFamily::Bend), 4);
        let total: f32 = topology.areas().sum();
        assert!((total - 4.0).abs() < 1e-6);
    }

    #[test]
    fn broken_triangles_are_dropped_and_counted() {
        let (positions, mut indices) = sheet();
        let whole = indices.len() / 3;
        indices.extend([0, 0, 1, 0, 1, 2, 4, 0, 3]);
        let topology =
            Topology::build(&ClothShape::mesh(positions, indices), Vec3::ONE).expect("valid");
        assert_eq!(topology.triangles().len(), whole);
        assert!(topology.source_triangles().eq(0..whole as u32));
        assert_eq!(
            topology.dropped,
            [
                ClothShapeError::DegenerateTriangles { count: 2, first: 8 },
                ClothShapeError::DuplicateTriangles {
                    count: 1,
                    first: 10
                },
            ]
        );
    }

    #[test]
    fn a_mesh_of_nothing_but_slivers_is_refused() {
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        let error =
            Topology::build(&ClothShape::mesh(line, [0, 1, 2]), Vec3::ONE).expect_err("degenerate");
        assert_eq!(
            error,
            ClothShapeError::NoTriangles {
                vertices: 3,
                triangles: 0
            }
        );
    }
}
