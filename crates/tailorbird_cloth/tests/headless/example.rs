//! The example `headless`, in processes of its own: Cargo does not tell tests where examples are, and a process has one set of threads.

use std::{collections::BTreeMap, env, process::Output};

use serde_json::Value;
use tailorbird_test::child;

#[path = "../../examples/headless/main.rs"]
mod headless;

/// Its arguments for [`as_the_example`], one on each line.
const ARGUMENTS: &str = "HEADLESS_ARGUMENTS";

/// Not a test: in a process that [`run`] starts this is the example.
#[test]
fn as_the_example() {
    if let Ok(arguments) = env::var(ARGUMENTS) {
        let name = std::iter::once("headless");
        let code = headless::headless(name.chain(arguments.lines()).map(Into::into));
        std::process::exit(code.into());
    }
}

/// Runs it with these arguments, separated by spaces.
pub fn run(arguments: &str) -> Output {
    let arguments = arguments.replace(' ', "\n");
    child::output("example::as_the_example", ARGUMENTS, &arguments)
}

/// Runs it with `--json`.
pub fn json(arguments: &str) -> BTreeMap<String, Value> {
    let output = run(&format!("{arguments} --json"));
    assert!(output.status.success(), "{arguments}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}
