//! Memory layout of chains, and limits of their compliance and tension: the input of `line` and `ring`.

#![expect(clippy::doc_markdown, reason = "formulas")]

use fearless_simd::Simd;

use super::lanes::{Factor, Shared, SharedPoints, V3};

/// Smallest product of inverse mass and square metres in a denominator, so that an edge held at both ends does not divide by 0.
pub(super) const NO_MASS: f32 = 1e-30;

/// Least diagonal, as a part of (w_k + w_{k+1}) L²: two particles in contact one above the other cannot be moved along their edge.
pub(super) const LEAST_PIVOT: f32 = 0.05;

/// Least α̃_k L_k², as a part of (w_k + w_{k+1}) L². Without it, the tension of a taut and straight line, such as a row between two pins,
/// would have no bounds, and waves across it outrun a substep. With 10⁻⁴ such rows tremble; with 10⁻³ a sheet that hangs stretches half as
/// much again.
pub const LEAST_COMPLIANCE: f32 = 5e-4;

/// Largest κ = 4 w |μ| of a line whose inverse masses are w: above 4/3, waves of two edges' length grow.
pub const LARGEST_KAPPA: f32 = 1.3;

/// `CONTACT`: no particle is in contact.
pub const FREE: u8 = 0;
/// `CONTACT`: some particles are in contact, and move along surfaces.
pub const TOUCHING: u8 = 1;
/// `CONTACT`: some particles are in contact, and carry parts of bodies; the impulses along their normals are added up.
pub const PRESSED: u8 = 2;

/// Limits of compliance and tension of chains that give way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Give {
    /// Least α̃ L², as a part of (w_k + w_{k+1}) L² [-].
    pub compliance: f32,
    /// Largest pull of an edge, κ = 4 w |μ| [-].
    pub pull: f32,
    /// Largest push of an edge, κ = 4 w |μ| [-].
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

/// Arrays of chains side by side, and their layout.
#[derive(Clone, Copy)]
pub struct Lines<'a> {
    pub position: SharedPoints<'a>,
    pub inv_mass: Shared<'a>,
    /// Unit normals of contacts, 0 for particles without contact; read only where some particles are in contact.
    pub normal: SharedPoints<'a>,
    /// Sums of the impulses on particles along their normals; read and written with [`PRESSED`] alone.
    pub pressed: Shared<'a>,
    /// Scratch for [`bend`](super::bend) and [`share`](super::share), side by side.
    pub shared: SharedPoints<'a>,
    /// Limits of compliance and tension.
    pub give: Give,
    /// Index of the first particle of the first lane.
    pub offset: usize,
    /// Step from one particle of a chain to the next.
    pub stride: usize,
    /// Number of particles of a chain.
    pub len: usize,
}

impl Lines<'_> {
    /// Index of particle `k` of the first chain.
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

/// Moves particles by w (I − n nᵀ) times a push: along the surface alone where they are in contact.
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
