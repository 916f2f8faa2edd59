//! Settings saved to a RON file, and loaded from one.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ron::{
    error::{Error as Ron, SpannedError},
    extensions::Extensions,
    ser::PrettyConfig,
};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, IgnoredAny, Unexpected},
};
use tailorbird::prelude::*;

use super::{
    scenes::SceneKind,
    settings::{DemoSettings, Look, PresetName},
};

/// The file, unless the command line names another.
pub const FILE: &str = "tailorbird.ron";

/// The largest file that is read [bytes].
const LARGEST: u64 = 1 << 20;

/// Why settings were not saved or loaded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsFileError {
    /// The file cannot be read.
    #[error("{} cannot be read: {reason}", .file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{} cannot be written: {reason}", .file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// A value in the file is not allowed there.
    #[error("{}, line {line}: {field} {problem}, must be {allowed}", .file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// Where, from 1 on.
        line: usize,
        /// The field, with a point between each field and the one within.
        field: String,
        /// Fault of the value.
        problem: String,
        /// Values that are allowed.
        allowed: String,
    },
}

/// Saves settings; replaces what is in the file.
///
/// # Errors
/// When the file cannot be written.
pub fn save(file: &Path, settings: &DemoSettings) -> Result<(), SettingsFileError> {
    let failed = |reason: String| SettingsFileError::Write {
        file: file.into(),
        reason,
    };
    let text = to_text(settings).map_err(|error| failed(error.to_string()))?;
    fs::write(file, text).map_err(|error| failed(error.to_string()))
}

/// Loads settings.
///
/// # Errors
/// When the file cannot be read, or something in it is not allowed.
pub fn load(file: &Path) -> Result<DemoSettings, SettingsFileError> {
    let failed = |reason: String| SettingsFileError::Read {
        file: file.into(),
        reason,
    };
    let size = fs::metadata(file).map_err(|error| failed(error.to_string()))?;
    if size.len() > LARGEST {
        return Err(failed(format!("it is larger than {LARGEST} bytes")));
    }
    let text = fs::read_to_string(file).map_err(|error| failed(error.to_string()))?;
    from_text(&text, file)
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Settings as text.
///
/// # Errors
/// Settings that RON cannot say.
pub fn to_text(settings: &DemoSettings) -> Result<String, ron::Error> {
    let config = PrettyConfig::new().struct_names(false);
    let mut text = options().to_string_pretty(settings, config)?;
    text.push('\n');
    Ok(text)
}

/// Settings from text; `file` is named in errors. What is left out is as the scene brings it.
///
/// # Errors
/// When something in it is not allowed.
pub fn from_text(text: &str, file: &Path) -> Result<DemoSettings, SettingsFileError> {
    let describe = |error| describe(&error, text, file);
    let mut settings: DemoSettings = options().from_str(text).map_err(describe)?;
    let given: Given = options().from_str(text).map_err(describe)?;
    let mut scene = DemoSettings::of(settings.scene);
    if given.fabric.is_some() {
        scene.choose_preset(settings.preset);
    }
    settings.preset = scene.preset;
    if given.material.is_none() {
        settings.material = scene.material;
    }
    if given.wind.is_none() {
        settings.wind = scene.wind;
    }
    if given.sphere_radius.is_none() {
        settings.sphere_radius = scene.sphere_radius;
    }
    match not_allowed(&settings) {
        None => Ok(settings),
        Some((field, value, allowed)) => Err(SettingsFileError::Content {
            file: file.into(),
            line: line_of(&field, text),
            problem: format!("is {value}"),
            field,
            allowed,
        }),
    }
}

/// Other parts that a scene brings, and whether each is in a file.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Given {
    fabric: Option<IgnoredAny>,
    material: Option<IgnoredAny>,
    wind: Option<IgnoredAny>,
    sphere_radius: Option<IgnoredAny>,
}

/// Substeps in a file: as many as the cloth needs, or so many.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Option<u32>")]
pub enum Substeps {
    /// Number that the cloth needs.
    #[serde(rename = "Automatic")]
    None,
    /// So many.
    #[serde(rename = "Fixed")]
    Some(u32),
}

/// [`ClothPickingBackend`] in a file.
#[derive(Serialize, Deserialize)]
#[serde(remote = "ClothPickingBackend")]
#[allow(missing_docs, reason = "as there")]
pub enum Picking {
    Ray,
    Depth,
}

/// Writes the name of a scene.
pub fn write_scene<S: Serializer>(scene: &SceneKind, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(scene.name())
}

/// Reads the name of a scene.
pub fn read_scene<'de, D: Deserializer<'de>>(from: D) -> Result<SceneKind, D::Error> {
    choose(from, &SceneKind::ALL.map(|scene| (scene.name(), scene)))
}

/// Reads the name of a preset.
pub fn read_preset<'de, D: Deserializer<'de>>(from: D) -> Result<PresetName, D::Error> {
    let presets = ClothMaterial::presets();
    choose(from, &presets.map(|(name, _)| (name, name)))
}

/// Reads a name, and finds what is called so.
fn choose<'de, D: Deserializer<'de>, T: Copy>(
    from: D,
    all: &[(&'static str, T)],
) -> Result<T, D::Error> {
    let name = String::deserialize(from)?;
    let found = all.iter().find(|(known, _)| *known == name);
    found.map(|(_, it)| *it).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
        let allowed = format!("one of {}", names.join(", "));
        D::Error::invalid_value(Unexpected::Str(&name), &allowed.as_str())
    })
}

/// The first value that is not allowed: its field, itself, and what is allowed, with the unit.
fn not_allowed(settings: &DemoSettings) -> Option<(String, String, String)> {
    let s = settings;
    let passes = ClothSettings::MOST_PASSES as f32;
    let substeps = s.substeps.unwrap_or(1) as f32;
    for (field, value, range, unit) in [
        ("resolution", s.resolution as f32, 2.0..=512.0, ""),
        ("substeps", substeps, 1.0..=passes, ""),
        ("iterations", s.iterations as f32, 0.0..=passes, ""),
        ("gravity", s.gravity, 0.0..=100.0, " m/s²"),
        ("sphere_radius", s.sphere_radius, 0.01..=2.0, " m"),
        ("sphere_speed", s.sphere_speed, 0.0..=100.0, " m/s"),
        ("grab_radius", s.grab_radius, 0.0..=1.0, " m"),
        ("look.f_number", s.look.f_number, Look::F_NUMBERS, ""),
    ] {
        if !range.contains(&value) {
            let allowed = format!("{} to {}{unit}", range.start(), range.end());
            return Some((field.into(), value.to_string(), allowed));
        }
    }
    let material = s.material.errors().into_iter();
    let wind = s.wind.errors().into_iter();
    let (kind, of, called) = material
        .map(|kind| (kind, "ClothMaterial", "material"))
        .chain(wind.map(|kind| (kind, "ClothWind", "wind")))
        .next()?;
    let rename = |field: String| field.replacen(of, called, 1);
    Some(match kind {
        ClothErrorKind::Value {
            field,
            value,
            allowed,
        } => (rename(field), value.to_string(), allowed),
        ClothErrorKind::Vector { field, value } => {
            (rename(field), value.to_string(), "finite".into())
        }
        other => (
            called.into(),
            other.to_string(),
            "what the plugin takes".into(),
        ),
    })
}

/// Describes what RON does not understand.
fn describe(error: &SpannedError, text: &str, file: &Path) -> SettingsFileError {
    let one_of = |names: &[&str]| format!("one of {}", names.join(", "));
    let here = error.span.start.line;
    let (last, at) = field_before(error, text);
    let (field, line, problem, allowed) = match &error.code {
        Ron::NoSuchStructField {
            expected, found, ..
        } => (found.as_str(), here, "is unknown".into(), one_of(expected)),
        Ron::NoSuchEnumVariant {
            expected, found, ..
        } => (last, at, format!("is {found}"), one_of(expected)),
        Ron::InvalidValueForType { expected, found } => {
            (last, at, format!("is {found}"), expected.clone())
        }
        Ron::DuplicateStructField { field, .. } => {
            (*field, here, "is there twice".into(), "there once".into())
        }
        Ron::Eof => {
            let allowed = "closed by as many ) as it has (".into();
            ("the file", here, "ends too early".into(), allowed)
        }
        Ron::ExpectedStructLikeEnd | Ron::ExpectedComma => {
            let allowed = "one value of its kind, then a comma or )".into();
            (last, at, "does not end as it should".into(), allowed)
        }
        code => {
            let wanted = code.to_string();
            let wanted = wanted.strip_prefix("Expected ").unwrap_or(&wanted);
            (last, at, "is of another kind".into(), wanted.into())
        }
    };
    SettingsFileError::Content {
        file: file.into(),
        line,
        field: field.into(),
        problem,
        allowed,
    }
}

/// The last field that is named before the place of an error, and its line; the file where there is none.
fn field_before<'a>(error: &SpannedError, text: &'a str) -> (&'a str, usize) {
    let (start, end) = (error.span.start, error.span.end);
    names(text)
        .take_while(|(_, line, column)| (*line, *column) < (end.line, end.col))
        .last()
        .map_or(("the file", start.line), |(name, line, _)| (name, line))
}

/// The line of a field, or of the innermost one around it that is there.
fn line_of(field: &str, text: &str) -> usize {
    let mut found = 1;
    let mut names = names(text);
    for part in field.split('.') {
        // Of a vector, its parts have no names.
        let Some((_, line, _)) = names.find(|(name, ..)| *name == part) else {
            break;
        };
        found = line;
    }
    found
}

/// The names before colons, each with its line and column from 1 on. What is in comments does not count.
fn names(text: &str) -> impl Iterator<Item = (&str, usize, usize)> {
    text.lines().enumerate().flat_map(|(line, text)| {
        let code = text.split("//").next().unwrap_or("");
        code.match_indices(':').filter_map(move |(colon, _)| {
            let before = code[..colon].trim_end();
            let is_part = |c: char| c.is_alphanumeric() || c == '_';
            let name = before.rsplit(|c| !is_part(c)).next()?;
            let column = 1 + before[..before.len() - name.len()].chars().count();
            (!name.is_empty()).then_some((name, line + 1, column))
        })
    })
}
