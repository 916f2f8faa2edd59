//! Each scene of the demo gives pictures that are not empty and change while time passes.

use std::{env, fs, path::Path};

use bevy::prelude::*;

use crate::{
    common::{
        offscreen::{OffscreenOptions, draw},
        scenes::SceneKind,
        script::Script,
        settings::DemoSettings,
    },
    offscreen::{alone, graphics},
};

const SIZE: UVec2 = UVec2::new(320, 180);

fn pixels(path: &Path) -> Vec<[u8; 3]> {
    let picture = image::open(path).expect("a picture").to_rgb8();
    assert_eq!(picture.dimensions(), (SIZE.x, SIZE.y));
    picture.pixels().map(|pixel| pixel.0).collect()
}

/// Part of the pixels that differ by more than what noise could do.
fn changed(a: &[[u8; 3]], b: &[[u8; 3]]) -> f32 {
    let differs = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 12);
    a.iter().zip(b).filter(|pair| differs(*pair)).count() as f32 / a.len() as f32
}

/// Part of the pixels that have the colour of the skirt.
fn skirt(picture: &[[u8; 3]]) -> f32 {
    let is_red = |[r, g, b]: &[u8; 3]| {
        let other = f32::from(*g.max(b));
        *r > 60 && f32::from(*r) > 1.3 * other
    };
    picture.iter().filter(|pixel| is_red(pixel)).count() as f32 / picture.len() as f32
}

fn check(scene: SceneKind) {
    if !graphics(&format!("pictures of the scene {scene}")) {
        return;
    }
    let _alone = alone();
    let dir = env::temp_dir().join(format!("tailorbird_{scene}_{}", std::process::id()));
    let pictures = draw(&OffscreenOptions {
        dir: dir.clone(),
        seconds: 2.0,
        every: 1.0,
        size: SIZE,
        fine: false,
        settings: DemoSettings {
            resolution: 24,
            ..DemoSettings::of(scene)
        },
        script: Script::of(scene),
    })
    .expect("pictures");
    assert_eq!(pictures.len(), 3);
    let pictures: Vec<_> = pictures.iter().map(|path| pixels(path)).collect();
    fs::remove_dir_all(&dir).expect("the folder of the pictures");

    for picture in &pictures {
        let mut colors: Vec<_> = picture.iter().map(|pixel| pixel.map(|v| v / 16)).collect();
        colors.sort_unstable();
        colors.dedup();
        assert!(colors.len() > 20, "{scene}: {} colours", colors.len());
        if scene == SceneKind::Garment {
            let part = skirt(picture);
            assert!(part > 0.015, "the skirt is {part} of the picture");
        }
    }
    for pair in pictures.windows(2) {
        let part = changed(&pair[0], &pair[1]);
        assert!(
            (0.003..0.5).contains(&part),
            "{scene}: {part} of the picture changed"
        );
    }
}

#[test]
fn curtain() {
    check(SceneKind::Curtain);
}

#[test]
fn flag() {
    check(SceneKind::Flag);
}

#[test]
fn tablecloth() {
    check(SceneKind::Tablecloth);
}

#[test]
fn ball() {
    check(SceneKind::Ball);
}

#[test]
fn cape() {
    check(SceneKind::Cape);
}

#[test]
fn banner() {
    check(SceneKind::Banner);
}

#[test]
fn garment() {
    check(SceneKind::Garment);
}

#[test]
fn crates() {
    check(SceneKind::Crates);
}
