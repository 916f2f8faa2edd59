//! Settings survive a file; what is wrong with a file is told with its line, its field and what is allowed.

use std::{fs, path::Path};

use proptest::prelude::*;
use tailorbird::prelude::*;

use crate::common::{
    scenes::SceneKind,
    settings::DemoSettings,
    settings_file::{SettingsFileError, from_text, load, save, to_text},
};

fn read(text: &str) -> Result<DemoSettings, SettingsFileError> {
    from_text(text, Path::new("some.ron"))
}

/// What is wrong with a text: line, field and the whole message.
fn wrong(text: &str) -> (usize, String, String) {
    let error = read(text).expect_err("an error");
    let words = error.to_string();
    match error {
        SettingsFileError::Content { line, field, .. } => (line, field, words),
        other => panic!("{other}"),
    }
}

/// What is counted up is no setting.
fn comparable(settings: &DemoSettings) -> DemoSettings {
    DemoSettings {
        resets: 0,
        single_steps: 0,
        beside: false,
        ..settings.clone()
    }
}

fn any_settings() -> impl Strategy<Value = DemoSettings> {
    let scene = (0..SceneKind::ALL.len(), 0..ClothMaterial::presets().len());
    let material = prop::array::uniform11(0.0_f32..1e6);
    let wind = (
        prop::array::uniform3(-1e3_f32..1e3),
        prop::array::uniform4(1e-6_f32..1e3),
        any::<u32>(),
        any::<bool>(),
        0.0_f32..10.0,
    );
    let solver = (
        0.0_f32..=100.0,
        prop::option::of(1_u32..=1000),
        0_u32..=1000,
        2_u32..=512,
    );
    let ball = (0.01_f32..=2.0, 0.0_f32..=100.0, 0.0_f32..=1.0);
    let choices = prop::array::uniform4(any::<bool>());
    let look = prop::array::uniform11(any::<bool>());
    (scene, material, wind, solver, ball, choices, look).prop_map(
        |(
            (scene, preset),
            m,
            (velocity, air, seed, classic, air_density),
            solver,
            ball,
            c,
            look,
        )| {
            let mut settings = DemoSettings::of(SceneKind::ALL[scene]);
            settings.choose_preset(ClothMaterial::presets()[preset].0);
            settings.material = ClothMaterial {
                areal_density: m[0] + 1e-3,
                warp_compliance: m[1],
                weft_compliance: m[2],
                shear_compliance: m[3],
                bend_compliance: m[4],
                viscosity: m[5],
                damping: m[6],
                friction: m[7],
                thickness: m[8],
                drag: m[9],
                lift: m[10],
            };
            settings.wind = ClothWind {
                velocity: velocity.into(),
                gusts: ClothGusts {
                    strength: air[0],
                    period: air[1],
                },
                turbulence: ClothTurbulence {
                    speed: air[2],
                    scale: air[3],
                    seed,
                },
                model: if classic {
                    ClothWindModel::Classic
                } else {
                    ClothWindModel::Aerodynamic
                },
                air_density,
            };
            (
                settings.gravity,
                settings.substeps,
                settings.iterations,
                settings.resolution,
            ) = solver;
            (
                settings.sphere_radius,
                settings.sphere_speed,
                settings.grab_radius,
            ) = ball;
            settings.paused = c[0];
            settings.shading = if c[1] {
                ClothShading::Flat
            } else {
                ClothShading::Smooth
            };
            settings.solver = if c[2] {
                ClothSolver::GaussSeidel
            } else {
                ClothSolver::Chains
            };
            settings.picking = if c[3] {
                ClothPickingBackend::Depth
            } else {
                ClothPickingBackend::Ray
            };
            for ((_, shown), value) in settings.look.toggles().into_iter().zip(look) {
                *shown = value;
            }
            settings
        },
    )
}

proptest! {
    #[test]
    fn what_is_saved_is_what_is_loaded(settings in any_settings()) {
        let text = to_text(&settings).expect("text");
        let loaded = read(&text).expect("settings");
        prop_assert_eq!(comparable(&loaded), comparable(&settings));
    }

    #[test]
    fn no_text_does_more_than_fail(text in "\\PC*", cut in 0_usize..2000) {
        drop(read(&text));
        let saved = to_text(&DemoSettings::default()).expect("text");
        let part: String = saved.chars().take(cut).collect();
        drop(read(&part));
    }
}

#[test]
fn files_are_written_and_read() {
    let folder = std::env::temp_dir().join(format!("tailorbird-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("settings.ron");
    let settings = DemoSettings::of(SceneKind::Flag);
    save(&file, &settings).expect("saved");
    let loaded = load(&file).expect("loaded");
    assert_eq!(comparable(&loaded), comparable(&settings));

    let missing = load(&folder.join("missing.ron")).expect_err("no file");
    assert!(matches!(missing, SettingsFileError::Read { .. }));
    assert!(missing.to_string().contains("missing.ron"), "{missing}");
    let nowhere = save(&folder.join("no/folder.ron"), &settings).expect_err("no folder");
    assert!(matches!(nowhere, SettingsFileError::Write { .. }));
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn what_is_left_out_is_as_the_scene_brings_it() {
    let flag = read("(scene: \"flag\", gravity: 1.5)").expect("settings");
    let expected = DemoSettings {
        gravity: 1.5,
        ..DemoSettings::of(SceneKind::Flag)
    };
    assert_eq!(flag, expected);
    assert_eq!(read("()").expect("settings"), DemoSettings::default());
}

#[test]
fn unknown_fields_are_named_with_those_that_exist() {
    let (line, field, words) = wrong("(\n    scene: \"flag\",\n    gravitation: 3.0,\n)");
    assert_eq!((line, field.as_str()), (3, "gravitation"));
    assert!(
        words.contains("some.ron, line 3: gravitation is unknown"),
        "{words}"
    );
    assert!(words.contains("gravity"), "{words}");
    let (line, field, _) = wrong("(\n    look: (\n        glitter: true,\n    ),\n)");
    assert_eq!((line, field.as_str()), (3, "glitter"));
}

#[test]
fn values_of_another_kind_are_told() {
    let (line, field, words) = wrong("(\n    scene: \"flag\",\n    gravity: \"strong\",\n)");
    assert_eq!((line, field.as_str()), (3, "gravity"), "{words}");
    assert!(words.contains("float"), "{words}");
    let (line, field, words) = wrong("(\n    resolution: 12.5,\n)");
    assert_eq!((line, field.as_str()), (2, "resolution"), "{words}");
    let (line, field, words) = wrong("(\n    solver: Magic,\n    gravity: 1.0,\n)");
    assert_eq!((line, field.as_str()), (2, "solver"), "{words}");
    assert!(
        words.contains("Chains") && words.contains("GaussSeidel"),
        "{words}"
    );
}

#[test]
fn values_out_of_range_are_told_with_the_range() {
    for (text, line, field, allowed) in [
        ("(\n resolution: 1,\n)", 2, "resolution", "2 to 512"),
        ("(\n gravity: -1.0,\n)", 2, "gravity", "0 to 100 m/s²"),
        ("(\n gravity: NaN,\n)", 2, "gravity", "0 to 100 m/s²"),
        ("(\n substeps: Fixed(0),\n)", 2, "substeps", "1 to 1000"),
        (
            "(\n // scene: none\n scene: \"moon\",\n)",
            3,
            "scene",
            "curtain, flag",
        ),
        ("(\n fabric: \"wool\",\n)", 2, "fabric", "silk, cotton"),
        (
            "(\n sphere_radius: 9.0,\n)",
            2,
            "sphere_radius",
            "0.01 to 2 m",
        ),
    ] {
        let (found, named, words) = wrong(text);
        assert_eq!((found, named.as_str()), (line, field), "{words}");
        assert!(words.contains(allowed), "{words}");
    }
}

#[test]
fn fields_within_others_are_found() {
    let text = to_text(&DemoSettings::of(SceneKind::Flag)).expect("text");
    for (field, name, bad) in [
        ("material.damping", "damping: ", "damping: -1.0,"),
        ("wind.gusts.period", "period: ", "period: 0.0,"),
        ("wind.turbulence.speed", "speed: ", "speed: -3.0,"),
    ] {
        let at = text
            .lines()
            .position(|line| line.trim_start().starts_with(name))
            .expect("the field");
        let lines: Vec<&str> = text
            .lines()
            .enumerate()
            .map(|(k, line)| if k == at { bad } else { line })
            .collect();
        let (line, named, words) = wrong(&lines.join("\n"));
        assert_eq!((line, named.as_str()), (at + 1, field), "{words}");
        assert!(words.contains("finite"), "{words}");
    }
    let (_, field, words) = wrong("(\n material: (\n  damping: 1.0,\n ),\n)");
    assert_eq!(field, "areal_density");
    assert!(words.contains("missing"), "{words}");
}

#[test]
fn velocities_that_are_no_numbers_are_told() {
    let text = to_text(&DemoSettings::default()).expect("text");
    let (_, field, words) = wrong(&text.replacen("velocity: (0.2, ", "velocity: (inf, ", 1));
    assert_eq!(field, "wind.velocity", "{words}");
}
