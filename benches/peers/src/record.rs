//! One measurement, as it is written and read.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};

use crate::error::Error;

/// One measurement.
#[derive(Serialize, Deserialize, Debug, Clone)]
pub struct Record {
    /// Name of the solver.
    pub solver: String,
    /// On which scene.
    pub scene: String,
    /// Particles along a side.
    pub size: u32,
    /// Passes over the constraints in a step.
    pub passes: u32,
    /// Median time for a step [ms].
    pub ms: f64,
    /// max(0, l / L − 1) of the structural edges in the last quarter: mean [-].
    pub stretch_mean: f64,
    /// The value that 99 % do not exceed [-].
    pub stretch_p99: f64,
    /// The largest [-].
    pub stretch_max: f64,
}

/// The records of a file.
///
/// # Errors
/// When the file cannot be read, or is not an array of records.
pub fn read(path: &Path) -> Result<Vec<Record>, Error> {
    let text = fs::read_to_string(path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    serde_json::from_str(&text).map_err(|source| Error::Format {
        path: path.to_owned(),
        source,
    })
}

/// Writes records to a file.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, records: &[Record]) -> Result<(), Error> {
    let mut text = serde_json::to_string_pretty(records).map_err(Error::Json)?;
    text.push('\n');
    fs::write(path, text).map_err(|source| Error::Write {
        path: path.to_owned(),
        source,
    })
}
