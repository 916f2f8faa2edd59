//! The same bits with any instruction set and any number of threads.

use std::{env, process::Command};

use bevy_math::UVec2;
use tailorbird_cloth::prelude::*;

use crate::scene::{Scene, Sheet};

/// Sizes that leave remainders in vectors of 4, 8 and 16 lanes.
const SIZES: [UVec2; 3] = [UVec2::new(5, 7), UVec2::new(17, 33), UVec2::new(50, 50)];

/// How many threads the child has.
const THREADS: &str = "CHAINS_TEST_THREADS";

const MARK: &str = "bits: ";

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for size in SIZES {
        for (name, scene) in [("hang", Scene::hang(size)), ("drape", Scene::drape(size))] {
            let hash = |instruction_set| {
                let scene = Scene {
                    instruction_set,
                    ..scene.clone()
                };
                let mut sheet = Sheet::new(&scene);
                sheet.steps(120);
                assert_eq!(sheet.complaint(), None);
                sheet.hash()
            };
            let scalar = hash(InstructionSet::Scalar);
            for set in [
                InstructionSet::Sse2,
                InstructionSet::Avx2,
                InstructionSet::Avx512,
                InstructionSet::Auto,
            ] {
                assert_eq!(hash(set), scalar, "{name} {size}, {set:?}");
            }
        }
    }
}

/// Not a test: in a process of its own, as a process has one set of threads, this simulates and prints the bits.
#[test]
fn as_a_child() {
    let Ok(threads) = env::var(THREADS) else {
        return;
    };
    for scene in [
        Scene::hang(UVec2::new(17, 33)),
        Scene::drape(UVec2::new(17, 33)),
    ] {
        let mut sheets = Sheet::new(&Scene {
            threads: threads.parse().ok(),
            // Enough particles to be shared out.
            sheets: 32,
            ..scene
        });
        sheets.steps(60);
        assert!(sheets.app.world().resource::<ClothStep>().parallel());
        println!("{MARK}{:016x}", sheets.hash());
    }
}

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let bits = |threads: u32| -> Vec<String> {
        let output = Command::new(env::current_exe().unwrap())
            .args(["--exact", "bits::as_a_child", "--nocapture"])
            .env(THREADS, threads.to_string())
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines()
            .filter_map(|line| line.split_once(MARK))
            .map(|(_, bits)| bits.to_owned())
            .collect()
    };
    let one = bits(1);
    assert_eq!(one.len(), 2);
    for threads in [2, 4] {
        assert_eq!(bits(threads), one, "{threads} threads");
    }
}
