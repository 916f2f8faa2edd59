//! Measures time against stretch: the chain solver over its substeps, the classic relaxation over its iterations.
//!
//! ```text
//! cargo run --release -p tailorbird_cloth --example bench -- hang --size 64 --json hang.json
//! ```
//!
//! 5 s at 60 Hz each; `kernels` measures each kernel by itself, `colliders` what each shape costs, `substep` what systems within
//! a substep cost. Prints a table; `--json` writes the same figures as an array,
//! which `benches/peers` can draw (but for those). `--help` lists the rest.

mod cli;
mod colliders;
mod kernels;
mod machine;
mod measure;
mod record;
mod scene;
mod substep;
mod times;

use std::{fs::File, io, process::ExitCode};

use clap::Parser as _;

use cli::{Args, What};
use record::{HEADER, Record};

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Measures, prints and writes.
fn run(args: &Args) -> io::Result<()> {
    // Before the first measurement, so that a path that cannot be written costs no time.
    let file = args.json.as_ref().map(File::create).transpose()?;
    println!("{}", machine::describe());
    if args.what == What::Kernels {
        let records = kernels::run(args);
        if let Some(file) = file {
            serde_json::to_writer_pretty(file, &records)?;
        }
        return Ok(());
    }
    if args.what == What::Colliders {
        let colliders = colliders::run(args);
        if let Some(file) = file {
            serde_json::to_writer_pretty(file, &serde_json::json!({ "colliders": colliders }))?;
        }
        return Ok(());
    }
    if args.what == What::Substep {
        let records = substep::run(args);
        if let Some(file) = file {
            serde_json::to_writer_pretty(file, &records)?;
        }
        return Ok(());
    }
    println!("{HEADER}");
    let mut records: Vec<Record> = Vec::new();
    for setup in scene::setups(args) {
        let record = measure::measure(&setup, args);
        println!("{record}");
        records.push(record);
    }
    if let Some(file) = file {
        serde_json::to_writer_pretty(file, &records)?;
    }
    Ok(())
}
