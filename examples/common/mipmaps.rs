//! Smaller copies of a texture, so that a weave far away is a calm area instead of a flickering pattern.

use bevy::{
    asset::RenderAssetUsages,
    image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use image::RgbaImage;

/// What the numbers of a texture are, and so what their mean is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    /// Colours in sRGB: the mean is that of the light.
    Color,
    /// Directions: the mean has unit length.
    Normal,
    /// Plain numbers.
    Value,
}

/// A texture that repeats, with all its smaller copies.
pub fn with_mipmaps(full: &RgbaImage, texels: Texels) -> Image {
    let (width, height) = full.dimensions();
    let mut data = Vec::with_capacity(full.len() * 4 / 3 + 4);
    let mut level = full.clone();
    let mut levels = 1;
    data.extend_from_slice(&level);
    while level.width() > 1 && level.height() > 1 {
        level = halved(&level, texels);
        data.extend_from_slice(&level);
        levels += 1;
    }
    let format = match texels {
        Texels::Color => TextureFormat::Rgba8UnormSrgb,
        Texels::Normal | Texels::Value => TextureFormat::Rgba8Unorm,
    };
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new_uninit(size, TextureDimension::D2, format, usage);
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some(data);
    image.sampler = repeating();
    image
}

fn repeating() -> ImageSampler {
    ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..default()
    })
}

/// Half as wide and half as high: each texel the mean of four.
fn halved(image: &RgbaImage, texels: Texels) -> RgbaImage {
    RgbaImage::from_fn(image.width() / 2, image.height() / 2, |x, y| {
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
            .map(|(dx, dy)| image.get_pixel(2 * x + dx, 2 * y + dy).0);
        image::Rgba(mean(four, texels))
    })
}

fn mean(four: [[u8; 4]; 4], texels: Texels) -> [u8; 4] {
    let channel = |i: usize, decode: fn(f32) -> f32| {
        four.iter()
            .map(|texel| decode(f32::from(texel[i]) / 255.0))
            .sum::<f32>()
            / 4.0
    };
    let plain = |v: f32| v;
    // An exponent of 2.2 is near enough to sRGB's curve for a mean.
    let [r, g, b] = match texels {
        Texels::Color => [0, 1, 2].map(|i| channel(i, |v| v.powf(2.2)).powf(1.0 / 2.2)),
        Texels::Value => [0, 1, 2].map(|i| channel(i, plain)),
        Texels::Normal => {
            let sum = Vec3::from_array([0, 1, 2].map(|i| channel(i, |v| 2.0 * v - 1.0)));
            (0.5 * sum.normalize_or(Vec3::Z) + 0.5).to_array()
        }
    };
    [r, g, b, channel(3, plain)].map(|v| (v * 255.0).round() as u8)
}
