//! Mutants that may survive, each with its reason.

use std::{error::Error, fs, path::Path};

use serde::Deserialize;

/// The list, as it is written.
#[derive(Default, Deserialize)]
pub struct Known {
    #[serde(default)]
    survivor: Vec<Survivor>,
}

#[derive(Deserialize)]
struct Survivor {
    file: String,
    /// Its line, without the space around.
    code: String,
    /// Changes, as the table says them; several where they have one reason.
    changes: Vec<String>,
    /// Why no test can tell, or need not.
    #[serde(rename = "reason")]
    _reason: String,
}

impl Known {
    /// Reads the list; there are none where there is no file.
    pub fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        if !path.exists() {
            return Ok(Self::default());
        }
        Ok(toml::from_str(&fs::read_to_string(path)?)?)
    }

    /// Returns whether a mutant may survive.
    pub fn is(&self, file: &str, code: &str, change: &str) -> bool {
        self.survivor.iter().any(|one| {
            one.file == file && one.code == code && one.changes.iter().any(|of| of == change)
        })
    }
}
