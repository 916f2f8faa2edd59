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
    /// Whether it holds kernels, and not tests of them.
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

/// Reads all files below a folder.
pub fn read(folder: &Path) -> Result<Vec<Source>, Box<dyn Error>> {
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
    let all = sources.iter().filter(|source| source.is_kernel);
    let names = all
        .map(|source| Ok(constants(&source.text.parse()?)))
        .collect::<Result<Vec<_>, proc_macro2::LexError>>()?
        .concat();
    let names: BTreeSet<String> = names.into_iter().collect();
    for source in &mut sources {
        source.text = turned(source, &names)?;
    }
    Ok(sources)
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
fn turned(source: &Source, names: &BTreeSet<String>) -> Result<String, Box<dyn Error>> {
    let tokens: TokenStream = source.text.parse()?;
    let own = if source.is_kernel {
        constants(&tokens)
    } else {
        Vec::new()
    };
    let everything = source.text.contains("use super::*;");
    let mut here = BTreeSet::new();
    for name in names {
        let is_other = source.text.contains(&format!("const {name}: ")) && !own.contains(name);
        let imports = everything || imported(&source.text, name) || own.contains(name);
        if imports && !is_other {
            here.insert(name.clone());
        }
    }
    let mut edits = Vec::new();
    walk(tokens, &here, &mut edits);
    edits.sort_by_key(|(start, ..)| *start);
    let mut text = source.text.clone();
    for (start, end, with) in edits.into_iter().rev() {
        text.replace_range(start..end, with);
    }
    Ok(text)
}

/// Whether a `use` names it.
fn imported(text: &str, name: &str) -> bool {
    let mut uses = text
        .split(';')
        .filter_map(|part| part.rfind("use ").map(|at| &part[at..]));
    let is_word = |c: char| !c.is_alphanumeric() && c != '_';
    uses.any(|path| path.split(is_word).any(|word| word == name))
}

/// Where to replace what by what.
type Edit = (usize, usize, &'static str);

fn walk(tokens: TokenStream, names: &BTreeSet<String>, edits: &mut Vec<Edit>) {
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
            TokenTree::Ident(word) if names.contains(&word.to_string()) => {
                edits.push((range(k).end, range(k).end, "()"));
            }
            TokenTree::Group(group) => walk(group.stream(), names, edits),
            _ => {}
        }
        k += 1;
    }
}
