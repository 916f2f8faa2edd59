//! Tangents that follow the cloth: the direction in which u grows, across each vertex's triangles.

use std::collections::BTreeMap;

use bevy_math::{Vec2, Vec3};

/// An edge runs along u if v changes along it by less than this part of u's change.
const ALONG: f32 = 1e-3;

/// Data for the tangents of a mesh, for any positions of its vertices.
///
/// Within a triangle u grows along e₁ (v₂ − v₀) − e₂ (v₁ − v₀), up to the sign of the UV area, with e the edges from its first corner. A
/// vertex gets the sum over its triangles, which is a weighted sum of the offsets to its neighbours, orthogonal to its normal. If edges run
/// along u, like those of the rows of a sheet, they alone decide. This is continuous in the positions: normal maps do not swim.
pub(super) struct Tangents {
    /// For each vertex where its neighbours start, and where the last ones end.
    starts: Vec<u32>,
    /// Neighbours and their weights.
    neighbors: Vec<(u32, f32)>,
    /// w of each vertex: w · (normal × tangent) points up in the picture, where v falls, as glTF and Bevy's own tangents
    /// have it.
    handedness: Vec<f32>,
}

/// Vertices side by side: all their numbers, and where the parts of each are.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub words: &'a [f32],
    pub stride: usize,
    /// Of the position and of the normal.
    pub places: [usize; 2],
}

impl Surface<'_> {
    #[inline]
    fn at(&self, vertex: usize, place: usize) -> Vec3 {
        let start = vertex * self.stride + place;
        match self.words[start..start + 3] {
            [x, y, z] => Vec3::new(x, y, z),
            _ => Vec3::ZERO,
        }
    }
}

impl Tangents {
    pub(super) fn new(indices: &[u32], particle_of_vertex: &[u32], uvs: &[Vec2]) -> Self {
        let mut handedness = vec![1.0; uvs.len()];
        let mut around = vec![BTreeMap::<u32, f32>::new(); uvs.len()];
        for &corners in indices.as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|i| uvs[i as usize]);
            let area = (b - a).perp_dot(c - a);
            let particles = corners.map(|i| particle_of_vertex[i as usize]);
            let collapsed = particles[0] == particles[1]
                || particles[1] == particles[2]
                || particles[2] == particles[0];
            if area == 0.0 || !area.is_finite() || collapsed {
                continue;
            }
            let [w1, w2] = [(c - a).y / area, -(b - a).y / area];
            for i in corners {
                handedness[i as usize] = -area.signum();
                for (j, w) in corners.into_iter().zip([-w1 - w2, w1, w2]) {
                    if i != j && w != 0.0 {
                        *around[i as usize].entry(j).or_default() += w;
                    }
                }
            }
        }
        let (mut starts, mut neighbors) = (vec![0], Vec::new());
        for (vertex, mut around) in around.into_iter().enumerate() {
            let offset = |neighbor: u32| uvs[neighbor as usize] - uvs[vertex];
            let along_u = |neighbor: &u32| {
                let offset = offset(*neighbor);
                offset.y.abs() < ALONG * offset.x.abs()
            };
            if around.keys().any(along_u) {
                around.retain(|neighbor, weight| {
                    *weight = offset(*neighbor).x.recip();
                    along_u(neighbor)
                });
            }
            let most = around.values().fold(0.0f32, |most, w| most.max(w.abs()));
            // What cancels but for rounding is left out.
            neighbors.extend(around.into_iter().filter(|(_, w)| w.abs() > 1e-5 * most));
            starts.push(neighbors.len() as u32);
        }
        Self {
            starts,
            neighbors,
            handedness,
        }
    }

    /// Of the first vertex; for all, where the texture lies on the cloth in one piece.
    pub(super) fn handedness(&self) -> f32 {
        self.handedness.first().copied().unwrap_or(1.0)
    }

    /// The tangents of vertices from `first` on, for their positions and unit normals.
    pub(super) fn compute(&self, surface: Surface, first: usize, tangents: &mut [[f32; 4]]) {
        let [position, normal] = surface.places;
        for (vertex, tangent) in (first..).zip(tangents) {
            let own = surface.at(vertex, position);
            let neighbors = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
            let neighbors = self.neighbors[neighbors].iter();
            let along_u = neighbors.fold(Vec3::ZERO, |sum, (neighbor, weight)| {
                sum + *weight * (surface.at(*neighbor as usize, position) - own)
            });
            let normal = surface.at(vertex, normal);
            let along = (along_u - normal * normal.dot(along_u)).normalize_or_zero();
            let along = if along == Vec3::ZERO {
                normal.any_orthonormal_vector()
            } else {
                along
            };
            *tangent = along.extend(self.handedness[vertex]).to_array();
        }
    }
}
