//! The tests of the kernels: which of them ask for which mutant, and what becomes of it in those.

use std::{
    error::Error,
    fs,
    io::{BufRead, BufReader},
    path::PathBuf,
    process::{Command, Stdio},
    sync::mpsc::{self, RecvTimeoutError},
    thread,
    time::{Duration, SystemTime},
};

use super::bench::Bench;

/// Tests that take no longer than this part of all of them come first.
const QUICK: u32 = 20;

/// Fate of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// A test fails with it.
    Killed,
    /// The tests take too long.
    TimedOut,
    /// All tests pass.
    Survived,
    /// No test comes by.
    NotReached,
    /// It does not build.
    Broken,
}

/// The tests, as they are without a mutant.
pub struct Tests {
    program: PathBuf,
    folder: PathBuf,
    all: Vec<Test>,
    /// The longest that tests may take.
    limit: Duration,
}

struct Test {
    name: String,
    takes: Duration,
    /// The mutants that it asks for, each or not.
    asks: Vec<bool>,
}

impl Tests {
    /// Runs each test alone, without a mutant.
    pub fn new(bench: &Bench, mutants: usize) -> Result<Self, Box<dyn Error>> {
        let mut tests = Self {
            program: bench.tests(),
            folder: bench.crate_folder(),
            all: Vec::new(),
            limit: Duration::from_secs(600),
        };
        let list = Command::new(&tests.program)
            .args(["kernels::", "--list"])
            .output()?;
        let list = String::from_utf8(list.stdout)?;
        let names = list.lines().filter_map(|line| line.strip_suffix(": test"));
        let file = tests.program.with_extension("asked");
        let (mut total, mut failed) = (Duration::ZERO, false);
        for name in names {
            fs::write(&file, "")?;
            let asked = [("MUTANTS_ASKED", file.to_string_lossy().into_owned())];
            if tests.run(&[name], &asked)? != Fate::Survived {
                eprintln!("without a mutant, {name} fails");
                failed = true;
                continue;
            }
            let mut asks = vec![false; mutants];
            for number in fs::read_to_string(&file)?.lines() {
                if let Some(asks) = asks.get_mut(number.parse::<usize>()? - 1) {
                    *asks = true;
                }
            }
            // With the answer no, for which nothing is written down.
            let start = SystemTime::now();
            tests.run(&[name], &[("MUTANT", "0".to_owned())])?;
            let takes = start.elapsed()?;
            total += takes;
            tests.all.push(Test {
                name: name.to_owned(),
                takes,
                asks,
            });
        }
        if failed {
            return Err("there are tests that fail without a mutant".into());
        }
        eprintln!(
            "{} tests of the kernels take {:.1} s",
            tests.all.len(),
            total.as_secs_f32()
        );
        tests.all.sort_by_key(|test| test.takes);
        tests.limit = total * 6 + Duration::from_secs(2);
        Ok(tests)
    }

    /// Finds the fate of a mutant in the tests that come by it, quick ones first.
    pub fn fate(&self, mutant: usize) -> Result<Fate, Box<dyn Error>> {
        let total: Duration = self.all.iter().map(|test| test.takes).sum();
        let asking = self.all.iter().filter(|test| test.asks[mutant]);
        let (quick, slow): (Vec<&Test>, Vec<&Test>) =
            asking.partition(|test| test.takes < total / QUICK);
        let mut fate = Fate::NotReached;
        for group in [quick, slow] {
            if group.is_empty() {
                continue;
            }
            let names: Vec<&str> = group.into_iter().map(|test| test.name.as_str()).collect();
            fate = self.run(&names, &[("MUTANT", (mutant + 1).to_string())])?;
            if fate != Fate::Survived {
                break;
            }
        }
        Ok(fate)
    }

    /// Runs tests until one fails.
    fn run(&self, names: &[&str], environment: &[(&str, String)]) -> Result<Fate, Box<dyn Error>> {
        let mut tests = Command::new(&self.program)
            .args(names)
            .args(["--exact", "--test-threads=1"])
            .current_dir(&self.folder)
            .envs(environment.iter().map(|(name, value)| (name, value)))
            // The same cases each time, none of them made smaller or kept.
            .env("PROPTEST_RNG_SEED", "1")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
            .env("RUST_BACKTRACE", "0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let output = tests.stdout.take().ok_or("no output")?;
        let (done, failed) = mpsc::channel();
        thread::spawn(move || {
            let mut lines = BufReader::new(output).lines().map_while(Result::ok);
            let any = lines.any(|line| line.ends_with("FAILED"));
            // Nobody listens where the time is up.
            let _ = done.send(any);
        });
        let fate = match failed.recv_timeout(self.limit) {
            Ok(false) => {
                let passed = tests.wait()?.success();
                return Ok(if passed { Fate::Survived } else { Fate::Killed });
            }
            Ok(true) => Fate::Killed,
            Err(RecvTimeoutError::Timeout) => Fate::TimedOut,
            Err(RecvTimeoutError::Disconnected) => {
                return Err("the reader of the output is gone".into());
            }
        };
        // It may have ended by itself.
        let _ = tests.kill();
        tests.wait()?;
        Ok(fate)
    }
}
