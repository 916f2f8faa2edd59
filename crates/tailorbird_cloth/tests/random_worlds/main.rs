//! Random worlds: whatever happens to a cloth, two seconds after it has ended the cloth rests, falls or swings.
//!
//! A world is a sheet (a grid or an irregular mesh), what holds it, and up to nine events within two seconds: holds that move at any
//! speed, hop, turn and let go, colliders that appear, fly, jump and vanish, layers, scales and mirrors, teleports, pauses, wind of up to
//! 100 m/s, other gravity. Then everything stands where it is, and the air is still. `world.rs` has the distributions.
//!
//! The demands (`checks.rs`):
//!
//! 1. **Nothing is wrong**: in all steps each particle is at a finite place, and [`ClothStatus`](tailorbird_cloth::prelude::ClothStatus)
//!    has no error. No two particles are farther apart than 10 times the sheet's diagonal, in the end 3 times, and the ways of all holds,
//!    and 3 m for each collider.
//! 2. **Energy does not rise**: the kinetic and potential energy of the free particles, from half a second into the calm on. Its largest
//!    value within the time for which a fabric may keep energy and give it back (a quarter of a second, or a period of what hangs and
//!    stretches) never rises by more than 1 %: of the weight times the sheet's diagonal, and the kinetic energy at the start. There is work,
//!    and the clock starts anew, while a particle is inside a collider, which pushes it out, and until edges are for the first time longer by
//!    less than 1 % in the mean; what is stretched later has stretched itself. Where nothing touches a cloth that falls in a vacuum, it is
//!    the energy of motion as seen from its middle. In the last half second, energy falls at least half as fast as
//!    `ClothMaterial::damping` alone takes it, but for that 1 %.
//! 3. **It rests, falls or swings**, in the half second after two seconds. Each particle is slower than 0.1 m/s, or
//!    - no faster than √2 times what falls from the highest particle, having started with the speed of the fastest, both at half a second
//!      (the tip of a whip is faster than what swings it). What was pushed out of colliders, or came back to its length, later than that
//!      may have 2 m/s;
//!    - and does not tremble: what of its velocity is not that of the whole as a rigid body differs from its own mean over 0.08 s by less
//!      than 0.1 m/s, as the median of that half second, so that a single blow does not count. Where the cloth as a whole is faster than
//!      0.2 m/s (root of the mean square; in a vacuum as seen from its middle), by less than half of that.
//!
//! 2 and 3 are asked where no two holds are more than 10 times as far apart as in the flat sheet.
//!
//! So a sheet that swings or flutters as a whole passes, and a particle that shakes in one that hangs still does not.
//!
//! Worlds are numbered, and a number is always the same world, as long as the strategies in `world.rs` are the same.
//!
//! - `RANDOM_WORLDS=1000` tries so many, from the first or from `RANDOM_WORLDS_FROM` on; 60 without. A thousand take about a minute in an
//!   optimised build.
//! - `RANDOM_WORLD=17` tries that one alone, and prints it.
//!
//! The first world that fails is shrunk, to one that fails the same check.

#![cfg(test)]

mod checks;
mod film;
mod known;
#[path = "../../examples/headless/mesh.rs"]
#[expect(dead_code, reason = "shared with the example `headless`")]
mod mesh;
mod motion;
mod play;
mod scene;
mod world;

use std::env;

use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{RngSeed, TestError, TestRunner},
};

use checks::{Kind, check};
use scene::happen;
use world::{World, world};

/// Longest time for which anything may happen \[s\].
const WILD: f32 = 2.0;

/// When energy is looked at, after that \[s\].
const SETTLED: f32 = 0.5;

/// And when speeds are \[s\].
const CALM: f32 = 2.0;

/// For how long \[s\].
const WATCHED: f32 = 0.5;

/// Number of worlds that are tried unless more are asked for.
const WORLDS: u64 = 60;

/// Verdict on a world, if anything is wrong with it.
fn verdict(world: &World) -> Option<(Kind, String)> {
    let (figures, violations) = check(&happen(world));
    let kind = violations.first()?.kind;
    let texts: Vec<String> = violations.iter().map(ToString::to_string).collect();
    Some((kind, format!("{} ({figures})", texts.join("; "))))
}

fn runner(number: u64) -> TestRunner {
    TestRunner::new(ProptestConfig {
        cases: 1,
        failure_persistence: None,
        max_shrink_iters: 300,
        rng_seed: RngSeed::Fixed(number),
        ..ProptestConfig::default()
    })
}

/// The smallest world like this one that fails the same check, and how.
fn shrunk(number: u64, kind: Kind) -> String {
    let mut runner = runner(number);
    let tree = world().new_tree(&mut runner).unwrap();
    let result = runner.run_one(tree, |world| match verdict(&world) {
        Some((found, text)) if found == kind => Err(TestCaseError::fail(text)),
        _ => Ok(()),
    });
    match result {
        Err(TestError::Fail(why, world)) => format!("{why}\n{world:#?}"),
        other => format!("{other:?}"),
    }
}

fn number(name: &str) -> Option<u64> {
    env::var(name).ok().map(|text| text.parse().unwrap())
}

#[test]
fn two_seconds_after_anything_cloth_rests_falls_or_swings() {
    let alone = number("RANDOM_WORLD");
    let numbers = if let Some(number) = alone {
        number..number + 1
    } else {
        let first = number("RANDOM_WORLDS_FROM").unwrap_or(0);
        first..first + number("RANDOM_WORLDS").unwrap_or(WORLDS)
    };
    let mut failed = Vec::new();
    for number in numbers.clone() {
        let world = world().new_tree(&mut runner(number)).unwrap().current();
        if alone.is_some() {
            println!("{world:#?}");
        }
        if let Some((kind, text)) = verdict(&world) {
            println!("world {number}: {text}");
            failed.push((number, kind));
        }
    }
    if let Some((first, kind)) = failed.first() {
        panic!(
            "{} of {} worlds: {failed:?}\nworld {first}, shrunk: {}",
            failed.len(),
            numbers.end - numbers.start,
            shrunk(*first, *kind),
        );
    }
}
