//! Pictures that move: GIF, 256 colours for all pictures together, and of each picture only what changed.

use std::collections::HashMap;

use bevy::prelude::{ColorToPacked, LinearRgba, Srgba};
use color_quant::NeuQuant;
use gif::{Encoder, EncodingError, Frame, Repeat};
use image::RgbImage;
use thiserror::Error;

use super::shrink::shrink;

/// Properties of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Animation {
    /// Width [pixels].
    pub width: u16,
    /// Height [pixels].
    pub height: u16,
    /// Time for which each picture is shown [10 ms].
    pub delay: u16,
}

/// Why there is no animation.
#[derive(Debug, Error)]
pub enum AnimationError {
    /// The format does not allow it.
    #[error("{0}")]
    Encode(#[from] EncodingError),
    /// More than a page should load.
    #[error("the animation has {bytes} bytes; {} are allowed", Animation::LARGEST)]
    TooLarge {
        /// Its size.
        bytes: usize,
    },
}

/// The index that leaves a pixel as it was; the colours are those before it.
const UNCHANGED: u8 = 255;
/// Largest change of a colour by dithering, up or down [-], out of 255: about the distance of neighbours in the palette.
const DITHER: f32 = 2.5;
/// Of how many pictures one is looked at for the palette.
const PICTURES_FOR_PALETTE: usize = 4;

impl Animation {
    /// Largest size of a file [bytes].
    pub const LARGEST: usize = 4_000_000;

    /// The file, which plays again and again.
    ///
    /// # Errors
    /// When it is too large.
    pub fn encode(self, pictures: &[RgbImage]) -> Result<Vec<u8>, AnimationError> {
        let (width, height) = (u32::from(self.width), u32::from(self.height));
        let pictures: Vec<Vec<LinearRgba>> = pictures
            .iter()
            .map(|picture| shrink(picture, width, height))
            .collect();
        let mut palette = Palette::of(&pictures);
        let mut encoder = Encoder::new(Vec::new(), self.width, self.height, &palette.colors())?;
        encoder.set_repeat(Repeat::Infinite)?;
        let mut shown = vec![UNCHANGED; (width * height) as usize];
        for picture in &pictures {
            let next = palette.indices(picture, width as usize);
            encoder.write_frame(&self.change(&shown, &next))?;
            shown = next;
        }
        let file = encoder.into_inner()?;
        Self::allowed(file)
    }

    fn allowed(file: Vec<u8>) -> Result<Vec<u8>, AnimationError> {
        match file.len() {
            bytes if bytes > Self::LARGEST => Err(AnimationError::TooLarge { bytes }),
            _ => Ok(file),
        }
    }

    /// The smallest box with all pixels that change, and in it those alone.
    fn change(self, shown: &[u8], next: &[u8]) -> Frame<'static> {
        let width = usize::from(self.width);
        let changed = (0..next.len()).filter(|&i| shown[i] != next[i]);
        let bounds = changed.fold(None, |bounds, i| {
            let (x, y) = (i % width, i / width);
            let (left, top, right, bottom) = bounds.unwrap_or((x, y, x, y));
            Some((left.min(x), top.min(y), right.max(x), bottom.max(y)))
        });
        // Where nothing changes there is a picture all the same, for its time.
        let (left, top, right, bottom) = bounds.unwrap_or_default();
        let pixels = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
        let buffer = pixels.map(|i| {
            if shown[i] == next[i] {
                UNCHANGED
            } else {
                next[i]
            }
        });
        Frame {
            delay: self.delay,
            transparent: Some(UNCHANGED),
            left: left as u16,
            top: top as u16,
            width: (right - left + 1) as u16,
            height: (bottom - top + 1) as u16,
            buffer: buffer.collect::<Vec<u8>>().into(),
            ..Frame::default()
        }
    }
}

/// The colours of an animation.
struct Palette {
    network: NeuQuant,
    known: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn of(pictures: &[Vec<LinearRgba>]) -> Self {
        let some = pictures.iter().step_by(PICTURES_FOR_PALETTE).flatten();
        let pixels: Vec<u8> = some
            .flat_map(|&light| Srgba::from(light).to_u8_array())
            .collect();
        Self {
            network: NeuQuant::new(3, usize::from(UNCHANGED), &pixels),
            known: HashMap::new(),
        }
    }

    /// One after the other; the last one stands for what is unchanged.
    fn colors(&self) -> Vec<u8> {
        let mut colors = self.network.color_map_rgb();
        colors.extend([0; 3]);
        colors
    }

    /// The best colour of each pixel, in a pattern that stands still where the picture does.
    fn indices(&mut self, picture: &[LinearRgba], width: usize) -> Vec<u8> {
        let pixels = picture.iter().enumerate().map(|(i, &light)| {
            let shift = DITHER * threshold(i % width, i / width);
            let color = Srgba::from(light);
            let key = [color.red, color.green, color.blue]
                .map(|part| (part * 255.0 + shift).round().clamp(0.0, 255.0) as u8);
            let network = &self.network;
            *self.known.entry(key).or_insert_with(|| {
                let [red, green, blue] = key;
                network.index_of(&[red, green, blue, 255]) as u8
            })
        });
        pixels.collect()
    }
}

/// Bayer's pattern of 8×8, from -1 to 1.
fn threshold(x: usize, y: usize) -> f32 {
    let mut rank = 0;
    for bit in 0..3 {
        let (x, y) = (x >> bit & 1, y >> bit & 1);
        rank = rank << 2 | (x ^ y) << 1 | y;
    }
    (rank as f32 + 0.5) / 32.0 - 1.0
}

#[cfg(test)]
mod tests {
    use gif::{ColorOutput, DecodeOptions};
    use image::Rgb;

    use super::*;

    const SMALL: Animation = Animation {
        width: 32,
        height: 18,
        delay: 7,
    };

    /// A green box that moves over a grey slope.
    fn pictures(count: u32) -> Vec<RgbImage> {
        let picture = |step| {
            RgbImage::from_fn(64, 36, |x, y| {
                let inside = (10 * step..10 * step + 12).contains(&x) && (8..20).contains(&y);
                Rgb(if inside {
                    [20, 180, 60]
                } else {
                    [100 + x as u8; 3]
                })
            })
        };
        (0..count).map(picture).collect()
    }

    /// Pictures that a viewer shows, one after the other, and the number of bytes that each one changes.
    fn play(file: &[u8]) -> Vec<(Vec<[u8; 3]>, usize)> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::RGBA);
        let mut decoder = options.read_info(file).unwrap();
        assert!(matches!(decoder.repeat(), Repeat::Infinite));
        let width = usize::from(decoder.width());
        let mut canvas = vec![[0; 3]; width * usize::from(decoder.height())];
        let mut shown = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!(frame.delay, SMALL.delay);
            for (i, pixel) in frame.buffer.chunks(4).enumerate() {
                let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
                if pixel[3] > 0 {
                    let at = (y + usize::from(frame.top)) * width + x + usize::from(frame.left);
                    canvas[at] = [pixel[0], pixel[1], pixel[2]];
                }
            }
            shown.push((canvas.clone(), frame.buffer.len() / 4));
        }
        shown
    }

    #[test]
    fn a_viewer_shows_the_pictures() {
        let pictures = pictures(4);
        let shown = play(&SMALL.encode(&pictures).unwrap());
        assert_eq!(shown.len(), 4);
        for (picture, (canvas, _)) in pictures.iter().zip(&shown) {
            for (i, light) in shrink(picture, 32, 18).into_iter().enumerate() {
                let wanted = Srgba::from(light).to_u8_array();
                let worst = (0..3)
                    .map(|c| wanted[c].abs_diff(canvas[i][c]))
                    .max()
                    .unwrap();
                assert!(
                    worst <= 24,
                    "pixel {i}: {wanted:?} is shown as {:?}",
                    canvas[i]
                );
            }
        }
    }

    #[test]
    fn what_does_not_change_is_not_written_again() {
        let mut pictures = pictures(2);
        pictures.push(pictures[1].clone());
        let written: Vec<usize> = play(&SMALL.encode(&pictures).unwrap())
            .iter()
            .map(|(_, count)| *count)
            .collect();
        assert_eq!(written[0], 32 * 18);
        assert!(written[1] <= 12 * 7, "{written:?}");
        assert_eq!(written[2], 1);
    }

    #[test]
    fn a_large_file_is_refused() {
        assert!(Animation::allowed(vec![0; Animation::LARGEST]).is_ok());
        let Err(error) = Animation::allowed(vec![0; Animation::LARGEST + 1]) else {
            panic!("it is too large");
        };
        let error = error.to_string();
        assert!(
            error.contains("4000001 bytes; 4000000 are allowed"),
            "{error}"
        );
    }

    #[test]
    fn dithering_is_even() {
        let all: Vec<f32> = (0..64).map(|i| threshold(i % 8, i / 8)).collect();
        assert!(all.iter().sum::<f32>().abs() < 1e-4);
        let mut ranks: Vec<i32> = all.iter().map(|t| (t * 64.0) as i32).collect();
        ranks.sort_unstable();
        ranks.dedup();
        assert!(ranks.len() >= 63, "{ranks:?}");
    }
}
