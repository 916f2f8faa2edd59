//! Changes the kernels of the solver in one place at a time and looks whether a test notices: what survives is held by no test.
//!
//! All mutants are built at once, each behind a question whether it is the one that is meant, so that there is one build for all of them and a
//! run of the tests for each. Those that do not build are found by the compiler's messages and left out.

mod bench;
mod find;
mod known;
mod plant;
mod source;
mod tests;

use std::{
    error::Error,
    path::Path,
    process::ExitCode,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use bench::Bench;
use find::Mutant;
use known::Known;
use source::Source;
use tests::{Fate, Tests};

/// Mutants to try.
#[derive(clap::Args)]
pub struct Options {
    /// Mutants in whose line of the table this occurs
    filter: Option<String>,
    /// Kernel files by their names, such as `line.rs`; all where none is given
    #[arg(long)]
    file: Vec<String>,
    /// Numbers alone, each larger by a tenth
    #[arg(long)]
    constants_only: bool,
    /// No more than so many
    #[arg(long)]
    limit: Option<usize>,
    /// So many runs at once; as many as there are processors where it is not given
    #[arg(long)]
    jobs: Option<usize>,
    /// List them, run nothing
    #[arg(long)]
    list: bool,
}

/// Tries the mutants; fails where one survives that is not listed.
///
/// # Errors
///
/// When files cannot be read or written, cargo cannot be started, or the tests fail without a mutant.
pub fn run(workspace: &Path, options: &Options) -> Result<ExitCode, Box<dyn Error>> {
    let crate_folder = workspace.join("crates/tailorbird_solver");
    let (sources, constants) = source::read(&crate_folder.join("src/kernels"))?;
    let mut mutants = Vec::new();
    for (number, source) in sources.iter().enumerate() {
        if source.is_kernel && (options.file.is_empty() || options.file.contains(&source.name)) {
            mutants.extend(find::find(number, source)?);
        }
    }
    find::number_within_lines(&mut mutants);
    mutants.retain(|mutant| {
        let row = row(&sources, mutant);
        (!options.constants_only || mutant.is_number)
            && options
                .filter
                .as_ref()
                .is_none_or(|filter| row.contains(filter))
    });
    mutants.truncate(options.limit.unwrap_or(usize::MAX));
    if options.list || mutants.is_empty() {
        mutants
            .iter()
            .for_each(|mutant| println!("{}", row(&sources, mutant)));
        println!("{} mutants", mutants.len());
        return Ok(ExitCode::SUCCESS);
    }

    let known = Known::read(&crate_folder.join("mutants.toml"))?;
    let bench = Bench::new(workspace, &crate_folder, &constants)?;
    let broken = bench.build(&sources, &mutants)?;
    let tests = Tests::new(&bench, mutants.len())?;
    let report = Report {
        sources: &sources,
        mutants: &mutants,
        known: &known,
    };
    let fates = fates(&tests, &report, &broken, options.jobs)?;
    Ok(report.sum(&fates))
}

/// Row of the table about a mutant.
fn row(sources: &[Source], mutant: &Mutant) -> String {
    let source = &sources[mutant.source];
    let (line, code) = (mutant.line, source.line(mutant.line));
    format!("{}:{line}: {}: {code}", source.name, mutant.change)
}

/// Runs the tests for each, and prints the table as it grows.
fn fates(
    tests: &Tests,
    report: &Report,
    broken: &[bool],
    jobs: Option<usize>,
) -> Result<Vec<Fate>, Box<dyn Error>> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let fates = Mutex::new(vec![Ok(Fate::Broken); broken.len()]);
    thread::scope(|scope| {
        for _ in 0..jobs.unwrap_or(processors) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(broken) = broken.get(k) else { return };
                    let fate = if *broken {
                        Ok(Fate::Broken)
                    } else {
                        tests.fate(k).map_err(|error| error.to_string())
                    };
                    if let Ok(fate) = fate {
                        report.tell(k, fate);
                    }
                    if let Ok(mut fates) = fates.lock() {
                        fates[k] = fate;
                    }
                }
            });
        }
    });
    let fates = fates.into_inner().map_err(|error| error.to_string())?;
    Ok(fates.into_iter().collect::<Result<_, String>>()?)
}

/// Report of a run.
struct Report<'a> {
    sources: &'a [Source],
    mutants: &'a [Mutant],
    known: &'a Known,
}

impl Report<'_> {
    fn is_known(&self, k: usize) -> bool {
        let mutant = &self.mutants[k];
        let source = &self.sources[mutant.source];
        self.known
            .is(&source.name, source.line(mutant.line), &mutant.change)
    }

    /// A row of the table.
    fn tell(&self, k: usize, fate: Fate) {
        let word = match (fate, self.is_known(k)) {
            (Fate::Killed, false) => "killed",
            (Fate::TimedOut, false) => "killed: takes too long",
            (Fate::Killed | Fate::TimedOut, true) => "killed, but listed",
            (Fate::Survived | Fate::NotReached, true) => "survived, as listed",
            (Fate::Survived, false) => "SURVIVED",
            (Fate::NotReached, false) => "SURVIVED: not reached",
            (Fate::Broken, _) => "does not build",
        };
        println!("{word:22} {}", row(self.sources, &self.mutants[k]));
    }

    /// Prints the number of each kind; fails where one survives that is not listed.
    fn sum(&self, fates: &[Fate]) -> ExitCode {
        let count = |kinds: &[Fate]| fates.iter().filter(|fate| kinds.contains(fate)).count();
        let survives = |fate: &Fate| matches!(fate, Fate::Survived | Fate::NotReached);
        let survivors = (0..fates.len()).filter(|k| survives(&fates[*k]));
        let (listed, others): (Vec<_>, Vec<_>) = survivors.partition(|k| self.is_known(*k));
        println!(
            "{} mutants: {} killed, {} of them by time; {} survived, as listed; {} survived; {} do not build",
            fates.len(),
            count(&[Fate::Killed, Fate::TimedOut]),
            count(&[Fate::TimedOut]),
            listed.len(),
            others.len(),
            count(&[Fate::Broken]),
        );
        if others.is_empty() {
            return ExitCode::SUCCESS;
        }
        println!(
            "Strengthen a test, or list it with its reason in crates/tailorbird_solver/mutants.toml."
        );
        ExitCode::FAILURE
    }
}
