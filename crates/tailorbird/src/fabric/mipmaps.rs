//! Smaller copies of a texture, so that a weave far away is a calm area instead of a flickering pattern.

use bevy_image::Image;
use bevy_math::Vec3;
use bevy_render::render_resource::TextureFormat;

/// What the numbers of a texture are, and so what their mean is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    /// Colours in sRGB: the mean is that of the light. Where some of it is open, the smaller copies are open in the same part.
    Color,
    /// Directions: the mean has unit length.
    Normal,
    /// Plain numbers.
    Value,
}

/// The texture with all its smaller copies. One that is not of four bytes per texel, or has copies, stays as it is.
pub fn with_mipmaps(mut full: Image, texels: Texels) -> Image {
    let format = full.texture_descriptor.format;
    let bytes = [TextureFormat::Rgba8Unorm, TextureFormat::Rgba8UnormSrgb];
    if !bytes.contains(&format) || full.texture_descriptor.mip_level_count > 1 {
        return full;
    }
    let (mut width, mut height) = (full.width() as usize, full.height() as usize);
    let Some(data) = full
        .data
        .as_mut()
        .filter(|data| data.len() == 4 * width * height)
    else {
        return full;
    };
    let linear: [f32; 256] = std::array::from_fn(|v| (v as f32 / 255.0).powf(2.2));
    let mut start = 0;
    let mut levels = 1;
    data.reserve(data.len() / 2);
    while width > 1 && height > 1 {
        let (next_width, next_height) = (width / 2, height / 2);
        for y in 0..next_height {
            for x in 0..next_width {
                let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
                    let at = start + 4 * ((2 * y + dy) * width + 2 * x + dx);
                    [data[at], data[at + 1], data[at + 2], data[at + 3]]
                });
                data.extend_from_slice(&mean(four, texels, &linear));
            }
        }
        start += 4 * width * height;
        (width, height) = (next_width, next_height);
        levels += 1;
    }
    full.texture_descriptor.mip_level_count = levels;
    full
}

fn mean(four: [[u8; 4]; 4], texels: Texels, linear: &[f32; 256]) -> [u8; 4] {
    let plain = |i: usize| four.iter().map(|texel| f32::from(texel[i])).sum::<f32>() / 1020.0;
    let [r, g, b] = match texels {
        // An exponent of 2.2 is near enough to sRGB's curve for a mean.
        Texels::Color => [0, 1, 2].map(|i| {
            let sum: f32 = four.iter().map(|texel| linear[usize::from(texel[i])]).sum();
            (0.25 * sum).powf(1.0 / 2.2)
        }),
        Texels::Value => [0, 1, 2].map(plain),
        Texels::Normal => {
            let sum = Vec3::from_array([0, 1, 2].map(|i| 2.0 * plain(i) - 1.0));
            (0.5 * sum.normalize_or(Vec3::Z) + 0.5).to_array()
        }
    };
    [r, g, b, plain(3)].map(|v| (v * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use bevy_asset::RenderAssetUsages;
    use bevy_render::render_resource::{Extent3d, TextureDimension};

    use super::*;

    fn checkers(texels: Texels, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
        let data = (0..64).flat_map(|i| texel(i % 8, i / 8)).collect();
        let size = Extent3d {
            width: 8,
            height: 8,
            depth_or_array_layers: 1,
        };
        let format = if texels == Texels::Color {
            TextureFormat::Rgba8UnormSrgb
        } else {
            TextureFormat::Rgba8Unorm
        };
        let usage = RenderAssetUsages::RENDER_WORLD;
        let full = Image::new(size, TextureDimension::D2, data, format, usage);
        let made = with_mipmaps(full, texels);
        assert_eq!(made.texture_descriptor.mip_level_count, 4);
        let data = made.data.unwrap_or_default();
        assert_eq!(data.len(), 4 * (64 + 16 + 4 + 1));
        data[4 * 64..].to_vec()
    }

    #[test]
    fn from_afar_a_texture_has_its_mean_light() {
        let black_and_white = |x: u32, y: u32| [[255; 4], [0, 0, 0, 255]][((x + y) % 2) as usize];
        for texel in checkers(Texels::Color, black_and_white).chunks(4) {
            // Half the light is 186 of 255 in sRGB.
            assert_eq!(texel, [186, 186, 186, 255]);
        }
        for texel in checkers(Texels::Value, black_and_white).chunks(4) {
            assert_eq!(texel, [128, 128, 128, 255]);
        }
    }

    #[test]
    fn from_afar_normals_have_unit_length() {
        let ridges = |x: u32, _: u32| [[218, 128, 218, 255], [37, 128, 218, 255]][(x % 2) as usize];
        for texel in checkers(Texels::Normal, ridges).chunks(4) {
            assert!(texel[0].abs_diff(128) <= 1 && texel[2] >= 254, "{texel:?}");
        }
    }
}
