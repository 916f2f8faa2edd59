//! Workplace in which mutants are built and run: a copy of the solver in the target folder, in a workspace of its own.

use std::{
    collections::BTreeMap,
    env,
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde_json::Value;

use super::{
    find::Mutant,
    plant::{Planted, QUESTION, plant},
    source::{Constants, Source},
};

/// Little optimised, as building takes longer than running, but with the checks of the kernels, which stop at an index that is out of range.
const PROFILE: &str = "
[profile.dev]
opt-level = 1
debug = false
debug-assertions = true
codegen-units = 16
incremental = true
";

/// One instruction set less to build is a third of the time; the two that are left have the same operations.
const FLAGS: &str = "-A warnings --cfg disable_dispatch_avx512 --cfg disable_dispatch_avx2 --cfg disable_dispatch_sse4_2";

/// The copy.
pub struct Bench {
    workspace: PathBuf,
    target: PathBuf,
}

impl Bench {
    /// Copies the crate, its workspace's manifest and the lock file.
    pub fn new(
        workspace: &Path,
        crate_folder: &Path,
        constants: &Constants,
    ) -> Result<Self, Box<dyn Error>> {
        let target =
            env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
        let target = target.join("mutants");
        let bench = Self {
            workspace: target.join("workspace"),
            target: target.join("target"),
        };
        let copy = bench.crate_folder();
        fs::create_dir_all(&copy)?;
        let manifest: toml::Table =
            toml::from_str(&fs::read_to_string(workspace.join("Cargo.toml"))?)?;
        let mut of_workspace = manifest.get("workspace").cloned().ok_or("no workspace")?;
        if let Some(table) = of_workspace.as_table_mut() {
            table.insert("members".into(), vec!["crates/*"].into());
            table.remove("exclude");
        }
        let manifest = toml::Table::from_iter([("workspace".to_owned(), of_workspace)]);
        write(
            &bench.workspace.join("Cargo.toml"),
            &(toml::to_string(&manifest)? + PROFILE),
        )?;
        fs::copy(
            workspace.join("Cargo.lock"),
            bench.workspace.join("Cargo.lock"),
        )?;
        for file in ["Cargo.toml", "build.rs"] {
            if crate_folder.join(file).exists() {
                write(
                    &copy.join(file),
                    &fs::read_to_string(crate_folder.join(file))?,
                )?;
            }
        }
        if copy.join("src").exists() {
            remove_missing(&copy.join("src"), &crate_folder.join("src"))?;
        }
        copy_folder(
            &crate_folder.join("src"),
            &copy.join("src"),
            Some(constants),
        )?;
        Ok(bench)
    }

    /// The copy of the crate.
    pub fn crate_folder(&self) -> PathBuf {
        self.workspace.join("crates/tailorbird_solver")
    }

    fn kernels(&self) -> PathBuf {
        self.crate_folder().join("src/kernels")
    }

    /// Builds the tests with all mutants that can be built; returns for each whether it cannot.
    pub fn build(
        &self,
        sources: &[Source],
        mutants: &[Mutant],
    ) -> Result<Vec<bool>, Box<dyn Error>> {
        let library = self.crate_folder().join("src/lib.rs");
        write(&library, &(fs::read_to_string(&library)? + QUESTION))?;
        let mut broken = vec![false; mutants.len()];
        loop {
            let planted = self.plant(sources, mutants, &broken)?;
            let messages = self.cargo(&["check", "--lib"])?;
            let errors = errors(&messages);
            if errors.is_empty() {
                break;
            }
            let before = broken.iter().filter(|broken| **broken).count();
            for error in &errors {
                for (file, at) in &error.places {
                    if let Some(planted) = planted.get(file)
                        && let Some(mutant) = mutant_at(planted, *at)
                    {
                        broken[mutant] = true;
                        break;
                    }
                }
            }
            let count = broken.iter().filter(|broken| **broken).count();
            eprintln!("{count} of {} mutants do not build", mutants.len());
            if count == before {
                return Err(failed(&errors[0]));
            }
        }
        eprintln!("building the tests");
        let messages = self.cargo(&["test", "--lib", "--no-run"])?;
        if let Some(error) = errors(&messages).first() {
            return Err(failed(error));
        }
        let built = messages
            .iter()
            .find_map(|message| message["executable"].as_str());
        let built = built.ok_or("no tests were built")?;
        fs::copy(built, self.tests())?;
        Ok(broken)
    }

    /// Writes all sources; returns those of the kernels, by their names.
    fn plant(
        &self,
        sources: &[Source],
        mutants: &[Mutant],
        broken: &[bool],
    ) -> Result<BTreeMap<String, Planted>, Box<dyn Error>> {
        let mut all = BTreeMap::new();
        for (number, source) in sources.iter().enumerate() {
            let here = mutants.iter().enumerate();
            let here = here.filter(|(k, mutant)| mutant.source == number && !broken[*k]);
            let planted = plant(&source.text, &here.collect::<Vec<_>>());
            write(&self.kernels().join(&source.name), &planted.text)?;
            all.insert(source.name.clone(), planted);
        }
        Ok(all)
    }

    /// Runs cargo, and returns what it says, line by line.
    fn cargo(&self, arguments: &[&str]) -> Result<Vec<Value>, Box<dyn Error>> {
        let output = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
            .args(arguments)
            .args([
                "--package=tailorbird_solver",
                "--ignore-rust-version",
                "--message-format=json",
            ])
            .current_dir(&self.workspace)
            .env("CARGO_TARGET_DIR", &self.target)
            .env("CARGO_INCREMENTAL", "1")
            .env("RUSTFLAGS", FLAGS)
            .stderr(Stdio::inherit())
            .output()?;
        let lines = output.stdout.split(|byte| *byte == b'\n');
        Ok(lines
            .filter_map(|line| serde_json::from_slice(line).ok())
            .collect())
    }

    /// The program with the tests.
    pub fn tests(&self) -> PathBuf {
        self.target.join("tests")
    }
}

/// An error of the compiler, and the kernels' files and bytes at which it points, the nearest first.
struct CompileError {
    text: String,
    places: Vec<(String, usize)>,
}

fn failed(error: &CompileError) -> Box<dyn Error> {
    eprintln!("{}", error.text);
    "the kernels do not build".into()
}

fn errors(messages: &[Value]) -> Vec<CompileError> {
    let errors = messages
        .iter()
        .filter(|message| message["message"]["level"] == "error");
    errors
        .map(|message| {
            let spans = message["message"]["spans"].as_array();
            let (mut first, mut others) = (Vec::new(), Vec::new());
            for span in spans.into_iter().flatten() {
                let places = if span["is_primary"] == true {
                    &mut first
                } else {
                    &mut others
                };
                let mut span = span;
                // Out of macros.
                while span.is_object() {
                    let file = span["file_name"].as_str().unwrap_or_default();
                    let at = span["byte_start"].as_u64().unwrap_or(0) as usize;
                    if let Some((_, name)) = file.split_once("src/kernels/") {
                        places.push((name.to_owned(), at));
                    }
                    span = &span["expansion"]["span"];
                }
            }
            first.append(&mut others);
            CompileError {
                text: message["message"]["rendered"]
                    .as_str()
                    .unwrap_or_default()
                    .to_owned(),
                places: first,
            }
        })
        .collect()
}

/// The mutant whose replacement is there, or else the innermost around.
fn mutant_at(planted: &Planted, at: usize) -> Option<usize> {
    let places = &planted.places;
    let inside = places.iter().find(|place| place.instead.contains(&at));
    let around = || {
        let around = places.iter().filter(|place| place.whole.contains(&at));
        around.min_by_key(|place| place.whole.len())
    };
    inside.or_else(around).map(|place| place.mutant)
}

/// Writes a file where it is another, so that what is the same is not built anew.
fn write(path: &Path, text: &str) -> Result<(), Box<dyn Error>> {
    if fs::read_to_string(path).is_ok_and(|is| is == text) {
        return Ok(());
    }
    Ok(fs::write(path, text)?)
}

/// Copies the sources of a folder, in which the kernels' constants are called; of the kernels (none) the folders alone. Tests of anything
/// but kernels are not built.
fn copy_folder(
    from: &Path,
    to: &Path,
    constants: Option<&Constants>,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            let constants = constants.filter(|_| entry.file_name() != "kernels");
            copy_folder(&from, &to, constants)?;
        } else if let Some(constants) = constants
            && from.extension().is_some_and(|extension| extension == "rs")
        {
            let text = constants.called(&fs::read_to_string(&from)?)?;
            write(&to, &text.replace("#[test]", "#[cfg(any())]"))?;
        }
    }
    Ok(())
}

/// Removes what is no more there.
fn remove_missing(copy: &Path, original: &Path) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(copy)? {
        let entry = entry?;
        let (copy, original) = (entry.path(), original.join(entry.file_name()));
        match (copy.is_dir(), original.exists()) {
            (true, true) => remove_missing(&copy, &original)?,
            (true, false) => fs::remove_dir_all(copy)?,
            (false, false) => fs::remove_file(copy)?,
            (false, true) => {}
        }
    }
    Ok(())
}
