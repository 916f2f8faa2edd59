//! Pictures of the window, saved to the current folder.

use std::{
    fs::OpenOptions,
    io::{self, Cursor, Write},
    path::{Path, PathBuf},
};

use bevy::{
    image::Image,
    prelude::*,
    render::view::screenshot::{Screenshot, ScreenshotCaptured},
};
use image::ImageFormat;

use super::{ask::Ask, notices::Notices};

/// Takes pictures of the window when they are asked for.
pub struct PhotoPlugin;

impl Plugin for PhotoPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, take_pictures);
    }
}

fn take_pictures(
    mut commands: Commands,
    mut asks: MessageReader<Ask>,
    mut notices: ResMut<Notices>,
) {
    if !asks.read().any(|ask| *ask == Ask::Picture) {
        return;
    }
    // They would be in the picture.
    notices.clear_done();
    commands.spawn(Screenshot::primary_window()).observe(
        |captured: On<ScreenshotCaptured>, mut notices: ResMut<Notices>| match save_new(
            Path::new("."),
            &captured.image,
        ) {
            Ok(path) => notices.done(format!("picture saved to {}", path.display())),
            Err(reason) => notices.wrong(format!("the picture cannot be saved: {reason}")),
        },
    );
}

/// Saves a picture under a name that is new in this folder: `tailorbird-0001.png` and so on. Returns where it is.
///
/// # Errors
/// Why it is not saved, in words.
pub fn save_new(folder: &Path, picture: &Image) -> Result<PathBuf, String> {
    let picture = picture
        .clone()
        .try_into_dynamic()
        .map_err(|error| error.to_string())?;
    let mut bytes = Cursor::new(Vec::new());
    picture
        .to_rgb8()
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    for number in 1..10_000 {
        let path = folder.join(format!("tailorbird-{number:04}.png"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut file) => {
                let written = file.write_all(bytes.get_ref());
                return written
                    .map(|()| path.clone())
                    .map_err(|error| format!("{}: {error}", path.display()));
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(format!("{}: {error}", path.display())),
        }
    }
    Err("there are 9999 pictures in this folder".into())
}
