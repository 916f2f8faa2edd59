//! The same bits with any instruction set and any number of threads.

use bevy_ecs::prelude::*;
use bevy_math::UVec2;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, child};

/// Sizes that leave remainders in vectors of 4, 8 and 16 lanes.
const SIZES: [UVec2; 3] = [UVec2::new(5, 7), UVec2::new(17, 33), UVec2::new(50, 50)];

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
            let scalar = hash(ClothInstructionSet::Scalar);
            for set in [
                ClothInstructionSet::Sse2,
                ClothInstructionSet::Avx2,
                ClothInstructionSet::Avx512,
                ClothInstructionSet::Auto,
            ] {
                assert_eq!(hash(set), scalar, "{name} {size}, {set:?}");
            }
        }
    }
}

/// Not a test: in a process of its own, as a process has one set of threads, this simulates and prints the bits.
#[test]
fn as_a_child() {
    let Some(threads) = child::threads() else {
        return;
    };
    let (small, large) = (UVec2::new(17, 33), UVec2::new(150, 131));
    for (scene, sheets) in [
        // Enough to be shared out.
        (Scene::hang(small), 32),
        (Scene::drape(small), 32),
        // Large enough for several threads at one.
        (Scene::hang(large), 1),
        (Scene::drape(large), 2),
    ] {
        let mut app = Sheet::new(&Scene {
            threads: Some(threads),
            sheets,
            ..scene
        });
        app.steps(60);
        let parallel = app.sim.resource::<ClothStep>().parallel();
        assert_eq!(parallel, sheets > 1);
        child::tell(app.hash());
    }
}

/// A game's systems between the stages run all cloths through each stage together; otherwise each goes through all substeps
/// by itself.
#[test]
fn systems_of_a_game_between_the_stages_change_nothing() {
    let size = UVec2::new(17, 33);
    for scene in [Scene::hang(size), Scene::drape(size)] {
        let hash = |with_system: bool| {
            let mut sheet = Sheet::new(&scene);
            sheet.sim.app.init_resource::<Calls>();
            if with_system {
                let count = |mut calls: ResMut<Calls>| calls.0 += 1;
                sheet.sim.app.add_systems(ClothSubstep, count);
            }
            sheet.steps(60);
            let calls = sheet.sim.resource::<Calls>().0;
            let substeps = sheet.sim.resource::<ClothStep>().substeps();
            assert_eq!(calls, if with_system { 60 * substeps } else { 0 });
            sheet.hash()
        };
        assert_eq!(hash(true), hash(false));
    }
}

#[derive(Resource, Default)]
struct Calls(u32);

#[test]
fn every_number_of_threads_gives_the_same_bits() {
    let bits = |threads| child::bits("bits::as_a_child", threads);
    let one = bits(1);
    assert_eq!(one.len(), 4);
    for threads in [2, 4] {
        assert_eq!(bits(threads), one, "{threads} threads");
    }
}
