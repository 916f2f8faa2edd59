//! Accuracy of cloth, and its cost: two solvers. The systems of a substep are here, their arithmetic is in the crate `tailorbird_solver`.
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{UVec2, Vec2};
//! # use tailorbird_cloth::prelude::*;
//! fn spawn(mut commands: Commands, mut settings: ResMut<ClothSettings>) {
//!     let cloth = Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48));
//!     // Chains, with as many substeps as the cloth needs: nothing to do.
//!     commands.spawn(cloth.clone());
//!     // The classic one, to compare with.
//!     commands.spawn((cloth, ClothSolver::GaussSeidel));
//!     // All of them finer, at twice the cost of eight.
//!     settings.substeps = Some(16);
//! }
//! ```
//!
//! # Which one
//!
//! | | [`Chains`](ClothSolver::Chains), the default | [`GaussSeidel`](ClothSolver::GaussSeidel), the classic one |
//! | --- | --- | --- |
//! | method | each row and column as a whole, exactly | spring by spring, as Jakobsen's relaxation and XPBD do |
//! | 128², hanging by two corners, one thread | 1.5 ms a step; 0.011 % in the mean, 0.09 % at 99 % | 15.6 ms; 9.4 %, 94 % |
//! | substeps unless set | 6 to 16, by the resolution: [`ClothSolver::substeps`] | 16 |
//! | stiffness and resolution | stretch is that of the fabric; shear and bending up to a [limit](crate::material) | softer with every particle |
//! | tethers to the pins, viscosity, damping of tangles | yes | no |
//! | heavy bodies of a physics engine | carried | fall through |
//! | asked for more than the cloth has | stretches, and lies still | the same |
//!
//! The figures are the README's (AVX-512; rigid threads, `cargo run --release -p tailorbird_cloth --example bench -- hang`).
//!
//! The classic solver is there to compare with, and for cloth that is meant to stretch like rubber.
//!
//! # More than the cloth has
//!
//! Clips farther apart than the path between them along the cloth, a tube that is too tight, a ball that is pushed through a net, a solid
//! put into a curtain: no shape of a cloth that hardly stretches meets that. It stretches as evenly as it can (a few edges around a solid
//! that stays inside by many times their length), lies still, and is whole
//! again when the demand ends, without flying about. [`ClothStatus::strained`](crate::error::ClothStatus::strained) is the part of
//! its edges that is longer than the fabric allows; one line is logged.
//!
//! # Substeps
//!
//! One pass over the constraints in each of several substeps: at equal cost that stretches less than many passes in few. The error falls
//! with the square of the substep, the cost grows in proportion. A calm cloth needs the number that is chosen; a hard gust, a heavy body, a
//! snatch need more ([`ClothSettings::substeps`](crate::settings::ClothSettings::substeps), for all cloths; 16 and 32 are usual). Storms,
//! a hand and bodies that lie on the cloth raise it by themselves, up to [`ClothSettings::most_substeps`](crate::settings::ClothSettings::most_substeps).
//!
//! # How good it is
//!
//! [`ClothParticles::stretch`](crate::particles::ClothParticles::stretch) tells mean, 99 % quantile and largest stretch of the edges; `ClothDiagnosticsPlugin` of `tailorbird` keeps
//! them. The method and its limits are explained
//! [beside the kernels](https://github.com/tailorbird/tailorbird/blob/main/crates/tailorbird_solver/src/kernels/README.md).

mod stages;

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_solver::{coefficients::Method, topology::Topology};

pub use stages::{damp_tangles, solve_constraints, verlet_step};

/// Method by which the constraints of a cloth are solved.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothSolver {
    /// Whole lines of edges at once, exactly; tethers to the pins. Particles at edges that are squeezed to less than 0.7 of their
    /// length at the end of a step get the motion of the whole.
    #[default]
    Chains,
    /// Spring by spring: Jakobsen's relaxation, and XPBD where there is compliance.
    GaussSeidel,
}

/// The number of substeps of a cloth, in place of [`ClothSettings::substeps`](crate::settings::ClothSettings::substeps) and of as many as it
/// needs: fewer for one far away, more for one that must not stretch. Optional; 0 counts as 1.
///
/// If a game has systems of its own in [`ClothSubstep`](crate::schedule::ClothSubstep), all cloths take as many as the one that takes
/// most.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct ClothSubsteps(pub u32);

impl ClothSolver {
    /// Number of substeps that a cloth needs in a step of 1/60 s.
    ///
    /// [`Chains`](Self::Chains): a 24th of the particles along the longer side, 8 to 16, and 6 where that has 36 or less; even.
    /// Fewer do for a sheet that hangs, and not for one that is pulled or blown about. Of a mesh that is no grid a 16th of
    /// the square root of its particles, 6 to 16. Both take up to 32, a fifth of the longer side, while a hand holds the cloth.
    /// [`GaussSeidel`](Self::GaussSeidel): 16.
    pub fn substeps(self, topology: &Topology) -> u32 {
        match self {
            Self::Chains => {
                let needed = if let Some(lattice) = topology.lattice() {
                    let side = lattice.columns.max(lattice.rows);
                    let least = if side <= 36 { 6 } else { 8 };
                    side.div_ceil(24).max(least)
                } else {
                    // The chains of a mesh are shorter and bent, and more of them meet at a particle.
                    let side = (topology.particles() as f32).sqrt().ceil() as u32;
                    side.div_ceil(16).max(6)
                };
                needed.next_multiple_of(2).min(16)
            }
            Self::GaussSeidel => 16,
        }
    }

    /// Method for the solver.
    pub(crate) fn method(self) -> Method {
        match self {
            Self::Chains => Method::Lines,
            Self::GaussSeidel => Method::Springs,
        }
    }

    /// Least number of substeps of a cloth while a hand holds it: the hand may stretch an edge by a tenth, which bounds its force in a
    /// substep, and the weight of the sheet has to follow. A fifth of the particles along the longer side, at most 32; even.
    pub(crate) fn substeps_in_hand(self, topology: &Topology) -> u32 {
        let side = match (self, topology.lattice()) {
            (Self::GaussSeidel, _) => 0,
            (Self::Chains, Some(lattice)) => lattice.columns.max(lattice.rows),
            (Self::Chains, None) => (topology.particles() as f32).sqrt().ceil() as u32,
        };
        side.div_ceil(5).next_multiple_of(2).min(32)
    }
}
