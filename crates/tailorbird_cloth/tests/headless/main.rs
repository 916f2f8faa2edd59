//! The command line of the example `headless`: what it prints and writes, and how it refuses.

#![cfg(test)]

use std::{fs, path::PathBuf};

mod example;
mod golden;

use example::{json, run};

/// Runs it with `--dump`, and reads step, row, column and x, y, z.
fn dump(name: &str, arguments: &str) -> Vec<([usize; 3], [f64; 3])> {
    // Each test has names of its own.
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let output = run(&format!("{arguments} --dump={}", path.display()));
    assert!(output.status.success(), "{arguments}: {output:?}");
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("step,row,column,x,y,z"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), 6, "{line}");
            let whole = |k: usize| cells[k].parse().unwrap();
            let number = |k: usize| {
                let digits = cells[k].split('e').next().unwrap();
                let digits = digits.chars().filter(char::is_ascii_digit).count();
                assert_eq!(digits, 9, "{line}");
                cells[k].parse().unwrap()
            };
            (
                [whole(0), whole(1), whole(2)],
                [number(3), number(4), number(5)],
            )
        })
        .collect()
}

#[test]
fn json_has_the_keys_and_their_types() {
    let report = json("--scene hang --size 8 --steps 5");
    let keys: Vec<&str> = report.keys().map(String::as_str).collect();
    let expected = [
        "constraints",
        "energy_gained",
        "highest_y",
        "kinetic_energy",
        "lowest_y",
        "min_sphere_clearance",
        "momentum",
        "ms_per_step_median",
        "particles",
        "speed_max",
        "speed_peak",
        "state_hash",
        "step_speed_max",
        "step_speed_rms",
        "steps",
        "stretch_max",
        "stretch_mean",
        "stretch_p99",
        "stretch_peak",
        "substeps",
    ];
    assert_eq!(keys, expected);
    assert_eq!(report["particles"], 64);
    // Springs to the neighbours at 1, √2, 2 and 2√2.
    assert_eq!(
        report["constraints"],
        2 * 8 * 7 + 2 * 7 * 7 + 2 * 8 * 6 + 2 * 6 * 6
    );
    assert_eq!(report["steps"], 5);
    assert!(report["ms_per_step_median"].as_f64().unwrap() > 0.0);
    assert_eq!(report["momentum"].as_array().unwrap().len(), 3);
    assert!(report["min_sphere_clearance"].is_null());
    assert_eq!(report["state_hash"].as_str().unwrap().len(), 16);
    let [mean, p99, max] =
        ["stretch_mean", "stretch_p99", "stretch_max"].map(|key| report[key].as_f64().unwrap());
    assert!(0.0 < mean && mean <= p99 && p99 <= max);
}

#[test]
fn the_table_names_the_same_figures() {
    let output = run("--size 8 --steps 5 --scene drape");
    let text = String::from_utf8(output.stdout).unwrap();
    for name in [
        "constraints",
        "ms",
        "stretch",
        "kinetic energy",
        "clearance",
    ] {
        assert!(text.contains(name), "{text}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit_and_a_seed_does() {
    for scene in ["hang", "flag", "drape", "free"] {
        let hash = |rest: &str| {
            let report = json(&format!("--scene {scene} --size 24 --steps 40 {rest}"));
            report["state_hash"].clone()
        };
        let one = hash("--threads 1");
        for threads in [2, 4] {
            assert_eq!(hash(&format!("--threads {threads}")), one, "{scene}");
        }
        assert_eq!(hash("--seed 0"), one, "{scene}");
        let seeded = hash("--seed 7");
        assert_ne!(seeded, one, "{scene}");
        assert_ne!(seeded, hash("--seed 8"), "{scene}");
        assert_eq!(seeded, hash("--seed 7"), "{scene}");
    }
}

#[test]
fn the_sheet_starts_as_described_and_its_pins_hold() {
    let last = 6;
    let particles = dump(
        "start.csv",
        "--scene hang --size 7 --steps 20 --dump-every 20",
    );
    assert_eq!(particles.len(), 2 * 49);
    let (start, end) = particles.split_at(49);
    for (k, ([step, row, column], [x, y, z])) in start.iter().enumerate() {
        assert_eq!([*step, *row, *column], [0, k / 7, k % 7]);
        let at = |i: usize| i as f64 / 3.0 - 1.0;
        let place = [(x, at(*column)), (y, 1.0), (z, at(*row))];
        assert!(
            place.iter().all(|(is, ought)| (*is - ought).abs() < 1e-6),
            "{place:?}"
        );
    }
    for (([_, row, column], before), ([step, ..], after)) in start.iter().zip(end) {
        assert_eq!(*step, 20);
        let pinned = *row == 0 && (*column == 0 || *column == last);
        assert_eq!(before == after, pinned, "{row} {column}");
    }
}

#[test]
fn dumps_the_last_step_alone_or_every_so_many() {
    let steps = |name: &str, arguments: &str| {
        let particles = dump(name, &format!("--size 2 {arguments}"));
        let mut steps: Vec<usize> = particles.iter().map(|([step, ..], _)| *step).collect();
        steps.dedup();
        steps
    };
    assert_eq!(steps("last.csv", "--steps 7"), [7]);
    assert_eq!(steps("every.csv", "--steps 7 --dump-every 3"), [0, 3, 6, 7]);
    assert_eq!(steps("none.csv", "--steps 0"), [0]);
}

#[test]
fn falls_freely_by_the_verlet_sum_at_any_rate() {
    for (hz, substeps) in [(60.0, 1), (60.0, 8), (2.0, 20), (144.0, 3)] {
        let report = json(&format!(
            "--scene free --size 5 --steps 40 --damping 0 --hz {hz} --substeps {substeps}"
        ));
        let (h, n) = (1.0 / (hz * f64::from(substeps)), f64::from(40 * substeps));
        let fallen = 9.81 * h * h * n * (n + 1.0) / 2.0;
        let error = report["lowest_y"].as_f64().unwrap() - (1.0 - fallen);
        assert!(error.abs() < 2e-5 * fallen, "{hz} Hz / {substeps}: {error}");
        // 0.15 kg/m² on 2 m × 2 m.
        let momentum: Vec<f64> = serde_json::from_value(report["momentum"].clone()).unwrap();
        let expected = [0.0, -0.6 * 9.81 * h * n, 0.0];
        for (is, ought) in momentum.iter().zip(expected) {
            assert!(
                (is - ought).abs() < 2e-5 * expected[1].abs(),
                "{momentum:?}"
            );
        }
    }
}

#[test]
fn a_draped_sheet_stays_outside_the_sphere_and_comes_to_rest() {
    let report = json("--scene drape --size 20 --steps 600");
    let clearance = report["min_sphere_clearance"].as_f64().unwrap();
    // The thickness of cotton.
    assert!((clearance - 0.005).abs() < 1e-5, "{clearance}");
    assert!(report["kinetic_energy"].as_f64().unwrap() < 1e-3);
}

#[test]
fn wrong_values_are_named_with_their_flag_and_end_with_code_2() {
    let wrong = [
        ("--scene", "fall"),
        ("--size", "1"),
        ("--size", "-3"),
        ("--size", "5000"),
        ("--pins", "all"),
        ("--steps", "-1"),
        ("--material", "steel"),
        ("--apart", "x"),
        ("--tight", "-0.1"),
        ("--depth", "NaN"),
        ("--speed", "0"),
        ("--body", "cat"),
        ("--hz", "0"),
        ("--hz", "NaN"),
        ("--hz", "-60"),
        ("--substeps", "0"),
        ("--substeps", "2.5"),
        ("--iterations", "-1"),
        ("--iterations", "1001"),
        ("--solver", "jacobi"),
        ("--isa", "mmx"),
        ("--viscosity", "-1"),
        ("--bend-compliance", "NaN"),
        ("--gravity", "inf"),
        ("--damping", "-0.1"),
        ("--wind", "1,2"),
        ("--wind", "-1,NaN,2"),
        ("--sphere", "0,0,0,0"),
        ("--sphere", "-1,0,0,-1"),
        ("--compliance", "-1e-3"),
        ("--density", "0"),
        ("--density", "-0.15"),
        ("--threads", "0"),
        ("--seed", "x"),
        ("--dump", "/nowhere/dump.csv"),
    ];
    for (flag, value) in wrong {
        let output = run(&format!("{flag} {value}"));
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{flag} {value}: {message}");
        assert!(message.contains(flag), "{flag} {value}: {message}");
        assert!(
            message.contains(&format!("'{value}'")),
            "{flag} {value}: {message}"
        );
        assert!(output.stdout.is_empty(), "{flag} {value}");
    }
    let every = run("--size 2 --dump dump.csv --dump-every 0");
    assert_eq!(every.status.code(), Some(2));
}
