//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::peers::PeerKind;

/// Measures other cloth solvers on the scene `hang`: a sheet of 2 m × 2 m that starts horizontal and hangs by two
/// corners, 300 steps at 60 Hz, one thread.
#[derive(Parser, Debug)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,

    #[command(flatten)]
    pub measure: MeasureArgs,
}

/// Other commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Draw mean stretch against time from one or more JSON files.
    Plot(PlotArgs),
}

/// Choice of measurements.
#[derive(Args, Debug)]
pub struct MeasureArgs {
    /// Particles along a side; repeat it for several.
    #[arg(long = "size", value_name = "N", default_values_t = [64],
          value_parser = clap::value_parser!(u16).range(2..=512))]
    pub sizes: Vec<u16>,

    /// Passes over the constraints in a step; repeat it for several.
    #[arg(long, value_name = "K", default_values_t = [15], value_parser = clap::value_parser!(u8).range(1..))]
    pub iterations: Vec<u8>,

    /// Solver to measure; repeat it for several [default: all that are built].
    #[arg(long = "peer", value_name = "PEER")]
    pub peers: Vec<PeerKind>,

    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Figures to draw.
#[derive(Args, Debug)]
pub struct PlotArgs {
    /// JSON files with figures.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// The picture to write, SVG.
    #[arg(long, value_name = "FILE", default_value = "stretch.svg")]
    pub out: PathBuf,

    /// Scene whose figures are drawn.
    #[arg(long, value_name = "NAME", default_value = crate::scene::NAME)]
    pub scene: String,
}
