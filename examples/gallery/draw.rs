//! Plays a scene once and takes its pictures.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use bevy::prelude::*;
use image::RgbImage;
use thiserror::Error;

use crate::{
    animation::{Animation, AnimationError},
    common::{
        graphics::check_driver,
        offscreen::{Offscreen, OffscreenError, OffscreenOptions},
        scenes::SceneKind,
        script::Script,
        settings::DemoSettings,
    },
    compare::still,
    shots::Shots,
    shrink::shrink_picture,
};

/// Pictures to draw, and their folder.
#[derive(Clone, Debug)]
pub struct Gallery {
    /// The folder; it is made if it does not exist.
    pub dir: PathBuf,
    /// Width and height of a still [pixels].
    pub size: UVec2,
    /// With animations.
    pub animated: bool,
    /// Drawn twice as wide and high, and shrunk.
    pub fine: bool,
    /// Time by which the pictures are taken later than chosen [s].
    pub later: f32,
}

/// A file that was written.
#[derive(Clone, Debug)]
pub struct Written {
    /// Its path.
    pub path: PathBuf,
    /// Its size [bytes].
    pub bytes: u64,
}

/// Why there are no pictures.
#[derive(Debug, Error)]
pub enum DrawError {
    /// Nothing to draw with, or no pictures came of it.
    #[error("{scene}: {source}")]
    Draw {
        /// Of which scene.
        scene: SceneKind,
        /// The cause.
        source: OffscreenError,
    },
    /// A script of a scene cannot be read.
    #[error("the script of {scene}: {why}")]
    Script {
        /// The scene.
        scene: SceneKind,
        /// Line, and what is wrong there.
        why: String,
    },
    /// An animation that is not as it should be.
    #[error("{}: {source}", path.display())]
    Animation {
        /// Path that it would have been written to.
        path: PathBuf,
        /// The cause.
        source: AnimationError,
    },
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// Its path.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A picture cannot be written.
    #[error("{}: {source}", path.display())]
    Save {
        /// Its path.
        path: PathBuf,
        /// The cause.
        source: image::ImageError,
    },
}

impl Gallery {
    /// The width of an animation, where the stills have that much [pixels].
    const ANIMATION_WIDTH: u32 = 320;

    /// Draws a scene, and says what it wrote.
    ///
    /// # Errors
    /// When there is no graphics driver, an animation is too large, or a file cannot be written.
    pub fn draw(&self, scene: SceneKind) -> Result<Vec<Written>, DrawError> {
        fs::create_dir_all(&self.dir).map_err(|source| DrawError::Write {
            path: self.dir.clone(),
            source,
        })?;
        let shots = self.shots(scene)?;
        let still_frame = shots.still_frame();
        let mut pictures = self.play(scene, &shots.script, self.size, &[still_frame])?;
        let Some(picture) = pictures.pop() else {
            let source = OffscreenError::Missing(1);
            return Err(DrawError::Draw { scene, source });
        };
        let path = still(&self.dir, scene.name());
        picture.save(&path).map_err(|source| DrawError::Save {
            path: path.clone(),
            source,
        })?;
        let mut files = vec![written(path)?];
        if self.animated {
            let path = self.dir.join(format!("{scene}.gif"));
            let size = self.animation_size();
            let pictures = self.play(scene, &shots.script, size, &shots.animation_frames())?;
            write_animation(&pictures, size, &path)?;
            files.push(written(path)?);
        }
        Ok(files)
    }

    fn shots(&self, scene: SceneKind) -> Result<Shots, DrawError> {
        let mut shots = Shots::of(scene).map_err(|why| DrawError::Script { scene, why })?;
        shots.still += self.later;
        shots.start += self.later;
        Ok(shots)
    }

    /// A small picture is drawn several times as fast as a still.
    fn animation_size(&self) -> UVec2 {
        let width = self.size.x.min(Self::ANIMATION_WIDTH);
        UVec2::new(width, (width * self.size.y / self.size.x).clamp(1, 2048))
    }

    /// Plays a scene up to the last of these frames, and returns the pictures of them.
    fn play(
        &self,
        scene: SceneKind,
        script: &Script,
        size: UVec2,
        frames: &[u32],
    ) -> Result<Vec<RgbImage>, DrawError> {
        let failed = |source| DrawError::Draw { scene, source };
        check_driver().map_err(|why| failed(OffscreenError::NoDriver(why)))?;
        let mut stage = Offscreen::new(&OffscreenOptions {
            dir: self.dir.clone(),
            seconds: 0.0,
            every: Shots::FRAME,
            size: if self.fine { 2 * size } else { size },
            fine: false,
            settings: DemoSettings::of(scene),
            script: script.clone(),
        });
        for frame in 0..=frames.last().copied().unwrap_or_default() {
            if frames.contains(&frame) {
                stage.keep_picture(Shots::FRAME);
            } else {
                stage.play(Shots::FRAME);
            }
        }
        let pictures = stage.finish_kept().map_err(failed)?;
        Ok(match self.fine {
            true => pictures
                .iter()
                .map(|picture| shrink_picture(picture, size.x, size.y))
                .collect(),
            false => pictures,
        })
    }
}

fn write_animation(pictures: &[RgbImage], size: UVec2, path: &Path) -> Result<(), DrawError> {
    let animation = Animation {
        width: size.x as u16,
        height: size.y as u16,
        delay: Shots::DELAY,
    };
    let file = animation
        .encode(pictures)
        .map_err(|source| DrawError::Animation {
            path: path.into(),
            source,
        })?;
    fs::write(path, file).map_err(|source| DrawError::Write {
        path: path.into(),
        source,
    })
}

fn written(path: PathBuf) -> Result<Written, DrawError> {
    match fs::metadata(&path) {
        Ok(file) => Ok(Written {
            bytes: file.len(),
            path,
        }),
        Err(source) => Err(DrawError::Write { path, source }),
    }
}
