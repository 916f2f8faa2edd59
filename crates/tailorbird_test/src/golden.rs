//! Bits that are written down: a change of the code that is to change no behaviour changes none of them.
//!
//! They are the same with every instruction set and number of threads; with another `libm` they may not be. `GOLDEN=write` writes them anew,
//! for a change that means to.

use std::{env, fs, path::Path};

/// Compares lines with those of a file, or writes them.
///
/// # Panics
///
/// If they differ, or if there are none.
pub fn check(file: &Path, now: &str) {
    assert!(!now.is_empty(), "nothing to compare");
    if env::var("GOLDEN").is_ok_and(|what| what == "write") {
        fs::write(file, now).expect("written");
        return;
    }
    let golden = fs::read_to_string(file).expect("the file");
    let changed: Vec<&str> = (now.lines().zip(golden.lines()))
        .filter_map(|(now, before)| (now != before).then_some(now))
        .collect();
    assert!(
        now == golden,
        "other bits (`GOLDEN=write` writes them down): {changed:#?}"
    );
}
