//! The edges of a triangle mesh and the triangles on their sides.

use super::groups::Groups;

/// Number of triangles at one edge above which they do not count as adjacent.
pub(super) const MOST_SIDES: usize = 8;

/// The edges of a triangle mesh.
///
/// A *side* is one of the three directed edges of one triangle: side `3 t + s` runs from corner `s` of triangle `t` to
/// the next one.
#[derive(Clone, Debug, Default)]
pub struct MeshEdges {
    /// Particles at the ends of each edge, the lower first. Ascending.
    pub ends: Vec<[u32; 2]>,
    /// Edge of each side.
    pub edge_of_side: Vec<u32>,
    /// Start of the sides of each edge in `sides`; one more than there are edges.
    offsets: Vec<u32>,
    sides: Vec<u32>,
}

impl MeshEdges {
    /// Edges of triangles whose corners are all below `particles`. Linear time where no particle has very many.
    pub fn new(particles: usize, triangles: &[[u32; 3]]) -> Self {
        let count = triangles.len() * 3;
        let directed = (0..count).map(|side| {
            let triangle = &triangles[side / 3];
            let (from, to) = (triangle[side % 3], triangle[(side + 1) % 3]);
            (from.min(to), (from.max(to), side as u32))
        });
        let buckets = Groups::new(particles, directed);
        let mut edges = Self {
            edge_of_side: vec![0; count],
            sides: Vec::with_capacity(count),
            offsets: Vec::with_capacity(count / 2 + 1),
            ends: Vec::with_capacity(count / 2),
        };
        let mut bucket: Vec<(u32, u32)> = Vec::new();
        for low in 0..particles as u32 {
            bucket.clear();
            bucket.extend(buckets.of(low));
            bucket.sort_unstable();
            for sides in bucket.chunk_by(|a, b| a.0 == b.0) {
                edges.offsets.push(edges.sides.len() as u32);
                for &(_, side) in sides {
                    edges.edge_of_side[side as usize] = edges.ends.len() as u32;
                    edges.sides.push(side);
                }
                edges.ends.push([low, sides[0].0]);
            }
        }
        edges.offsets.push(count as u32);
        edges
    }

    /// The number of edges.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Sides that lie on one edge: one at a border, more than two where the mesh is not a surface.
    pub fn sides(&self, edge: u32) -> &[u32] {
        let edge = edge as usize;
        &self.sides[self.offsets[edge] as usize..self.offsets[edge + 1] as usize]
    }

    /// Sides of other triangles on the edge of `side`; none where there are more than eight triangles, as every one would be adjacent to
    /// every other.
    pub fn across(&self, side: u32) -> impl Iterator<Item = u32> + '_ {
        let sides = self.sides(self.edge_of_side[side as usize]);
        let few = if sides.len() > MOST_SIDES { &[] } else { sides };
        few.iter().copied().filter(move |other| *other != side)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fin_on_a_quad_is_the_third_side_of_its_edge() {
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 2, 0]];
        let edges = MeshEdges::new(5, &triangles);
        assert_eq!(
            edges.ends,
            [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [2, 4]]
        );
        assert_eq!(edges.sides(1), [2, 3, 7]);
        assert_eq!(edges.across(3).collect::<Vec<_>>(), [2, 7]);
        assert!(MeshEdges::new(0, &[]).is_empty());
    }
}
