//! Settings saved to a RON file, and loaded from one.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
};

use ron::{
    error::{Error as Ron, SpannedError},
    extensions::Extensions,
    ser::PrettyConfig,
};

use super::{
    saved::{NotAllowed, SavedSettings},
    settings::DemoSettings,
};

/// The file, unless the command line names another.
pub const FILE: &str = "tailorbird.ron";

/// The largest file that is read [bytes].
const LARGEST: u64 = 1 << 20;

/// Why settings were not saved or loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingsFileError {
    /// The file cannot be read.
    Read {
        /// Which one.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file cannot be written.
    Write {
        /// Which one.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// What is in the file is not allowed there.
    Content {
        /// Which one.
        file: PathBuf,
        /// Where, from 1 on.
        line: usize,
        /// The field, with a point between each field and the one within; empty where there is none.
        field: String,
        /// What is wrong with it.
        problem: String,
        /// What is allowed.
        allowed: String,
    },
}

impl fmt::Display for SettingsFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { file, reason } => {
                write!(f, "{} cannot be read: {reason}", file.display())
            }
            Self::Write { file, reason } => {
                write!(f, "{} cannot be written: {reason}", file.display())
            }
            Self::Content {
                file,
                line,
                field,
                problem,
                allowed,
            } => {
                write!(f, "{}, line {line}: ", file.display())?;
                let space = if field.is_empty() { "" } else { " " };
                write!(f, "{field}{space}{problem}, must be {allowed}")
            }
        }
    }
}

impl std::error::Error for SettingsFileError {}

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
/// Where RON cannot say it.
pub fn to_text(settings: &DemoSettings) -> Result<String, ron::Error> {
    let config = PrettyConfig::new().struct_names(false);
    let mut text = options().to_string_pretty(&SavedSettings::from(settings), config)?;
    text.push('\n');
    Ok(text)
}

/// Settings from text; `file` is named in errors.
///
/// # Errors
/// When something in it is not allowed.
pub fn from_text(text: &str, file: &Path) -> Result<DemoSettings, SettingsFileError> {
    let saved: SavedSettings = options()
        .from_str(text)
        .map_err(|error| describe(&error, text, file))?;
    saved
        .check()
        .map_err(|wrong: NotAllowed| SettingsFileError::Content {
            file: file.into(),
            line: line_of(&wrong.field, text),
            problem: format!("is {}", wrong.value),
            field: wrong.field,
            allowed: wrong.allowed,
        })
}

/// What RON does not understand.
fn describe(error: &SpannedError, text: &str, file: &Path) -> SettingsFileError {
    let mut line = error.span.start.line;
    let (field, problem, allowed) = match &error.code {
        Ron::NoSuchStructField {
            expected, found, ..
        } => {
            let known = expected.join(", ");
            (
                found.clone(),
                "is unknown".into(),
                format!("one of {known}"),
            )
        }
        Ron::NoSuchEnumVariant {
            expected, found, ..
        } => {
            let known = expected.join(", ");
            let (field, at) = field_before(error, text);
            line = at;
            (field, format!("is {found}"), format!("one of {known}"))
        }
        Ron::MissingStructField { field, .. } => (
            (*field).into(),
            "is missing".into(),
            "there with its neighbours".into(),
        ),
        Ron::DuplicateStructField { field, .. } => (
            (*field).into(),
            "is there twice".into(),
            "there once".into(),
        ),
        Ron::Eof => (
            String::new(),
            "the file ends too early".into(),
            "closed by as many ) as it has (".into(),
        ),
        Ron::ExpectedStructLikeEnd | Ron::ExpectedComma => {
            let (field, at) = field_before(error, text);
            line = at;
            let allowed = "one value of its kind, then a comma or )".into();
            (field, "does not end as it should".into(), allowed)
        }
        code => {
            let (field, at) = field_before(error, text);
            line = at;
            let wanted = code.to_string();
            let wanted = wanted.strip_prefix("Expected ").unwrap_or(&wanted);
            (field, "is of another kind".into(), wanted.to_owned())
        }
    };
    SettingsFileError::Content {
        file: file.into(),
        line,
        field,
        problem,
        allowed,
    }
}

/// The last field that is named before the place of an error, and its line.
fn field_before(error: &SpannedError, text: &str) -> (String, usize) {
    let end = error.span.end;
    let mut last = (String::new(), error.span.start.line);
    for (name, line, column) in names(text) {
        if (line, column) < (end.line, end.col) {
            last = (name, line);
        }
    }
    last
}

/// The line of a field, or of the innermost one around it that is there.
fn line_of(field: &str, text: &str) -> usize {
    let mut found = 1;
    let mut names = names(text);
    for part in field.split('.') {
        // Of a vector, its parts have no names.
        let Some((_, line, _)) = names.find(|(name, ..)| name == part) else {
            break;
        };
        found = line;
    }
    found
}

/// The names before colons, each with its line and column from 1 on. What is in comments does not count.
fn names(text: &str) -> impl Iterator<Item = (String, usize, usize)> + '_ {
    text.lines().enumerate().flat_map(|(line, text)| {
        let code = text.split("//").next().unwrap_or("");
        let mut start = 0;
        let mut found = Vec::new();
        for (at, _) in code.match_indices(':') {
            let before = code[start..at].trim_end();
            let is_part = |c: char| c.is_alphanumeric() || c == '_';
            let length: usize = before
                .chars()
                .rev()
                .take_while(|c| is_part(*c))
                .map(char::len_utf8)
                .sum();
            let name = &before[before.len() - length..];
            if !name.is_empty() {
                let column = 1 + code[..start + before.len() - length].chars().count();
                found.push((name.to_owned(), line + 1, column));
            }
            start = at + 1;
        }
        found
    })
}
