//! State hashes of all scenes, written down: a change of the code that is to change no behaviour changes none of them.
//!
//! They are the same with every instruction set and number of threads; with another `libm` they may not be. `GOLDEN=write` writes them anew,
//! for a change that means to.

use std::{env, fmt::Write, fs, path::Path};

use crate::json;

/// A line for each run: its hash, and its arguments.
const FILE: &str = "tests/headless/golden.txt";

#[test]
#[cfg_attr(
    not(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")),
    ignore = "sines and powers of another `libm` have other bits"
)]
fn scenes_have_the_bits_that_are_written_down() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let golden = fs::read_to_string(&path).unwrap();
    let mut now = String::new();
    for line in golden.lines() {
        let (_, arguments) = line.split_once(' ').unwrap();
        let report = json(arguments);
        let hash = report["state_hash"].as_str().unwrap();
        writeln!(now, "{hash} {arguments}").unwrap();
    }
    if env::var("GOLDEN").is_ok_and(|what| what == "write") {
        fs::write(path, now).unwrap();
        return;
    }
    let changed: Vec<&str> = (now.lines().zip(golden.lines()))
        .filter_map(|(now, before)| (now != before).then_some(now))
        .collect();
    assert!(
        golden.lines().count() > 0 && changed.is_empty(),
        "other bits (`GOLDEN=write` writes them down): {changed:#?}"
    );
}
