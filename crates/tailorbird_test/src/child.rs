//! Tests that run in a process of their own, as a process has one set of threads.

use std::{
    env,
    process::{Command, Output},
};

/// Output of a test of this binary that runs alone, where an environment variable has this value.
///
/// `test` is its whole name, with its modules. What the test harness says is cut off: first, and of a test that takes long.
pub fn output(test: &str, variable: &str, value: &str) -> Output {
    let mut output = Command::new(env::current_exe().unwrap())
        .args(["--exact", test, "--nocapture"])
        .env(variable, value)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let (_, text) = text
        .split_once("running 1 test\n")
        .expect("one test has that name");
    let long = format!("test {test} has been running for over 60 seconds\n");
    output.stdout = text.replace(&long, "").into();
    output
}

const THREADS: &str = "TAILORBIRD_TEST_THREADS";

const MARK: &str = "bits: ";

/// On how many threads this process is asked to simulate, if it is a child.
pub fn threads() -> Option<usize> {
    env::var(THREADS).ok()?.parse().ok()
}

/// Tells bits to the parent.
pub fn tell(bits: u64) {
    println!("{MARK}{bits:016x}");
}

/// The bits that a test tells on so many threads.
pub fn bits(test: &str, threads: usize) -> Vec<String> {
    let output = output(test, THREADS, &threads.to_string());
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let told = text.lines().filter_map(|line| line.split_once(MARK));
    told.map(|(_, bits)| bits.to_owned()).collect()
}
