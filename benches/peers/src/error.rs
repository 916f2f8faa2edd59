//! Errors.

use std::{io, path::PathBuf};

use thiserror::Error;

/// An error of the benchmark.
#[derive(Error, Debug)]
pub enum Error {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },

    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },

    /// A file is not an array of records.
    #[error("{path} is not an array of figures: {source}")]
    Format {
        /// The file.
        path: PathBuf,
        /// The cause, and its place.
        source: serde_json::Error,
    },

    /// Figures cannot be written as JSON.
    #[error("cannot write the figures as JSON: {0}")]
    Json(serde_json::Error),

    /// A peer was asked for that this program was built without.
    #[cfg(not(feature = "bevy_silk"))]
    #[error("{peer} is not built in; build with --features {feature}")]
    NotBuilt {
        /// Its name.
        peer: &'static str,
        /// Feature that brings it.
        feature: &'static str,
    },

    /// No measurement ended well.
    #[error("no solver came through")]
    NothingMeasured,

    /// No record is about the scene, or none fits on logarithmic axes.
    #[error(
        "nothing to draw: no figures of the scene `{0}` with a time and a mean stretch above zero"
    )]
    NothingToDraw(String),

    /// The picture cannot be drawn.
    #[error("cannot draw {path}: {reason}")]
    Drawing {
        /// The picture.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}
