//! Measures other cloth solvers on the scene `hang` of Tailorbird's example `headless`, and plots such figures.
//!
//! ```sh
//! cargo run --release --manifest-path benches/peers/Cargo.toml -- --size 64 --iterations 15 --json peers.json
//! cargo run --release --manifest-path benches/peers/Cargo.toml -- plot peers.json tailorbird.json --out stretch.svg
//! ```

mod cli;
mod error;
mod peers;
mod plot;
mod record;
mod run;
mod scene;

use std::process::ExitCode;

use clap::Parser as _;

use cli::{Cli, Command};

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.command {
        Some(Command::Plot(args)) => plot::draw(args),
        None => run::measure(&cli.measure),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
