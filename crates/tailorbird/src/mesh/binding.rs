//! Bindings of vertices to particles.

use bevy_math::Vec3;

use tailorbird_solver::topology::order::Stored;

use super::drawn::Drawn;

/// Binding of a vertex of a mesh. Particles are in storage order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClothVertexBinding {
    /// A particle.
    Particle(u32),
    /// A point of a triangle between three particles.
    Triangle {
        /// The particles.
        corners: [u32; 3],
        /// The barycentric coordinates of the point [-]; their sum is 1.
        weights: [f32; 3],
    },
}

impl ClothVertexBinding {
    /// Returns whether it names a point among so many particles.
    pub(super) fn is_among(&self, particles: u32) -> bool {
        /// Of the sum of the weights, by rounding.
        const MOST_OFF: f32 = 1e-4;
        match *self {
            Self::Particle(particle) => particle < particles,
            Self::Triangle { corners, weights } => {
                let off = (weights.iter().sum::<f32>() - 1.0).abs();
                corners.iter().all(|corner| *corner < particles) && off <= MOST_OFF
            }
        }
    }
}

/// Bindings of the vertices of a mesh: most to particles, one each; the others are listed.
#[derive(Debug, Default)]
pub(super) struct Bindings {
    /// For each vertex its particle; of one on a triangle, the corner that is nearest to it.
    particles: Vec<u32>,
    /// The vertices on triangles, ascending.
    on_triangles: Vec<(u32, [u32; 3], [f32; 3])>,
}

impl From<Vec<u32>> for Bindings {
    /// Each vertex follows a particle.
    fn from(particles: Vec<u32>) -> Self {
        Self {
            particles,
            on_triangles: Vec::new(),
        }
    }
}

impl Bindings {
    /// For each vertex its particle, or the nearest one.
    pub fn particles(&self) -> &[u32] {
        &self.particles
    }

    /// The binding of a vertex; none if there is no such vertex.
    pub fn get(&self, vertex: u32) -> Option<ClothVertexBinding> {
        let found = self
            .on_triangles
            .binary_search_by_key(&vertex, |(vertex, ..)| *vertex);
        if let Ok(found) = found {
            let (_, corners, weights) = self.on_triangles[found];
            return Some(ClothVertexBinding::Triangle { corners, weights });
        }
        let particle = self.particles.get(vertex as usize)?;
        Some(ClothVertexBinding::Particle(*particle))
    }

    /// Binds a vertex. Returns whether there is such a vertex.
    pub fn set(&mut self, vertex: u32, binding: ClothVertexBinding) -> bool {
        let Some(particle) = self.particles.get_mut(vertex as usize) else {
            return false;
        };
        let found = self
            .on_triangles
            .binary_search_by_key(&vertex, |(vertex, ..)| *vertex);
        match (binding, found) {
            (ClothVertexBinding::Particle(to), found) => {
                *particle = to;
                if let Ok(found) = found {
                    self.on_triangles.remove(found);
                }
            }
            (ClothVertexBinding::Triangle { corners, weights }, found) => {
                let nearest = |a: usize, b| if weights[b] > weights[a] { b } else { a };
                *particle = corners[(1..3).fold(0, nearest)];
                match found {
                    Ok(found) => self.on_triangles[found] = (vertex, corners, weights),
                    Err(at) => self.on_triangles.insert(at, (vertex, corners, weights)),
                }
            }
        }
        true
    }

    /// Calls `f` with each vertex on a triangle among these, where it is in the cloth's space, and its normal in the axes of the cloth's
    /// frame, where normals are those of particles.
    pub fn place(
        &self,
        drawn: Drawn,
        vertices: std::ops::Range<usize>,
        mut f: impl FnMut(usize, Vec3, Option<Vec3>),
    ) {
        let first = self
            .on_triangles
            .partition_point(|(vertex, ..)| (*vertex as usize) < vertices.start);
        let normals = drawn.normals.ends()[1].len() == drawn.particles.len();
        for (vertex, corners, weights) in &self.on_triangles[first..] {
            if *vertex as usize >= vertices.end {
                break;
            }
            let sum = |at: &dyn Fn(Stored) -> Vec3| {
                let each = corners.iter().zip(weights);
                each.map(|(i, weight)| *weight * at(Stored(*i)))
                    .sum::<Vec3>()
            };
            let place =
                sum(&|i| drawn.particles.interpolated(i, drawn.fraction) + drawn.holds.offset(i));
            let normal = || {
                sum(&|i| drawn.normals.interpolated(i.index(), drawn.fraction))
                    .normalize_or(Vec3::Z)
            };
            f(*vertex as usize, place / drawn.scale, normals.then(normal));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_binding_names_particles_that_are_there_and_a_point_of_their_triangle() {
        let on = |corners, weights| ClothVertexBinding::Triangle { corners, weights };
        let third = [1.0 / 3.0; 3];
        assert!(on([0, 1, 2], third).is_among(3) && ClothVertexBinding::Particle(2).is_among(3));
        assert!(!on([0, 1, 3], third).is_among(3) && !ClothVertexBinding::Particle(3).is_among(3));
        for weights in [[f32::NAN; 3], [1.0; 3], [f32::INFINITY, 0.0, 0.0]] {
            assert!(!on([0, 1, 2], weights).is_among(3));
        }
    }

    #[test]
    fn what_is_bound_last_counts() {
        let mut bindings = Bindings::from(vec![3, 4, 5]);
        let on = |a| ClothVertexBinding::Triangle {
            corners: [a, 7, 8],
            weights: [0.2, 0.5, 0.3],
        };
        assert!(bindings.set(2, on(1)) && bindings.set(0, on(2)) && bindings.set(2, on(6)));
        assert!(!bindings.set(3, on(1)) && bindings.get(3).is_none());
        assert_eq!([0, 2].map(|v| bindings.get(v)), [2, 6].map(|a| Some(on(a))));
        assert_eq!(bindings.particles(), [7, 4, 7]);
        assert!(bindings.set(0, ClothVertexBinding::Particle(9)));
        assert!(bindings.set(2, ClothVertexBinding::Particle(1)));
        assert!(bindings.on_triangles.is_empty());
        assert_eq!(bindings.particles(), [9, 4, 1]);
    }
}
