//! Smaller copies of a texture, so that a weave far away is a calm area instead of a flickering pattern.

use bevy_image::Image;
use bevy_math::Vec3;
use bevy_render::render_resource::TextureFormat;

/// Meaning of the numbers of a texture, which decides how they are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    /// Colours in sRGB: the mean is that of the light.
    Color,
    /// Colours with holes, for an alpha test: as many texels of a smaller copy are holes as the mean says, the others are none. A sampler
    /// that takes means of copies (`mipmap_filter`, `anisotropy_clamp`) would undo it.
    Cutout,
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
    let has_holes = texels == Texels::Cutout;
    // What is written are zeros and ones, what is averaged further are their means.
    let mut cover: Vec<f32> = if has_holes {
        data.chunks_exact(4)
            .map(|texel| f32::from(texel[3]) / 255.0)
            .collect()
    } else {
        Vec::new()
    };
    data.reserve(data.len() / 2);
    while width > 1 && height > 1 {
        let (next_width, next_height) = (width / 2, height / 2);
        let first = data.len();
        let mut next_cover = Vec::new();
        for y in 0..next_height {
            for x in 0..next_width {
                let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
                    .map(|(dx, dy)| (2 * y + dy) * width + 2 * x + dx);
                if has_holes {
                    next_cover.push(0.25 * four.iter().map(|i| cover[*i]).sum::<f32>());
                }
                let four = four.map(|i| {
                    let at = start + 4 * i;
                    [data[at], data[at + 1], data[at + 2], data[at + 3]]
                });
                data.extend_from_slice(&mean(four, texels, &linear));
            }
        }
        if has_holes {
            scatter(&mut data[first..], next_cover.clone(), next_width);
            cover = next_cover;
        }
        start += 4 * width * height;
        (width, height) = (next_width, next_height);
        levels += 1;
    }
    full.texture_descriptor.mip_level_count = levels;
    full
}

/// Makes texels open or not, so that as many of them are covered around each place as the mean says: a net from afar is sheer, where a
/// threshold would close or lose it. By error diffusion (Floyd and Steinberg 1976; for alpha tests: Yuksel 2018).
fn scatter(texels: &mut [u8], mut cover: Vec<f32>, width: usize) {
    let height = cover.len() / width;
    for y in 0..height {
        for step in 0..width {
            // To and fro, and not quite at a half: else even areas turn into stripes.
            let (x, ahead) = if y % 2 == 0 {
                (step, 1)
            } else {
                (width - 1 - step, width - 1)
            };
            let at = y * width + x;
            let wanted = cover[at];
            let covered = wanted > 0.5 + 0.25 * noise(at);
            texels[4 * at + 3] = if covered { 255 } else { 0 };
            let error = wanted - f32::from(u8::from(covered));
            // Tiles repeat from left to right.
            let beside = |by: usize| (x + by) % width;
            let mut give = |x: usize, y: usize, part: f32| {
                if y < height {
                    cover[y * width + x] += part * error;
                }
            };
            give(beside(ahead), y, 7.0 / 16.0);
            give(beside(width - ahead), y + 1, 3.0 / 16.0);
            give(x, y + 1, 5.0 / 16.0);
            give(beside(ahead), y + 1, 1.0 / 16.0);
        }
    }
}

/// From -1 to 1, the same for the same number.
fn noise(i: usize) -> f32 {
    let mut bits = (i as u32).wrapping_mul(0x9e37_79b9);
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x85eb_ca6b);
    (bits >> 8) as f32 / (1 << 23) as f32 - 1.0
}

fn mean(four: [[u8; 4]; 4], texels: Texels, linear: &[f32; 256]) -> [u8; 4] {
    let plain = |i: usize| four.iter().map(|texel| f32::from(texel[i])).sum::<f32>() / 1020.0;
    let [r, g, b] = match texels {
        // An exponent of 2.2 is near enough to sRGB's curve for a mean.
        Texels::Color | Texels::Cutout => [0, 1, 2].map(|i| {
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
    fn from_afar_as_much_is_open() {
        const SIDE: u32 = 256;
        // A net, and beside it what is closed and what is open.
        let texel = |i: u32| {
            let (x, y) = (i % SIDE, i / SIDE);
            let closed = match x / 64 {
                0 | 1 => x % 8 < 2 || y % 8 < 1,
                column => column == 2,
            };
            [200, 200, 200, if closed { 255 } else { 0 }]
        };
        let size = Extent3d {
            width: SIDE,
            height: SIDE,
            depth_or_array_layers: 1,
        };
        let full = Image::new(
            size,
            TextureDimension::D2,
            (0..SIDE * SIDE).flat_map(texel).collect(),
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::RENDER_WORLD,
        );
        let data = with_mipmaps(full, Texels::Cutout).data.unwrap_or_default();
        let (mut start, mut side) = (0, SIDE as usize);
        // 1 - 6/8 · 7/8 of the net is closed.
        let expected = [0.34375, 0.34375, 1.0, 0.0];
        while side >= 32 {
            let level = &data[start..start + 4 * side * side];
            let mut covered = [0.0; 4];
            for (i, texel) in level.chunks(4).enumerate() {
                assert!(texel[3] == 0 || texel[3] == 255);
                covered[4 * (i % side) / side] += f32::from(texel[3]) / 255.0;
            }
            for (found, expected) in covered.iter().zip(expected) {
                let found = 4.0 * found / (side * side) as f32;
                assert!(
                    (found - expected).abs() < 0.02,
                    "{side}: {found} {expected}"
                );
            }
            start += level.len();
            side /= 2;
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
