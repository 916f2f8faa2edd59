//! The source files of the kernels, in a form in which every number can be changed at run time: constants of type `f32` are functions.

use std::{
    collections::BTreeSet,
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use proc_macro2::{TokenStream, TokenTree};

/// A file of the kernels' folder.
pub struct Source {
    /// Below that folder.
    pub name: String,
    /// True if it holds kernels, and not tests of them.
    pub is_kernel: bool,
    /// With functions for constants; each line has what it has in the file.
    pub text: String,
    lines: Vec<String>,
}

impl Source {
    /// A line of the file as it is, counted from 1.
    pub fn line(&self, line: usize) -> &str {
        self.lines.get(line - 1).map_or("", |line| line.trim())
    }
}

/// The kernels' constants that are functions, each behind the name of its file: `line`, `LEAST`.
#[derive(Default)]
pub struct Constants(BTreeSet<[String; 2]>);

impl Constants {
    /// Calls them in a file outside of the kernels' folder.
    ///
    /// # Errors
    ///
    /// When that is no Rust.
    pub fn called(&self, text: &str) -> Result<String, Box<dyn Error>> {
        let imported = self
            .0
            .iter()
            .filter(|names| imported(text, names.as_slice()));
        let here = imported.map(|[_, name]| name.clone()).collect();
        edited(text, &here, self)
    }
}

/// Reads all files below a folder.
pub fn read(folder: &Path) -> Result<(Vec<Source>, Constants), Box<dyn Error>> {
    let mut paths = Vec::new();
    files(folder, &mut paths)?;
    paths.sort();
    let mut sources = Vec::new();
    for path in paths {
        let name = path.strip_prefix(folder)?.to_string_lossy().into_owned();
        let is_test = ["oracle/", "parity/"]
            .iter()
            .any(|folder| name.starts_with(folder))
            || name.ends_with("tests.rs");
        let text = fs::read_to_string(&path)?;
        sources.push(Source {
            name,
            is_kernel: !is_test,
            lines: text.lines().map(str::to_owned).collect(),
            text,
        });
    }
    let mut all = Constants::default();
    for source in sources.iter().filter(|source| source.is_kernel) {
        let file = Path::new(&source.name).file_stem().unwrap_or_default();
        let file = file.to_string_lossy();
        let names = constants(&source.text.parse()?).into_iter();
        all.0.extend(names.map(|name| [file.to_string(), name]));
    }
    for source in &mut sources {
        source.text = turned(source, &all)?;
    }
    Ok((sources, all))
}

fn files(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files(&path, paths)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
    Ok(())
}

/// The constants of type `f32` that are defined outermost.
fn constants(tokens: &TokenStream) -> Vec<String> {
    let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    let defined = tokens.windows(4).filter(|four| is_constant(four));
    defined.map(|four| four[1].to_string()).collect()
}

/// `const NAME: f32`.
fn is_constant(tokens: &[TokenTree]) -> bool {
    let is = |k: usize, what: &str| tokens.get(k).is_some_and(|token| token.to_string() == what);
    is(0, "const") && is(2, ":") && is(3, "f32")
}

/// Makes constants functions, and their uses calls, in the files that define or import them.
fn turned(source: &Source, all: &Constants) -> Result<String, Box<dyn Error>> {
    let own = if source.is_kernel {
        constants(&source.text.parse()?)
    } else {
        Vec::new()
    };
    let everything = source.text.contains("use super::*;");
    let mut here = BTreeSet::new();
    for [_, name] in &all.0 {
        let is_other = source.text.contains(&format!("const {name}: ")) && !own.contains(name);
        let imports =
            everything || imported(&source.text, std::slice::from_ref(name)) || own.contains(name);
        if imports && !is_other {
            here.insert(name.clone());
        }
    }
    edited(&source.text, &here, all)
}

/// Returns whether a `use` has all of these words.
fn imported(text: &str, words: &[String]) -> bool {
    let mut uses = text
        .split(';')
        .filter_map(|part| part.rfind("use ").map(|at| &part[at..]));
    let is_other = |c: char| !c.is_alphanumeric() && c != '_';
    uses.any(|path| {
        words
            .iter()
            .all(|word| path.split(is_other).any(|of| of == word))
    })
}

/// Turns the constants of these names, and calls those behind the names of their files.
fn edited(text: &str, names: &BTreeSet<String>, all: &Constants) -> Result<String, Box<dyn Error>> {
    let mut edits = Vec::new();
    walk(text.parse()?, names, all, &mut edits);
    edits.sort_by_key(|(start, ..)| *start);
    let mut text = text.to_owned();
    for (start, end, with) in edits.into_iter().rev() {
        text.replace_range(start..end, with);
    }
    Ok(text)
}

/// Start and end of what is replaced, and its replacement.
type Edit = (usize, usize, &'static str);

fn walk(tokens: TokenStream, names: &BTreeSet<String>, all: &Constants, edits: &mut Vec<Edit>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut k = 0;
    while k < tokens.len() {
        let range = |k: usize| tokens[k].span().byte_range();
        match &tokens[k] {
            TokenTree::Ident(word) if word == "use" => {
                while k < tokens.len() && tokens[k].to_string() != ";" {
                    k += 1;
                }
            }
            TokenTree::Ident(word)
                if word == "const"
                    && is_constant(&tokens[k..])
                    && names.contains(&tokens[k + 1].to_string()) =>
            {
                edits.push((range(k).start, range(k).end, "fn"));
                edits.push((range(k + 1).end, range(k + 2).end, "() ->"));
                edits.push((range(k + 4).start, range(k + 4).end, "{"));
                k += 5;
                while tokens[k].to_string() != ";" {
                    if let TokenTree::Ident(word) = &tokens[k]
                        && names.contains(&word.to_string())
                    {
                        edits.push((range(k).end, range(k).end, "()"));
                    }
                    k += 1;
                }
                edits.push((range(k).start, range(k).end, "}"));
            }
            TokenTree::Ident(word)
                if names.contains(&word.to_string()) || is_behind(&tokens[..=k], all) =>
            {
                edits.push((range(k).end, range(k).end, "()"));
            }
            TokenTree::Group(group) => walk(group.stream(), names, all, edits),
            _ => {}
        }
        k += 1;
    }
}

/// Returns whether these tokens end with a constant behind the name of its file.
fn is_behind(tokens: &[TokenTree], all: &Constants) -> bool {
    let [.., file, first, second, name] = tokens else {
        return false;
    };
    let is_path = [first, second].iter().all(|token| token.to_string() == ":");
    is_path && all.0.contains(&[file.to_string(), name.to_string()])
}
