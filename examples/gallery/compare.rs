//! Pictures against the stored ones.

use std::path::{Path, PathBuf};

use image::RgbImage;
use thiserror::Error;

use super::difference::{Difference, Proportions, TOLERANCE};

/// Why a picture does not pass.
#[derive(Debug, Error)]
pub enum CompareError {
    /// It is not there, or is no picture.
    #[error("{}: {source}", path.display())]
    Read {
        /// Its path.
        path: PathBuf,
        /// The cause.
        source: image::ImageError,
    },
    /// It has another shape than the stored one.
    #[error("{}: {source}", path.display())]
    Shape {
        /// Its path.
        path: PathBuf,
        /// The cause.
        source: Proportions,
    },
    /// It looks otherwise.
    #[error("{} looks otherwise than {}: {found} (allowed: {TOLERANCE})", path.display(), stored.display())]
    Differs {
        /// Its path.
        path: PathBuf,
        /// The path of the stored one.
        stored: PathBuf,
        /// By how much.
        found: Difference,
    },
}

/// The name of a scene's still in a folder of pictures.
pub fn still(dir: &Path, scene: &str) -> PathBuf {
    dir.join(format!("{scene}.png"))
}

/// Compares the still of a scene in `dir` with the one in `stored`.
///
/// # Errors
/// When one of them cannot be read, or they differ by more than [`TOLERANCE`].
pub fn compare(scene: &str, dir: &Path, stored: &Path) -> Result<Difference, CompareError> {
    let (path, stored) = (still(dir, scene), still(stored, scene));
    match Difference::between(&read(&path)?, &read(&stored)?) {
        Ok(found) if found.within(TOLERANCE) => Ok(found),
        Ok(found) => Err(CompareError::Differs {
            path,
            stored,
            found,
        }),
        Err(source) => Err(CompareError::Shape { path, source }),
    }
}

fn read(path: &Path) -> Result<RgbImage, CompareError> {
    match image::open(path) {
        Ok(picture) => Ok(picture.to_rgb8()),
        Err(source) => Err(CompareError::Read {
            path: path.into(),
            source,
        }),
    }
}
