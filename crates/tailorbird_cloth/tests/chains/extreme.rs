//! Extreme worlds stay finite, and recover when they become ordinary.

use bevy_math::{UVec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet, rigid};

/// State of a sheet afterwards.
#[derive(Clone, Copy)]
enum After {
    /// Well: the same as without it.
    Well,
    /// Finite and in one piece, but it may be wound up in itself, where rows and columns ask for opposite things, and then trembles by no
    /// more than this \[m/s\].
    Knotted(f64),
}

/// Lets an ordinary sheet hang, does something to it for some steps, and lets it hang again.
fn survives(
    what: &str,
    scene: &Scene,
    after: After,
    steps: u32,
    mut during: impl FnMut(&mut Sheet, u32),
) {
    let mut sheet = Sheet::new(scene);
    sheet.steps(30);
    for step in 0..steps {
        during(&mut sheet, step);
        sheet.step();
        assert_eq!(sheet.complaint(), None, "{what}, step {step}");
    }
    sheet.sim.set_hz(60.0);
    sheet.settings(|settings| settings.gravity = scene.gravity);
    sheet.steps(300);
    assert_eq!(sheet.complaint(), None, "{what}, afterwards");
    let stretch = sheet.stretch();
    println!("{what}: {stretch:?}");
    let [mean, p99] = match after {
        After::Well => [4e-5, 3e-4],
        After::Knotted(_) => [8e-3, 0.19],
    };
    assert!(
        stretch.mean < mean && stretch.p99 < p99,
        "{what}: {stretch:?}"
    );
    if let After::Knotted(most) = after {
        sheet.steps(900);
        let speed = sheet.speed();
        println!("{what}: {speed:.2e} m/s");
        assert!(speed < most, "{what}: {speed} m/s");
    }
}

fn upright(resolution: UVec2) -> Scene {
    Scene {
        gravity: Vec3::NEG_Y * G,
        ..Scene::hang(resolution)
    }
}

#[test]
fn pins_that_jump_100_m() {
    let scene = upright(UVec2::splat(32));
    let mut home = None;
    survives("pins", &scene, After::Well, 120, |sheet, step| {
        let particles = sheet.particles();
        let home = home.get_or_insert_with(|| [0, 31].map(|i| particles.position(i as usize)));
        let aside = Vec3::new(100.0, 30.0, -20.0) * (step % 2) as f32;
        let pins = [0, 31].into_iter().zip(*home);
        let pins = pins.map(|(i, at)| ClothPin::at(i, at + aside)).collect();
        if step < 4 {
            sheet.change(|held: &mut ClothPins| held.pins = pins);
        }
    });
}

#[test]
fn a_sphere_that_appears_in_the_sheet() {
    let scene = Scene {
        sphere: Some((Vec3::new(0.0, 0.0, -50.0), 0.5)),
        ..upright(UVec2::splat(32))
    };
    survives("sphere", &scene, After::Well, 120, |sheet, step| {
        let at = match step {
            0..40 => Vec3::ZERO,
            40..80 => Vec3::new(0.2, 0.3, 0.01),
            _ => Vec3::new(0.0, 0.0, -50.0),
        };
        let sphere = sheet.sphere.unwrap();
        sheet.sim.move_to(sphere, Transform::from_translation(at));
    });
}

#[test]
fn gravity_a_hundredfold() {
    let scene = upright(UVec2::splat(32));
    survives("gravity", &scene, After::Well, 120, |sheet, _| {
        sheet.settings(|settings| settings.gravity = Vec3::new(700.0, -600.0, 300.0));
    });
}

#[test]
fn steps_of_a_second() {
    let scene = upright(UVec2::splat(32));
    survives("slow", &scene, After::Knotted(1e-3), 10, |sheet, step| {
        if step == 0 {
            sheet.sim.set_hz(1.0);
        }
    });
}

#[test]
fn materials_of_any_kind() {
    let scene = upright(UVec2::splat(16));
    for compliance in [0.0, 1e-9, 1e-3, 1.0] {
        for density in [0.001, 10.0] {
            let material = ClothMaterial {
                areal_density: density,
                warp_compliance: compliance,
                weft_compliance: compliance,
                shear_compliance: compliance,
                bend_compliance: compliance,
                ..rigid()
            };
            // What gives way like a rubber band under 98 N/m², or like none at all, lies in a heap at first.
            let heap = compliance >= 1.0 || density > 1.0 && compliance >= 1e-3;
            let after = if heap {
                // A board of 160 kg that becomes a bed sheet trembles at six particles.
                After::Knotted(if density > 1.0 { 0.4 } else { 1e-3 })
            } else {
                After::Well
            };
            let what = format!("compliance {compliance}, density {density}");
            survives(&what, &scene, after, 60, |sheet, step| {
                let now = if step < 59 { material } else { scene.material };
                sheet.change(|held: &mut ClothMaterial| *held = now);
            });
        }
    }
}

#[test]
fn the_smallest_and_the_narrowest() {
    for size in [[2, 2], [2, 64], [64, 2], [3, 3]].map(UVec2::from_array) {
        survives(
            &format!("{size}"),
            &upright(size),
            After::Well,
            30,
            |_, _| (),
        );
        let mut sheet = Sheet::new(&Scene::drape(size));
        sheet.steps(120);
        assert_eq!(sheet.complaint(), None, "{size}");
    }
}
