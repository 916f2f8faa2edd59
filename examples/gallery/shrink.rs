//! Smaller pictures: means over boxes of pixels, of light and not of stored bytes.

use bevy::prelude::{ColorToPacked, LinearRgba, Srgba};
use image::{Rgb, RgbImage};

/// The picture in this width and height [pixels], row by row. Where it is smaller than that, pixels repeat.
pub fn shrink(picture: &RgbImage, width: u32, height: u32) -> Vec<LinearRgba> {
    let light: Vec<f32> = (0..=u8::MAX)
        .map(|byte| LinearRgba::from(Srgba::rgb_u8(byte, byte, byte)).red)
        .collect();
    let mut shrunk = Vec::with_capacity((width * height) as usize);
    for row in 0..height {
        let rows = part(row, height, picture.height());
        for column in 0..width {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for y in rows.clone() {
                for x in part(column, width, picture.width()) {
                    let pixel = picture.get_pixel(x, y).0;
                    for (sum, byte) in sum.iter_mut().zip(pixel) {
                        *sum += light[usize::from(byte)];
                    }
                    count += 1.0;
                }
            }
            let [red, green, blue] = sum.map(|sum| sum / count);
            shrunk.push(LinearRgba::rgb(red, green, blue));
        }
    }
    shrunk
}

/// The same as a picture.
pub fn shrink_picture(picture: &RgbImage, width: u32, height: u32) -> RgbImage {
    let shrunk = shrink(picture, width, height);
    RgbImage::from_fn(width, height, |x, y| {
        let light = shrunk[(y * width + x) as usize];
        Rgb(Srgba::from(light).to_u8_array_no_alpha())
    })
}

/// The pixels out of `length` that the one at `index` out of `shrunk` stands for; never none.
fn part(index: u32, shrunk: u32, length: u32) -> std::ops::Range<u32> {
    let start = index * length / shrunk;
    start..((index + 1) * length / shrunk).max(start + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_white_give_half_the_light() {
        let board = RgbImage::from_fn(
            8,
            6,
            |x, y| Rgb([if (x + y) % 2 == 0 { 255 } else { 0 }; 3]),
        );
        let shrunk = shrink(&board, 4, 3);
        assert_eq!(shrunk.len(), 12);
        assert!(shrunk.iter().all(|light| (light.red - 0.5).abs() < 1e-6));
    }

    #[test]
    fn a_picture_of_its_own_size_stays_as_it_is() {
        let picture = RgbImage::from_fn(16, 16, |x, y| Rgb([(16 * y + x) as u8; 3]));
        assert_eq!(shrink_picture(&picture, 16, 16), picture);
    }

    #[test]
    fn every_pixel_counts_once() {
        for (shrunk, length) in [(160, 640), (160, 333), (7, 7)] {
            let parts: Vec<u32> = (0..shrunk).flat_map(|i| part(i, shrunk, length)).collect();
            assert_eq!(parts, (0..length).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_smaller_picture_is_repeated() {
        let picture = RgbImage::from_pixel(3, 2, Rgb([255; 3]));
        assert!(shrink(&picture, 16, 9).iter().all(|light| light.red == 1.0));
    }
}
