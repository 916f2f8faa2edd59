//! Numbers that may be infinite, in files. JSON has no infinity and writes `null` for it, which is read as infinity here.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{Error, Visitor},
};

/// A number; infinity where the file has none.
pub(crate) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    Unbounded::deserialize(deserializer).map(|Unbounded(number)| number)
}

/// Numbers; infinity where the file has none.
pub(crate) fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
    let numbers = Vec::deserialize(deserializer)?;
    Ok(numbers
        .into_iter()
        .map(|Unbounded(number)| number)
        .collect())
}

struct Unbounded(f32);

impl<'de> Deserialize<'de> for Unbounded {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(NumberOrNone).map(Self)
        } else {
            // Formats in bytes have infinity, and do not say what comes next.
            f32::deserialize(deserializer).map(Self)
        }
    }
}

struct NumberOrNone;

impl Visitor<'_> for NumberOrNone {
    type Value = f32;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, or none for infinity")
    }

    fn visit_f32<E: Error>(self, value: f32) -> Result<f32, E> {
        Ok(value)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f32, E> {
        Ok(value as f32)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f32, E> {
        Ok(value as f32)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f32, E> {
        Ok(value as f32)
    }

    fn visit_unit<E: Error>(self) -> Result<f32, E> {
        Ok(f32::INFINITY)
    }

    fn visit_none<E: Error>(self) -> Result<f32, E> {
        Ok(f32::INFINITY)
    }
}
