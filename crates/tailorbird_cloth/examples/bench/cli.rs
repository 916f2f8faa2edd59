//! The command line.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use tailorbird_cloth::prelude::*;

/// Measures time per step, stretch and memory of cloth, at 60 Hz.
#[derive(Parser, Clone, Debug)]
#[command(name = "bench", version)]
pub struct Args {
    /// Measurement.
    #[arg(value_enum)]
    pub what: What,

    /// Particles along each side [default: 64, 128, 256 and 512; 64 and 256 for kernels]; of no meaning for flags.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=4096))]
    pub size: Option<u32>,

    /// Colliders with these words in their names alone; of no meaning for others.
    #[arg(long, value_name = "NAME")]
    pub shape: Option<String>,

    /// Steps of each measurement [default: 300, of flags 60].
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: Option<u32>,

    /// Threads of the compute pool [default: one for each core]; a sheet of less than 16,384 particles has one.
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// The instructions that the chain solver uses; the classic relaxation is scalar. Kernels are measured with each, if none
    /// is given.
    #[arg(long, value_enum, default_value_t = Isa::Auto)]
    pub isa: Isa,

    /// Writes the figures to this file, as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Measurement.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// A sheet that swings down from two corners.
    Hang,
    /// A sheet that falls on a sphere: free, and held by two corners.
    Drape,
    /// 1,000 flags of 32 × 32 in the wind.
    Flags,
    /// Each kernel of the solvers by itself, on one thread; a machine without an instruction set uses the best below.
    Kernels,
    /// Cost of colliders of each shape, with a sheet of 128 × 128 unless `--size` is given.
    Colliders,
    /// Cost of a game's systems within a substep.
    Substep,
    /// All sheets: hang, drape, flags.
    All,
}

/// The instructions that the kernels use.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// The best of this machine.
    Auto,
    /// One number at a time.
    Scalar,
    /// 4 numbers at a time.
    Sse2,
    /// 8 numbers at a time.
    Avx2,
    /// 16 numbers at a time.
    Avx512,
}

impl From<Isa> for ClothInstructionSet {
    fn from(isa: Isa) -> Self {
        match isa {
            Isa::Auto => Self::Auto,
            Isa::Scalar => Self::Scalar,
            Isa::Sse2 => Self::Sse2,
            Isa::Avx2 => Self::Avx2,
            Isa::Avx512 => Self::Avx512,
        }
    }
}
