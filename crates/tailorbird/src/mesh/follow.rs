//! Vertices of a mesh, from particles and normals.

use bevy_math::{Affine3A, Mat3, Vec3};
use bevy_tasks::{ComputeTaskPool, TaskPool};

use super::{
    binding::{Bindings, ClothVertexBinding},
    drawn::Drawn,
    interleave::{Interleaved, SheetVertices},
    interleaved::{VertexOrder, write_normals, write_positions, write_sheet},
    packed::Packed,
    tangents::{Surface, Tangents},
};

/// Vertices that a task has at least.
pub(super) const PIECE: usize = 8192;

/// Particle and normal that each vertex of a mesh follows.
pub(super) struct Follow {
    /// Number of particles of the cloth.
    particles: u32,
    pub bindings: Bindings,
    /// For each vertex its normal: of a particle when smooth, of a triangle when flat.
    normal_of_vertex: Vec<u32>,
    /// The first of the particles and of the normals, where they are in the order of the vertices.
    in_order: [Option<usize>; 2],
    /// Columns, where the vertices are the particles of a grid.
    columns: Option<usize>,
    /// The vertices on the backs of double-sided faces, whose normals point the other way.
    backs: Vec<u32>,
    /// Absent where the mesh has no UVs.
    pub tangents: Option<Tangents>,
    /// From the cloth's space to that of the entity with the mesh; absent where they are one.
    pub from_cloth: Option<Affine3A>,
    /// Scratch.
    found: Vec<[f32; 4]>,
}

impl Follow {
    pub fn new(
        particle_of_vertex: Vec<u32>,
        normal_of_vertex: Vec<u32>,
        backs: Vec<u32>,
        tangents: Option<Tangents>,
        (particles, columns): (usize, Option<usize>),
    ) -> Self {
        let first = |list: &[u32]| {
            let in_order = list
                .windows(2)
                .all(|pair| pair[1] == pair[0].wrapping_add(1));
            list.first().copied().filter(|_| in_order)
        };
        let in_order = [&particle_of_vertex, &normal_of_vertex].map(|list| first(list));
        Self {
            particles: particles as u32,
            bindings: particle_of_vertex.into(),
            normal_of_vertex,
            columns: columns.filter(|_| in_order == [Some(0); 2] && backs.is_empty()),
            in_order: in_order.map(|first| first.map(|i| i as usize)),
            backs,
            tangents,
            from_cloth: None,
            found: Vec::new(),
        }
    }

    /// The number of vertices.
    pub fn len(&self) -> usize {
        self.bindings.particles().len()
    }

    /// Binds a vertex to something else, where that can be drawn. Returns whether it did.
    pub fn bind(&mut self, vertex: u32, binding: ClothVertexBinding) -> bool {
        let bound = binding.is_among(self.particles) && self.bindings.set(vertex, binding);
        if bound {
            self.in_order[0] = None;
            self.columns = None;
        }
        bound
    }

    /// Writes positions, normals and tangents; where there are many, in several tasks.
    pub fn write(&mut self, drawn: Drawn, packed: &mut Packed) {
        let (stride, piece) = (packed.stride, self.piece());
        if self.write_sheet(drawn, packed) {
            return;
        }
        let places = [packed.position, packed.normal];
        let this = &*self;
        share(packed.words.chunks_mut(piece * stride), &|k, words| {
            this.place(drawn, k * piece, words, stride, places);
        });
        if let (Some(tangents), Some(place)) = (&self.tangents, packed.tangent) {
            self.found.resize(self.bindings.particles().len(), [0.0; 4]);
            let surface = Surface {
                words: &packed.words,
                stride,
                places,
            };
            share(self.found.chunks_mut(piece), &|k, found| {
                tangents.compute(surface, k * piece, found);
            });
            let vertices = packed.words.chunks_exact_mut(stride);
            for (vertex, found) in vertices.zip(&self.found) {
                vertex[place..place + 4].copy_from_slice(found);
            }
        }
    }

    /// Writes all at once, row by row, where the vertices are those of a grid; whether they are.
    fn write_sheet(&self, drawn: Drawn, packed: &mut Packed) -> bool {
        let (Some(columns), Some(tangents), Some(tangent), None) = (
            self.columns,
            &self.tangents,
            packed.tangent,
            self.from_cloth,
        ) else {
            return false;
        };
        if !drawn.is_scaled_evenly() {
            return false;
        }
        let (stride, rows) = (packed.stride, self.piece().div_ceil(columns));
        let places = [packed.position, packed.normal, tangent];
        let pieces = packed.words.chunks_mut(rows * columns * stride);
        share(pieces, &|k, words| {
            let vertices = SheetVertices {
                words,
                stride,
                columns,
                places,
                handedness: tangents.handedness(),
            };
            let Drawn {
                particles,
                normals,
                holds,
                fraction,
                scale,
            } = drawn;
            let factors = scale.recip();
            let first = k * rows;
            write_sheet(
                particles, normals, fraction, holds, factors, first, vertices,
            );
        });
        true
    }

    /// Vertices of a task.
    fn piece(&self) -> usize {
        // Who waits for them works as well.
        let threads = 1 + ComputeTaskPool::get_or_init(TaskPool::default).thread_num();
        self.len().div_ceil(threads).max(PIECE)
    }

    /// Writes positions and normals of vertices from `first` on.
    fn place(
        &self,
        drawn: Drawn,
        first: usize,
        words: &mut [f32],
        stride: usize,
        [position, normal]: [usize; 2],
    ) {
        let vertices = first..first + words.len() / stride;
        let order = |k: usize, list| match self.in_order[k] {
            Some(start) => VertexOrder::From(start + first),
            None => VertexOrder::Listed(list),
        };
        let Drawn {
            fraction, scale, ..
        } = drawn;
        write_positions(
            drawn.particles,
            fraction,
            drawn.holds,
            scale.recip(),
            order(0, &self.bindings.particles()[vertices.clone()]),
            Interleaved {
                words,
                stride,
                offset: position,
            },
        );
        write_normals(
            drawn.normals,
            fraction,
            order(1, &self.normal_of_vertex[vertices.clone()]),
            Interleaved {
                words,
                stride,
                offset: normal,
            },
        );
        self.bindings
            .place(drawn, vertices.clone(), |vertex, at, along| {
                let words = &mut words[(vertex - first) * stride..][..stride];
                words[position..position + 3].copy_from_slice(&at.to_array());
                if let Some(along) = along {
                    words[normal..normal + 3].copy_from_slice(&along.to_array());
                }
            });
        // Normals transform by the inverse of the scale, so here by the scale. In a mirror particles go round triangles the other way
        // than vertices do, and their normals are on the other side.
        if !drawn.is_scaled_evenly() {
            let side = scale.element_product().signum();
            each(words, stride, normal, |n| {
                (n * scale * side).normalize_or(n)
            });
        }
        if let Some(from_cloth) = self.from_cloth {
            each(words, stride, position, |p| from_cloth.transform_point3(p));
            // Normals transform by the inverse transpose.
            let to_normal = Mat3::from(from_cloth.matrix3).inverse().transpose();
            each(words, stride, normal, |n| (to_normal * n).normalize_or(n));
        }
        let backs = self.backs.iter().map(|vertex| *vertex as usize);
        for vertex in backs.filter(|vertex| vertices.contains(vertex)) {
            let start = (vertex - first) * stride;
            each(&mut words[start..start + stride], stride, normal, |n| -n);
        }
    }
}

/// Changes a vector of each vertex.
fn each(words: &mut [f32], stride: usize, place: usize, change: impl Fn(Vec3) -> Vec3) {
    for vertex in words.chunks_exact_mut(stride) {
        let vector = &mut vertex[place..place + 3];
        vector.copy_from_slice(&change(Vec3::from_slice(vector)).to_array());
    }
}

/// Works on several things, each in a task of its own.
pub(super) fn share<T: Send>(
    things: impl ExactSizeIterator<Item = T>,
    work: &(impl Fn(usize, T) + Sync),
) {
    if things.len() < 2 {
        things.enumerate().for_each(|(k, thing)| work(k, thing));
        return;
    }
    ComputeTaskPool::get_or_init(TaskPool::default).scope(|scope| {
        for (k, thing) in things.enumerate() {
            scope.spawn(async move { work(k, thing) });
        }
    });
}
