//! The project's chores. `cargo demo` is short for `cargo xtask demo`; see `.cargo/config.toml`.

mod circles;
mod demo;
mod fabric;
mod garment;
mod mutants;
mod textures;

use std::{
    error::Error,
    ffi::OsString,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(about)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Fail where files of the crates import each other in a circle
    Circles,
    /// Install what the demo needs where that is missing, then run it; `--help` is the demo's
    #[command(disable_help_flag = true)]
    Demo {
        /// Passed on to the demo
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Cut the example garment in assets/garments
    Garment,
    /// Change the solver's kernels in one place at a time and look whether a test notices
    ///
    /// Numbers become larger by a tenth; + and -, * and /, < and >, min and max take each other's place. All mutants are built at once, in a
    /// copy in the target folder, and each is run in the tests that come by it. On two processors the first build takes four minutes more than
    /// later ones, which take two minutes for a file or some and about eight for all; a thousand mutants then run in a minute. Fails where one
    /// survives that the solver's list of survivors does not name with a reason.
    Mutants(mutants::Options),
    /// Weave the fabric textures: of full size in assets/textures, small ones in the crate
    Textures,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    match Arguments::parse().task {
        Task::Circles => circles::run(&workspace()),
        Task::Demo { arguments } => Ok(demo::run(&workspace(), &arguments)?),
        Task::Garment => {
            garment::write(&workspace().join("assets/garments"))?;
            Ok(ExitCode::SUCCESS)
        }
        Task::Mutants(options) => mutants::run(&workspace(), &options),
        Task::Textures => {
            textures::write(&workspace().join("assets/textures"), 1024)?;
            textures::write(
                &workspace().join("crates/tailorbird/src/fabric/textures"),
                256,
            )?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

fn workspace() -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask).to_owned()
}
