//! Stiffness of the edges of lines.

use fearless_simd::{Simd, prelude::*};

use super::lanes::{Shared, WIDEST};

/// Least α̃ of a line whose particles have the mass m, as a part of 1/m [-]. A fabric that is stiffer acts as one of this stiffness: of boards beyond it,
/// bending and the edges' solve undo each other, which becomes motion (below 10⁻³ a free one that spins and waves gets 1.4 to 7 times its energy).
const LEAST_BEND: f32 = 1e-2;

/// Compliances of the lines of a sheet. Lines at the border stand for half a strip, and are twice as compliant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStiffness {
    /// L \[m\].
    pub rest_length: f32,
    /// α̃ = α/h² [1/kg].
    pub stretch: f32,
    /// α̃ of the triples [1/kg]; infinite means no bending resistance.
    pub bend: f32,
    /// Mass of a particle within the sheet \[kg\], the least of all but those at the border.
    pub mass: f32,
}

impl LineStiffness {
    /// Edges of the lines from `first` on, one in each lane, of `count` in all.
    #[inline(always)]
    pub fn of_lines<S: Simd>(self, simd: S, first: usize, count: usize) -> (Edge<S>, Whole<S>) {
        let mut scale = [1.0; WIDEST];
        if first == 0 {
            scale[0] = 2.0;
        }
        // A sheet has two lines at least.
        if let Some(last) = scale[..S::f32s::LEN].get_mut(count - 1 - first) {
            *last = 2.0;
        }
        let scale = S::f32s::from_slice(simd, &scale[..S::f32s::LEN]);
        let l2 = self.rest_length * self.rest_length;
        let edge = Edge {
            l2: S::f32s::splat(simd, l2),
            alpha: scale * (self.stretch * l2),
        };
        let whole = Whole {
            // More than 0, as what is held has α̃/w = ∞.
            bend: scale * self.bend.max(LEAST_BEND / self.mass),
            part: S::f32s::splat(simd, 1.0) / scale,
            bears: S::f32s::splat(simd, 0.25 * self.mass) / scale,
        };
        (edge, whole)
    }
}

/// Properties of a whole line, for each lane.
#[derive(Clone, Copy)]
pub struct Whole<S: Simd> {
    /// α̃ of the triples [1/kg].
    pub bend: S::f32s,
    /// Width of the strip that the line stands for, by that of a line within the sheet [-]: 1/2 at the border.
    pub part: S::f32s,
    /// Tension that an edge bears, for κ = 4 w |μ| = 1: |μ| \[kg\]. w is the largest inverse mass; particles at the ends count half.
    pub bears: S::f32s,
}

/// Length and compliance of an edge, for each lane.
#[derive(Clone, Copy)]
pub struct Edge<S: Simd> {
    /// L² \[m²\].
    pub l2: S::f32s,
    /// α̃ L² \[m²/kg\].
    pub alpha: S::f32s,
}

/// Lengths and compliances of the edges of chains.
pub trait Edges<S: Simd>: Copy {
    /// Edges between the particles `k` and `k` + 1.
    fn at(self, simd: S, k: usize) -> Edge<S>;
}

/// Edges that are all the same along a chain.
impl<S: Simd> Edges<S> for Edge<S> {
    #[inline(always)]
    fn at(self, _simd: S, _k: usize) -> Self {
        self
    }
}

/// Edges that differ along a chain: those of a mesh.
#[derive(Clone, Copy)]
pub struct MeshLines<'a> {
    /// L \[m\], 0 where there is no edge.
    pub rest_length: &'a [f32],
    /// Factor of `stretch` [-].
    pub scale: &'a [f32],
    /// α̃ of an edge whose scale is 1 [1/kg].
    pub stretch: f32,
    /// Step from one edge of a chain to the next.
    pub stride: usize,
}

impl<S: Simd> Edges<S> for MeshLines<'_> {
    #[inline(always)]
    fn at(self, simd: S, k: usize) -> Edge<S> {
        let load =
            |values: &[f32]| S::f32s::from_slice(simd, &values[k * self.stride..][..S::f32s::LEN]);
        let length = load(self.rest_length);
        let l2 = length * length;
        Edge {
            l2,
            alpha: load(self.scale) * self.stretch * l2,
        }
    }
}

/// Prescribed lengths of the edges of lines side by side \[m\].
#[derive(Clone, Copy)]
pub struct LineLengths<'a> {
    pub lengths: Shared<'a>,
    /// Index of the length of the first edge of the first lane.
    pub at: usize,
    /// Step from one edge of a line to the next.
    pub stride: usize,
}

/// Edges of a sheet whose prescribed lengths differ from those at rest.
#[derive(Clone, Copy)]
pub struct SheetLines<'a, S: Simd> {
    /// Edge at rest.
    pub edge: Edge<S>,
    pub lengths: LineLengths<'a>,
}

impl<S: Simd> Edges<S> for SheetLines<'_, S> {
    #[inline(always)]
    fn at(self, simd: S, k: usize) -> Edge<S> {
        let LineLengths {
            lengths,
            at,
            stride,
        } = self.lengths;
        let length = lengths.load(simd, at + k * stride);
        Edge {
            l2: length * length,
            ..self.edge
        }
    }
}
