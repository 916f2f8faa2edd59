//! Stretch of a sheet that should not stretch.

use std::f32::consts::TAU;

use bevy_math::{UVec2, Vec3};
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet};

const SIZE: UVec2 = UVec2::splat(64);

/// The largest of each figure over some steps; `before` is done before each of them.
fn worst(sheet: &mut Sheet, steps: u32, mut before: impl FnMut(&mut Sheet, u32)) -> ClothStretch {
    let mut worst = ClothStretch::default();
    for step in 0..steps {
        before(sheet, step);
        sheet.step();
        let ClothStretch { mean, p99, max } = sheet.stretch();
        worst.mean = worst.mean.max(mean);
        worst.p99 = worst.p99.max(p99);
        worst.max = worst.max.max(max);
    }
    assert_eq!(sheet.complaint(), None);
    worst
}

/// Checks the mean, the 99 % and the largest against bounds.
fn check(what: &str, is: ClothStretch, [mean, p99, max]: [f32; 3]) {
    println!("{what}: {is:?}");
    assert!(
        is.mean <= mean && is.p99 <= p99 && is.max <= max,
        "{what}: {is:?}"
    );
}

#[test]
fn a_hanging_sheet_hardly_stretches() {
    let mut sheet = Sheet::new(&Scene::hang(SIZE));
    let falling = worst(&mut sheet, 225, |_, _| ());
    println!("hang, falling: {falling:?}");
    let hanging = worst(&mut sheet, 75, |_, _| ());
    check("hang, last quarter", hanging, [6e-5, 8e-4, 7e-3]);
}

/// Substeps for forces of many times the weight: transverse waves then outrun the eight substeps of a quiet sheet of this size.
const BUSY: Option<u32> = Some(16);

#[test]
fn a_sheet_in_a_storm_hardly_stretches_but_for_single_edges() {
    // 20 m/s.
    let mut sheet = Sheet::new(&Scene {
        pins: ClothPins::edges([ClothEdge::Left]),
        gravity: Vec3::NEG_Y * G,
        wind: ClothWind::steady(Vec3::new(19.0, 0.0, 6.2)),
        substeps: BUSY,
        ..Scene::hang(SIZE)
    });
    let worst = worst(&mut sheet, 300, |_, _| ());
    check("storm", worst, [1.3e-3, 0.02, 0.35]);
}

/// More while it blows, as many as before afterwards, and no more where the budget is 0.
#[test]
fn substeps_follow_a_storm() {
    let storm = ClothWind::steady(Vec3::new(19.0, 0.0, 6.2));
    for budget in [0, 500_000] {
        let mut sheet = Sheet::new(&Scene {
            pins: ClothPins::edges([ClothEdge::Left]),
            gravity: Vec3::NEG_Y * G,
            wind: storm.clone(),
            ..Scene::hang(SIZE)
        });
        sheet.sim.resource_mut::<ClothSettings>().substep_budget = budget;
        let substeps = |sheet: &Sheet| sheet.sim.resource::<ClothStep>().substeps();
        sheet.step();
        let calm = substeps(&sheet);
        let mut blown = calm;
        for _ in 0..240 {
            sheet.step();
            blown = blown.max(substeps(&sheet));
        }
        sheet.sim.app.insert_resource(ClothWind::vacuum());
        sheet.steps(900);
        let after = substeps(&sheet);
        println!("budget {budget}: {calm}, {blown}, {after} substeps");
        assert_eq!(after, calm);
        assert_eq!(blown > calm, budget > 0, "{calm}, {blown}");
        assert_eq!(sheet.complaint(), None);
    }
}

#[test]
fn a_sheet_that_is_dragged_quickly_stretches_at_few_edges() {
    let mut sheet = Sheet::new(&Scene {
        gravity: Vec3::NEG_Y * G,
        substeps: BUSY,
        ..Scene::hang(SIZE)
    });
    let pins = [0, SIZE.x - 1].map(|i| (i, sheet.particles().position(i as usize)));
    // 1 m aside and back, twice in a second: up to 6.3 m/s and 79 m/s².
    let drag = |sheet: &mut Sheet, step: u32| {
        let phase = TAU * 2.0 * step as f32 / 60.0;
        let aside = Vec3::X * 0.5 * (1.0 - phase.cos());
        sheet.change(|held: &mut ClothPins| {
            held.pins = pins.map(|(i, at)| ClothPin::at(i, at + aside)).to_vec();
        });
    };
    check("drag", worst(&mut sheet, 180, drag), [6.5e-3, 0.12, 1.4]);
}

#[test]
fn a_sheet_that_falls_on_a_sphere_hardly_stretches_but_for_single_edges() {
    let mut sheet = Sheet::new(&Scene::drape(SIZE));
    let worst = worst(&mut sheet, 300, |_, _| ());
    check("drape", worst, [1.9e-3, 0.023, 0.18]);
}
