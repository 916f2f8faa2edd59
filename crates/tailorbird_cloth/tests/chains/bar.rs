//! A strip that hangs by its upper edge is an elastic bar: it gets longer by c σ g L²/2.

use bevy_math::{UVec2, Vec2, Vec3};
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet, rigid};

const LENGTH: f32 = 1.0;
const COLUMNS: u32 = 4;

/// Returns whether waves across a strip of this length stay small. Tension T acts along the edges as they are predicted to lie, so that a
/// wave of the shortest length goes as y' = (1 − κ) (2 y − y⁻) with κ = 4 h² T/(m L), which grows from κ = 4/3 on. At the clamp κ is 4
/// rows² g h²/length.
fn is_stable(rows: u32, substeps: u32) -> bool {
    let seconds = 1.0 / (60.0 * substeps as f32);
    4.0 * (rows * rows) as f32 * G * seconds * seconds / LENGTH < 4.0 / 3.0
}

/// Elongation of the strip \[m\]; the mean of its columns.
fn elongation(rows: u32, substeps: u32, material: ClothMaterial) -> f64 {
    let across = LENGTH / (rows - 1) as f32 * (COLUMNS - 1) as f32;
    let mut strip = Sheet::new(&Scene {
        size: Vec2::new(across, LENGTH),
        resolution: UVec2::new(COLUMNS, rows),
        material,
        pins: ClothPins::edges([ClothEdge::Top]),
        gravity: Vec3::NEG_Y * G,
        substeps: Some(substeps),
        ..Scene::default()
    });
    strip.steps(300);
    assert_eq!(strip.complaint(), None);
    let particles = strip.particles();
    let length = |column: u32| {
        let top = particles.position(column as usize);
        let bottom = particles.position(((rows - 1) * COLUMNS + column) as usize);
        f64::from(top.y - bottom.y)
    };
    (0..COLUMNS).map(length).sum::<f64>() / f64::from(COLUMNS) - f64::from(LENGTH)
}

#[test]
fn a_hanging_strip_gets_longer_as_an_elastic_bar_at_any_resolution() {
    let compliance = 2e-3;
    let material = ClothMaterial {
        warp_compliance: compliance,
        weft_compliance: compliance,
        shear_compliance: 1e4,
        bend_compliance: 1e9,
        damping: 3.0,
        ..rigid()
    };
    let expected = f64::from(0.5 * compliance * material.areal_density * G * LENGTH * LENGTH);
    let mut wrong = Vec::new();
    for rows in [32, 64, 128] {
        for substeps in [2, 4, 8, 16] {
            if !is_stable(rows, substeps) {
                continue;
            }
            let ratio = elongation(rows, substeps, material) / expected;
            println!("rows {rows}, substeps {substeps}: {ratio:.4} of {expected:.6} m");
            if (ratio - 1.0).abs() > 0.005 {
                wrong.push((rows, substeps, ratio));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
