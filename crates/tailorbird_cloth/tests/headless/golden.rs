//! State hashes of all scenes, written down.

use std::{fmt::Write, fs, path::Path};

use tailorbird_test::golden;

use crate::example::json;

/// A line for each run: its hash, and its arguments.
const FILE: &str = "tests/headless/golden.txt";

#[test]
#[cfg_attr(
    not(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")),
    ignore = "sines and powers of another `libm` have other bits"
)]
fn scenes_have_the_bits_that_are_written_down() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let written = fs::read_to_string(&path).unwrap();
    let mut now = String::new();
    for line in written.lines() {
        let (_, arguments) = line.split_once(' ').unwrap();
        let report = json(arguments);
        let hash = report["state_hash"].as_str().unwrap();
        writeln!(now, "{hash} {arguments}").unwrap();
    }
    golden::check(&path, &now);
}
