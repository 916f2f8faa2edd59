//! Looks for files that import each other in a circle: none of them can be read, moved or tested without all the others.
//!
//! A file imports another one where a `use` names what is defined there, whatever modules hand the name on. Tests do not count, nor what a
//! module takes from those below it: they are parts of it.

use std::{
    collections::{BTreeMap, BTreeSet},
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use syn::{Attribute, Item, Meta, UseTree};

/// Reads the crates and their examples; fails where there is a circle.
///
/// # Errors
///
/// When a file cannot be read, or is not Rust.
pub fn run(workspace: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let mut roots = Vec::new();
    find_roots(&workspace.join("crates"), &mut roots)?;
    let (mut files, mut found) = (0, 0);
    for root in roots {
        let mut tree = Tree::default();
        tree.read(&root, &[], root.parent().unwrap_or(workspace))?;
        let imports = tree.imports();
        files += imports.len();
        for circle in circles(&imports) {
            found += 1;
            println!("{} files import each other:", circle.len());
            for from in &circle {
                let within = imports[*from].iter().filter(|(to, _)| circle.contains(to));
                within.for_each(|(to, names)| println!("  {from:?} -> {to:?}: {names:?}"));
            }
        }
    }
    println!("{files} files, {found} circles");
    Ok(ExitCode::from(u8::from(found > 0)))
}

/// The files that crates and examples begin with.
fn find_roots(folder: &Path, roots: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() && !path.ends_with("tests") {
            find_roots(&path, roots)?;
        } else if path.ends_with("lib.rs") || path.ends_with("main.rs") {
            roots.push(path);
        }
    }
    roots.sort();
    Ok(())
}

/// The segments of a path.
type Names = Vec<String>;

/// Names that each file imports from others.
type Imports = BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<String>>>;

/// The modules of a crate, by their paths.
#[derive(Default)]
struct Tree(BTreeMap<Names, Module>);

struct Module {
    file: PathBuf,
    /// Meaning of names that are defined elsewhere.
    names: BTreeMap<String, Names>,
}

impl Tree {
    /// Reads a module and those within, whose files lie in the folder `below`.
    fn read(&mut self, file: &Path, path: &[String], below: &Path) -> Result<(), Box<dyn Error>> {
        let text = fs::read_to_string(file).map_err(|error| format!("{file:?}: {error}"))?;
        self.read_items(file, path, below, &syn::parse_file(&text)?.items)
    }

    fn read_items(
        &mut self,
        file: &Path,
        path: &[String],
        below: &Path,
        items: &[Item],
    ) -> Result<(), Box<dyn Error>> {
        let mut names = BTreeMap::new();
        for item in items {
            match item {
                Item::Use(item) if !is_test(&item.attrs) => flatten(&item.tree, &[], &mut names),
                Item::Mod(item) if !is_test(&item.attrs) => {
                    let path = &[path, &[item.ident.to_string()]].concat();
                    let folder = below.join(item.ident.to_string());
                    let beside = folder.with_extension("rs");
                    match &item.content {
                        Some((_, items)) => self.read_items(file, path, &folder, items)?,
                        None if beside.exists() => self.read(&beside, path, &folder)?,
                        None => self.read(&folder.join("mod.rs"), path, &folder)?,
                    }
                }
                _ => {}
            }
        }
        let file = file.to_owned();
        self.0.insert(path.to_owned(), Module { file, names });
        Ok(())
    }

    fn imports(&self) -> Imports {
        let mut imports = Imports::new();
        for (at, Module { file, names }) in &self.0 {
            let of = imports.entry(file.clone()).or_default();
            let mut above = (0..=at.len()).map(|k| &at[..k]);
            let whole = above.find(|path| self.0[*path].file == *file);
            for (name, path) in names {
                let mut homes = self.homes(at, path, 0);
                homes.retain(|home| !whole.is_some_and(|whole| home.starts_with(whole)));
                for home in homes {
                    let names = of.entry(self.0[&home].file.clone()).or_default();
                    names.insert(name.clone());
                }
            }
        }
        imports
    }

    /// The modules that define what a module means by a path; none where that is another crate's.
    fn homes(&self, from: &[String], path: &[String], depth: usize) -> Vec<Names> {
        let mut at = from.to_vec();
        for (k, name) in path.iter().enumerate() {
            let names = &self.0[&at].names;
            let below = [at.as_slice(), std::slice::from_ref(name)].concat();
            match name.as_str() {
                "self" => {}
                "crate" => at.clear(),
                "super" => drop(at.pop()),
                "*" => {
                    let handed_on = names.values().filter(|_| depth < 8);
                    let homes = handed_on.flat_map(|path| self.homes(&at, path, depth + 1));
                    return homes.chain([at.clone()]).collect();
                }
                _ if self.0.contains_key(&below) => at = below,
                _ if k == 0 => return Vec::new(),
                _ => {
                    let Some(import) = names.get(name).filter(|_| depth < 8) else {
                        return vec![at];
                    };
                    let path = [import.as_slice(), &path[k + 1..]].concat();
                    return self.homes(&at, &path, depth + 1);
                }
            }
        }
        vec![at]
    }
}

/// The names that a `use` brings, and where they come from.
fn flatten(tree: &UseTree, before: &[String], names: &mut BTreeMap<String, Names>) {
    let path = |name: &dyn ToString| [before, &[name.to_string()]].concat();
    let (name, path) = match tree {
        UseTree::Path(tree) => return flatten(&tree.tree, &path(&tree.ident), names),
        UseTree::Group(group) => {
            let trees = group.items.iter();
            return trees.for_each(|tree| flatten(tree, before, names));
        }
        UseTree::Name(name) => (name.ident.to_string(), path(&name.ident)),
        UseTree::Rename(name) => (name.rename.to_string(), path(&name.ident)),
        UseTree::Glob(_) => (path(&"*").join("::"), path(&"*")),
    };
    names.insert(name, path);
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string().contains("test"),
        _ => false,
    })
}

/// Files that reach each other, two or more.
fn circles(imports: &Imports) -> BTreeSet<BTreeSet<&PathBuf>> {
    let reached = |start| {
        let (mut reached, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(file) = next.pop() {
            next.extend(imports[file].keys().filter(|other| reached.insert(*other)));
        }
        reached
    };
    let all: BTreeMap<_, _> = imports.keys().map(|file| (file, reached(file))).collect();
    let circles = all.iter().map(|(file, reached)| {
        let circle = reached.iter().copied();
        circle.filter(|other| all[other].contains(file)).collect()
    });
    circles
        .filter(|circle: &BTreeSet<_>| circle.len() > 1)
        .collect()
}
