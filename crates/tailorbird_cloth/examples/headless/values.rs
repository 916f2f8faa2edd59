//! Values of the command line, as text.

use std::{ops::RangeInclusive, str::FromStr};

use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

pub fn size(text: &str) -> Result<u32, String> {
    whole(text, 2..=4096)
}

pub fn substeps(text: &str) -> Result<u32, String> {
    whole(text, 1..=ClothSettings::MOST_PASSES)
}

pub fn iterations(text: &str) -> Result<u32, String> {
    whole(text, 0..=ClothSettings::MOST_PASSES)
}

pub fn threads(text: &str) -> Result<u32, String> {
    whole(text, 1..=1024)
}

pub fn every(text: &str) -> Result<u32, String> {
    whole(text, 1..=u32::MAX)
}

fn whole(text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let allowed = || {
        let (first, last) = (range.start(), range.end());
        format!("must be a whole number, {first} to {last}")
    };
    let value = text.parse().map_err(|_| allowed())?;
    range.contains(&value).then_some(value).ok_or_else(allowed)
}

pub fn finite(text: &str) -> Result<f32, String> {
    number(text, f32::is_finite, "a finite number")
}

pub fn positive(text: &str) -> Result<f32, String> {
    number(
        text,
        |v: f32| v > 0.0 && v.is_finite(),
        "above 0 and finite",
    )
}

pub fn not_negative(text: &str) -> Result<f32, String> {
    number(
        text,
        |v: f32| v >= 0.0 && v.is_finite(),
        "at least 0 and finite",
    )
}

pub fn hz(text: &str) -> Result<f64, String> {
    // From steps of 100 s to steps of a microsecond.
    number(
        text,
        |v: f64| (0.01..=1e6).contains(&v),
        "above 0: 0.01 to 1000000",
    )
}

fn number<T: FromStr + Copy>(
    text: &str,
    ok: impl Fn(T) -> bool,
    allowed: &str,
) -> Result<T, String> {
    match text.parse() {
        Ok(value) if ok(value) => Ok(value),
        _ => Err(format!("must be {allowed}")),
    }
}

pub fn vector(text: &str) -> Result<Vec3, String> {
    let [x, y, z] = numbers(text)?;
    Ok(Vec3::new(x, y, z))
}

pub fn numbers<const N: usize>(text: &str) -> Result<[f32; N], String> {
    let values: Result<Vec<f32>, String> = text.split(',').map(|v| finite(v.trim())).collect();
    let wrong = |_| format!("must be {N} finite numbers with commas between");
    values
        .map_err(|_| ())
        .and_then(|values| values.try_into().map_err(|_| ()))
        .map_err(wrong)
}
