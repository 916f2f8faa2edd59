//! Solvers that are measured.

mod classic;
mod rapier;
#[cfg(feature = "bevy_silk")]
mod silk;

use clap::ValueEnum;

use crate::{error::Error, scene::Sheet};

/// A solver with a sheet in it.
pub trait Peer {
    /// Simulates a step. This is what is timed.
    fn step(&mut self);

    /// Appends where the particles are [m], row by row.
    fn positions(&self, into: &mut Vec<[f32; 3]>);
}

/// Makes a solver with a sheet at its start and so many passes in a step.
pub type Builder = fn(Sheet, u8) -> Box<dyn Peer>;

/// A solver.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum PeerKind {
    /// Verlet integration and relaxation over 8 N² springs, plain scalar code.
    Classic,
    /// The soft bodies of rapier3d.
    Rapier3d,
    /// The sticks of `bevy_silk`; needs the feature of that name.
    #[value(name = "bevy_silk")]
    BevySilk,
}

impl PeerKind {
    /// All that are built in.
    pub fn built() -> Vec<Self> {
        let mut all = vec![Self::Classic, Self::Rapier3d];
        if cfg!(feature = "bevy_silk") {
            all.push(Self::BevySilk);
        }
        all
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Classic => "classic",
            Self::Rapier3d => "rapier3d",
            Self::BevySilk => "bevy_silk",
        }
    }

    /// Constructor of its scene.
    ///
    /// # Errors
    /// When it is not built in.
    pub fn builder(self) -> Result<Builder, Error> {
        match self {
            Self::Classic => Ok(|sheet, passes| Box::new(classic::Classic::new(sheet, passes))),
            Self::Rapier3d => Ok(|sheet, passes| Box::new(rapier::Rapier::new(sheet, passes))),
            #[cfg(feature = "bevy_silk")]
            Self::BevySilk => Ok(|sheet, passes| Box::new(silk::Silk::new(sheet, passes))),
            #[cfg(not(feature = "bevy_silk"))]
            Self::BevySilk => Err(Error::NotBuilt {
                peer: self.name(),
                feature: "bevy_silk",
            }),
        }
    }
}
