//! Makes the triangles of a mesh face one way, where that is possible.

use super::mesh_edges::MeshEdges;

/// Orientation of the triangles of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Orientation {
    /// Triangles to turn around.
    pub turned: Vec<u32>,
    /// Edges whose triangles face opposite ways, in pieces that have no two sides.
    pub one_sided: Vec<u32>,
}

impl Orientation {
    /// Walks over the edges of two triangles. In each piece that these join, the fewer triangles are turned around; a piece that has no two
    /// sides is left as it is. Linear time.
    pub fn new(edges: &MeshEdges, triangles: &[[u32; 3]]) -> Self {
        let forward = |side: u32| {
            let (triangle, k) = (triangles[side as usize / 3], side as usize % 3);
            triangle[k] < triangle[(k + 1) % 3]
        };
        // Across an edge of two triangles: the side there, and a flag: it runs in the same direction, which is wrong.
        let across = |side: u32| match edges.sides(edges.edge_of_side[side as usize]) {
            &[a, b] => Some((a + b - side, forward(a) == forward(b))),
            _ => None,
        };
        let mut orientation = Self::default();
        let mut turned: Vec<Option<bool>> = vec![None; triangles.len()];
        let mut piece: Vec<u32> = Vec::new();
        for first in 0..triangles.len() {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            piece.clear();
            piece.push(first as u32);
            let (mut next, mut two_sided, mut count) = (0, true, 0);
            while let Some(&t) = piece.get(next) {
                next += 1;
                let here = turned[t as usize] == Some(true);
                count += usize::from(here);
                for (other, wrong) in (3 * t..3 * t + 3).filter_map(across) {
                    let wanted = here != wrong;
                    match &mut turned[other as usize / 3] {
                        Some(there) => two_sided &= *there == wanted,
                        unknown => {
                            *unknown = Some(wanted);
                            piece.push(other / 3);
                        }
                    }
                }
            }
            if two_sided {
                let fewer = 2 * count <= piece.len();
                let turns = piece.iter().filter(|&&t| turned[t as usize] == Some(fewer));
                orientation.turned.extend(turns);
            } else {
                let sides = piece.iter().flat_map(|&t| 3 * t..3 * t + 3);
                let seams = sides.filter(|&side| {
                    across(side).is_some_and(|(other, wrong)| wrong && side < other)
                });
                let edge = |side: u32| edges.edge_of_side[side as usize];
                orientation.one_sided.extend(seams.map(edge));
            }
        }
        orientation.turned.sort_unstable();
        orientation.one_sided.sort_unstable();
        orientation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orientation(triangles: &[[u32; 3]]) -> Orientation {
        let particles = triangles.iter().flatten().max().map_or(0, |most| most + 1);
        Orientation::new(&MeshEdges::new(particles as usize, triangles), triangles)
    }

    /// A strip of `n` quads, closed to a ring; with a half twist to a Möbius strip.
    fn ring(n: u32, twisted: bool) -> Vec<[u32; 3]> {
        (0..n)
            .flat_map(|i| {
                let [a, b] = [2 * i, 2 * i + 1];
                let [c, d] = match (i + 1 == n, twisted) {
                    (true, true) => [1, 0],
                    (true, false) => [0, 1],
                    _ => [a + 2, b + 2],
                };
                [[a, b, c], [c, b, d]]
            })
            .collect()
    }

    #[test]
    fn what_faces_one_way_is_left_alone() {
        assert_eq!(orientation(&ring(5, false)), Orientation::default());
        assert_eq!(orientation(&[]), Orientation::default());
    }

    #[test]
    fn the_fewer_are_turned_around() {
        let mut triangles = ring(5, false);
        for t in [0, 1, 6] {
            triangles[t].swap(0, 1);
        }
        assert_eq!(orientation(&triangles).turned, [0, 1, 6]);
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
        assert_eq!(orientation(&triangles).turned, [0, 1, 6]);
    }

    #[test]
    fn a_moebius_strip_is_left_alone_and_its_seam_found() {
        let triangles = ring(5, true);
        let found = orientation(&triangles);
        assert_eq!(found.turned, [0; 0]);
        let edges = MeshEdges::new(10, &triangles);
        let seams: Vec<[u32; 2]> = found
            .one_sided
            .iter()
            .map(|e| edges.ends[*e as usize])
            .collect();
        assert_eq!(seams, [[0, 1]]);
    }

    #[test]
    fn nothing_is_said_across_an_edge_of_three_triangles() {
        assert_eq!(
            orientation(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]]),
            Orientation::default()
        );
    }
}
