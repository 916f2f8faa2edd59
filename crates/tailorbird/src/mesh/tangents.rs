//! Tangents that follow the cloth: the direction in which u grows, across each vertex's triangles.

use bevy_math::{Vec2, Vec3};

/// What is needed to compute the tangents of a mesh for any positions of its vertices.
///
/// Within a triangle u grows along e₁ (v₂ − v₀) − e₂ (v₁ − v₀), up to the sign of the UV area, with e the edges from its
/// first corner. A vertex gets the sum over its triangles, orthogonal to its normal. This is continuous in the positions:
/// normal maps do not swim.
pub(super) struct Tangents {
    /// Vertices and weights of e₁ and e₂ for each triangle that has a UV area.
    triangles: Vec<([u32; 3], [f32; 2])>,
    /// w of each vertex: w · (normal × tangent) points up in the picture, where v falls, as glTF and Bevy's own tangents
    /// have it.
    handedness: Vec<f32>,
    sums: Vec<Vec3>,
}

impl Tangents {
    pub(super) fn new(indices: &[u32], particle_of_vertex: &[u32], uvs: &[Vec2]) -> Self {
        let mut handedness = vec![1.0; uvs.len()];
        let mut triangles = Vec::with_capacity(indices.len() / 3);
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
            triangles.push((corners, [(c - a).y / area, -(b - a).y / area]));
            for i in corners {
                handedness[i as usize] = -area.signum();
            }
        }
        Self {
            triangles,
            handedness,
            sums: vec![Vec3::ZERO; uvs.len()],
        }
    }

    /// Writes the tangents for these positions and unit normals of the vertices.
    pub(super) fn write(
        &mut self,
        positions: &[[f32; 3]],
        normals: &[[f32; 3]],
        tangents: &mut [[f32; 4]],
    ) {
        self.sums.fill(Vec3::ZERO);
        for (corners, [w1, w2]) in &self.triangles {
            let [a, b, c] = corners.map(|i| Vec3::from(positions[i as usize]));
            let along_u = (b - a) * *w1 + (c - a) * *w2;
            for i in corners {
                self.sums[*i as usize] += along_u;
            }
        }
        for (((sum, normal), w), tangent) in self
            .sums
            .iter()
            .zip(normals)
            .zip(&self.handedness)
            .zip(tangents)
        {
            let normal = Vec3::from(*normal);
            let along = (*sum - normal * normal.dot(*sum)).normalize_or_zero();
            let along = if along == Vec3::ZERO {
                normal.any_orthonormal_vector()
            } else {
                along
            };
            *tangent = along.extend(*w).to_array();
        }
    }
}
