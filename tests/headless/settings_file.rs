//! Settings survive a file; what is wrong with a file is told with its line, its field and what is allowed.

use std::{fs, path::Path};

use bevy::prelude::default;
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

/// Error of a text: line, field and the whole message.
fn wrong(text: &str) -> (usize, String, String) {
    let error = read(text).expect_err("an error");
    let words = error.to_string();
    match error {
        SettingsFileError::Content { line, field, .. } => (line, field, words),
        other => panic!("{other}"),
    }
}

/// Settings without what is counted up, which is no setting.
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
}

#[test]
fn a_part_of_a_material_leaves_the_rest_of_it_at_its_default() {
    let settings = read("(material: (damping: 1.0), wind: (air_density: 1.0))").expect("settings");
    let material = ClothMaterial {
        damping: 1.0,
        ..default()
    };
    let wind = ClothWind {
        air_density: 1.0,
        ..default()
    };
    assert_eq!((settings.material, settings.wind), (material, wind));
}

#[test]
fn a_fabric_brings_its_material() {
    let settings = read("(scene: \"flag\", fabric: \"denim\")").expect("settings");
    assert_eq!(settings.preset, "denim");
    assert_eq!(settings.material, ClothMaterial::denim());
}

/// A file of version 0.2 of the demo.
#[test]
fn files_of_earlier_versions_are_read() {
    let settings = read(
        r#"(
    scene: "flag", resolution: 64, fabric: "silk",
    material: (
        areal_density: 0.07, warp_compliance: 6.25e-5, weft_compliance: 0.000125, shear_compliance: 0.06,
        bend_compliance: 330000.0, viscosity: 0.05, damping: 0.3, friction: 0.2, thickness: 0.003, drag: 1.2, lift: 1.1,
    ),
    shading: Flat, gravity: 1.6, solver: GaussSeidel, substeps: Fixed(12), iterations: 2, paused: true,
    wind: (
        velocity: (7.0, 0.0, 1.0), gusts: (strength: 0.4, period: 3.0),
        turbulence: (speed: 1.2, scale: 1.5, seed: 7), model: Classic, air_density: 1.2,
    ),
    sphere_radius: 0.2, sphere_speed: 1.0, grab_radius: 0.05,
    look: (texture: false, wireframe: true), picking: Depth,
)"#,
    )
    .expect("settings");
    assert_eq!(settings.scene, SceneKind::Flag);
    assert_eq!((settings.resolution, settings.substeps), (64, Some(12)));
    assert_eq!(
        (settings.material.lift, settings.wind.turbulence.seed),
        (1.1, 7)
    );
    assert_eq!(settings.wind.model, ClothWindModel::Classic);
    assert_eq!(settings.solver, ClothSolver::GaussSeidel);
    assert_eq!(settings.picking, ClothPickingBackend::Depth);
    assert!(settings.look.wireframe && !settings.look.texture);
    let automatic = read("(substeps: Automatic)").expect("settings");
    assert_eq!(automatic.substeps, None);
}

#[test]
fn velocities_that_are_no_numbers_are_told() {
    let text = to_text(&DemoSettings::default()).expect("text");
    let (_, field, words) = wrong(&text.replacen("velocity: (0.2, ", "velocity: (inf, ", 1));
    assert_eq!(field, "wind.velocity", "{words}");
}
