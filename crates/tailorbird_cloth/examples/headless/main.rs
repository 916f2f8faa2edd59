//! A cloth without a renderer, with a command line for measuring.
//!
//! ```text
//! cargo run --release -p tailorbird_cloth --example headless -- --scene hang --size 64 --json
//! ```
//!
//! Simulates one sheet for a number of steps and prints how long a step took and how well the sheet held: a table, or
//! JSON with `--json`. `--dump` writes where the particles are. `--help` lists the rest.

mod cli;
mod demands;
mod dump;
mod mesh;
mod paths;
mod peaks;
mod play;
mod report;
mod scene;
mod values;

use std::{
    ffi::OsString,
    fs::File,
    io::{self, BufWriter, Write as _},
    process::ExitCode,
    time::Duration,
};

use clap::{CommandFactory as _, Parser as _, error::ErrorKind};
use tailorbird_cloth::prelude::*;

use cli::Args;
use dump::Dump;
use scene::Sheet;

#[cfg_attr(
    test,
    expect(dead_code, reason = "tests/headless/main.rs calls what it calls")
)]
fn main() -> ExitCode {
    ExitCode::from(headless(std::env::args_os()))
}

/// The whole program: its arguments, its name first, to its exit code. Ends the process where they are wrong.
pub fn headless(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let args = Args::parse_from(arguments);
    // Before the first step, so that a path that cannot be written costs no time.
    let dump = args.dump.as_ref().map(|path| match File::create(path) {
        Ok(file) => Dump::new(BufWriter::new(file), args.dump_every, args.steps()),
        Err(error) => {
            let path = path.display();
            let message = format!("invalid value '{path}' for '--dump <FILE>': {error}");
            let kind = ErrorKind::ValueValidation;
            Args::command().error(kind, message).exit()
        }
    });
    match run(&args, dump) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            1
        }
    }
}

/// Simulates and prints.
fn run(args: &Args, mut dump: Option<Dump<BufWriter<File>>>) -> io::Result<()> {
    let mut sheet = Sheet::new(args);
    let mut times = Vec::with_capacity(args.steps() as usize);
    if let Some(dump) = &mut dump {
        dump.write(0, &sheet)?;
    }
    for step in 1..=args.steps() {
        times.push(sheet.step());
        if let Some(dump) = &mut dump {
            dump.write(step, &sheet)?;
        }
    }
    if let Some(dump) = dump {
        dump.finish()?;
    }
    let done = sheet.app.world().resource::<ClothStep>().steps();
    if done != u64::from(args.steps()) {
        return Err(io::Error::other(format!(
            "{done} steps were simulated, not {}",
            args.steps()
        )));
    }

    let report = report::Report::of(args, &sheet, median(times));
    let mut stdout = io::stdout().lock();
    if args.json {
        serde_json::to_writer(&mut stdout, &report)?;
        writeln!(stdout)?;
    } else {
        write!(stdout, "{}", report::Table(&report, args))?;
    }
    match sheet.errors() {
        errors if errors.is_empty() => Ok(()),
        errors => Err(io::Error::other(errors.join("; "))),
    }
}

/// The middle one, or the longer one of the middle two; zero where there is none.
fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
