//! Where the particles of chains lie, and how far chains give way: what `line` and `ring` solve.

#![expect(clippy::doc_markdown, reason = "formulas")]

use fearless_simd::Simd;

use super::lanes::{Factor, Shared, SharedPoints, V3};

/// Inverse masses times square metres below this are none: what is held at both ends is divided by something.
pub(super) const NO_MASS: f32 = 1e-30;

/// The least diagonal, as a part of (w_k + w_{k+1}) L²: two particles in contact one above the other cannot be moved along
/// their edge.
pub(super) const LEAST_PIVOT: f32 = 0.05;

/// The least α̃_k L_k², as a part of (w_k + w_{k+1}) L²: the tension of what is taut and straight, such as a row between two
/// pins, would have no bounds else, and waves across it outrun a substep. With 10⁻⁴ such rows tremble; with 10⁻³ a sheet
/// that hangs stretches half as much again.
pub const LEAST_COMPLIANCE: f32 = 5e-4;

/// The largest κ = 4 w |μ| of a line whose inverse masses are w: what is above 4/3 lets waves of two edges' length grow.
pub const LARGEST_KAPPA: f32 = 1.3;

/// No particle is in contact.
pub const FREE: u8 = 0;
/// Some move along surfaces.
pub const TOUCHING: u8 = 1;
/// Some do, and carry parts of bodies: what pushes them is added up.
pub const PRESSED: u8 = 2;

/// How far chains give way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Give {
    /// The least α̃ L², as a part of (w_k + w_{k+1}) L² [-].
    pub compliance: f32,
    /// The most that an edge pulls with, κ = 4 w |μ| [-].
    pub pull: f32,
    /// And the most that it pushes with.
    pub push: f32,
}

impl Default for Give {
    fn default() -> Self {
        Self {
            compliance: LEAST_COMPLIANCE,
            pull: f32::MAX,
            push: f32::MAX,
        }
    }
}

/// Where the chains lie.
#[derive(Clone, Copy)]
pub struct Lines<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 where there is none; read where some are in contact alone.
    pub normal: SharedPoints<'a>,
    /// Where what pushes particles along their normals is added up; read and written with [`PRESSED`] alone.
    pub pressed: Shared<'a>,
    /// Where the particles are put between bending and stretching, side by side from the first on. May be `position` where that
    /// lies like this as well.
    pub bent: SharedPoints<'a>,
    /// Scratch for what a substep does not stand, side by side.
    pub shared: SharedPoints<'a>,
    /// How far the chains give way.
    pub give: Give,
    /// First particle of the first lane.
    pub offset: usize,
    /// From one particle of a chain to the next.
    pub stride: usize,
    /// Particles of a chain.
    pub len: usize,
}

impl Lines<'_> {
    /// Where particle `k` of the first chain lies.
    #[inline(always)]
    pub(super) fn at(self, k: usize) -> usize {
        self.offset + k * self.stride
    }

    #[inline(always)]
    pub(super) fn particle<S: Simd>(self, simd: S, k: usize) -> V3<S> {
        self.position.load(simd, self.at(k))
    }

    #[inline(always)]
    pub(super) fn weight<S: Simd>(self, simd: S, k: usize) -> S::f32s {
        self.inv_mass.load(simd, self.at(k))
    }

    #[inline(always)]
    pub(super) fn normal<S: Simd>(self, simd: S, k: usize) -> V3<S> {
        self.normal.load(simd, self.at(k))
    }
}

/// Moves particles by what pushes them, along the surface alone where they are in contact.
#[inline(always)]
pub(super) fn apply<S: Simd, const CONTACT: u8>(
    simd: S,
    lines: Lines,
    i: usize,
    position: V3<S>,
    mut push: V3<S>,
) {
    if CONTACT != FREE {
        let n: V3<S> = lines.normal.load(simd, i);
        let along = n.dot(push);
        push = push - Factor(along) * n;
        if CONTACT == PRESSED {
            let pressed = lines.pressed;
            pressed.store::<S>(i, pressed.load(simd, i) + along);
        }
    }
    let w = lines.inv_mass.load(simd, i);
    lines.position.store(i, position + Factor(w) * push);
}
