//! Writes fabrics as the three textures that Bevy's `StandardMaterial` takes.

use std::{error::Error, fs, fs::File, io::BufWriter, path::Path};

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};

use crate::fabric::{self, Fabric, Texel};

/// Samples along each side of a tile.
const SAMPLES: usize = 2048;

/// Height of the relief in the normals, as a part of that of the yarns: flatter, so that light on them does not flicker from afar \[-\].
const RELIEF: f32 = 0.7;

/// Writes every fabric into `folder`, with `size` pixels along each side.
///
/// # Errors
///
/// When a file cannot be written.
pub fn write(folder: &Path, size: usize) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    for (name, fabric) in fabric::all() {
        let texels = sample(&*fabric, size);
        let file = |kind: &str| folder.join(format!("{name}_{kind}.png"));
        if texels.iter().all(|texel| texel.cover == 1.0) {
            save(
                &file("albedo"),
                size,
                ExtendedColorType::Rgb8,
                texels.iter().map(albedo),
            )?;
        } else {
            let with_holes = texels.iter().map(|texel| {
                let [r, g, b] = albedo(texel);
                [r, g, b, byte(texel.cover)]
            });
            save(&file("albedo"), size, ExtendedColorType::Rgba8, with_holes)?;
        }
        let kind = ExtendedColorType::Rgb8;
        save(
            &file("metallic_roughness"),
            size,
            kind,
            texels.iter().map(metallic_roughness),
        )?;
        save(
            &file("normal"),
            size,
            kind,
            normals(&texels, fabric.units(), size),
        )?;
    }
    Ok(())
}

/// The mean of the samples of each pixel, row by row from the top.
fn sample(fabric: &dyn Fabric, size: usize) -> Vec<Texel> {
    let samples = SAMPLES / size;
    let place = |pixel: usize, sample: usize| {
        (pixel as f32 + (sample as f32 + 0.5) / samples as f32) / size as f32
    };
    let weight = 1.0 / (samples * samples) as f32;
    let pixel = |index: usize| {
        let (column, row) = (index % size, index / size);
        let mut mean = Texel::default();
        for sample in 0..samples * samples {
            let texel = fabric.at(
                place(column, sample % samples),
                place(row, sample / samples),
            );
            mean.height += weight * texel.height;
            mean.openness += weight * texel.openness;
            mean.roughness += weight * texel.roughness;
            mean.cover += weight * texel.cover;
            for (mean, color) in mean.color.iter_mut().zip(texel.color) {
                *mean += weight * color;
            }
        }
        mean
    };
    (0..size * size).map(pixel).collect()
}

/// sRGB colour, darker in the gaps: they are too small for a renderer's own shadows.
fn albedo(texel: &Texel) -> [u8; 3] {
    let shade = 0.5 + 0.5 * texel.openness;
    texel
        .color
        .map(|color| coarse(byte(srgb(color * shade)), 4))
}

/// glTF's channels: occlusion, roughness, metallic.
fn metallic_roughness(texel: &Texel) -> [u8; 3] {
    let occlusion = 0.4 + 0.6 * texel.openness;
    [byte(occlusion), byte(texel.roughness), 0].map(|v| coarse(v, 8))
}

/// Tangent-space normals of the height field, with y up the image (OpenGL's convention).
fn normals(texels: &[Texel], units: f32, size: usize) -> impl Iterator<Item = [u8; 3]> {
    let pixels_per_unit = size as f32 / units;
    let height = move |column: usize, row: usize| texels[row % size * size + column % size].height;
    (0..size * size).map(move |index| {
        let (column, row) = (index % size, index / size);
        let slope = |ahead: f32, behind: f32| RELIEF * pixels_per_unit * (ahead - behind) / 2.0;
        let right = slope(height(column + 1, row), height(column + size - 1, row));
        let down = slope(height(column, row + 1), height(column, row + size - 1));
        let length = (right * right + down * down + 1.0).sqrt();
        [-right, down, 1.0].map(|axis| coarse(byte(0.5 + 0.5 * axis / length), 4))
    })
}

fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

fn byte(share: f32) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}

/// The nearest multiple of `step`: what nobody sees takes most of the space in a file.
fn coarse(value: u8, step: u8) -> u8 {
    let half = step / 2;
    (value.saturating_add(half) / step).saturating_mul(step)
}

fn save<const N: usize>(
    path: &Path,
    size: usize,
    kind: ExtendedColorType,
    pixels: impl Iterator<Item = [u8; N]>,
) -> Result<(), Box<dyn Error>> {
    let bytes: Vec<u8> = pixels.flatten().collect();
    let file = BufWriter::new(File::create(path)?);
    PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive).write_image(
        &bytes,
        size as u32,
        size as u32,
        kind,
    )?;
    println!("{}", path.display());
    Ok(())
}
