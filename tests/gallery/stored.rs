//! The pictures in the repository.

use std::{env, fs, path::PathBuf};

use image::{Rgb, RgbImage};

use crate::{
    animation::Animation,
    compare::{CompareError, compare, still},
    difference::{Difference, TOLERANCE},
};

const SCENES: [&str; 8] = [
    "curtain",
    "flag",
    "tablecloth",
    "ball",
    "cape",
    "banner",
    "garment",
    "crates",
];

fn dir() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/pictures/gallery")
}

fn picture(scene: &str) -> RgbImage {
    image::open(still(&dir(), scene)).expect(scene).to_rgb8()
}

fn difference(a: &RgbImage, b: &RgbImage) -> Difference {
    Difference::between(a, b).expect("pictures of the same shape")
}

#[test]
fn each_scene_has_a_still_and_an_animation_that_a_page_can_load() {
    let size = |name: String| fs::metadata(dir().join(&name)).expect(&name).len();
    let mut all = 0;
    for scene in SCENES {
        let (png, gif) = (size(format!("{scene}.png")), size(format!("{scene}.gif")));
        assert!(png <= 250_000, "{scene}.png: {png} bytes");
        assert!(gif <= Animation::LARGEST as u64, "{scene}.gif: {gif} bytes");
        all += png + gif;
    }
    assert!(all <= 8_000_000, "{all} bytes in all");
}

#[test]
fn each_still_is_as_itself_and_unlike_the_others() {
    for scene in SCENES {
        assert_eq!(compare(scene, &dir(), &dir()).expect(scene).mean, 0.0);
        for other in SCENES.into_iter().filter(|other| *other != scene) {
            let found = difference(&picture(scene), &picture(other));
            assert!(!found.within(TOLERANCE), "{scene} and {other}: {found}");
        }
    }
}

/// Another renderer rounds, and draws edges, in its own way.
#[test]
fn other_rounding_and_edges_pass() {
    for scene in SCENES {
        let before = picture(scene);
        let (width, height) = before.dimensions();
        let after = RgbImage::from_fn(width, height, |x, y| {
            let [here, right] = [x, (x + 1).min(width - 1)].map(|x| before.get_pixel(x, y).0);
            let odd = u16::from((x * 31 + y * 17) % 3 == 0);
            let mixed = |c: usize| (3 * u16::from(here[c]) + u16::from(right[c]) + 4 * odd) / 4;
            Rgb([0, 1, 2].map(|c| mixed(c).min(255) as u8))
        });
        let found = difference(&before, &after);
        assert!(found.within(TOLERANCE), "{scene}: {found}");
    }
}

#[test]
fn another_dye_is_seen() {
    for scene in ["curtain", "flag", "cape"] {
        let before = picture(scene);
        let mut after = before.clone();
        for pixel in after.pixels_mut() {
            let [red, green, blue] = pixel.0;
            if red > green.saturating_add(30) {
                pixel.0 = [red, green.saturating_add(30), blue];
            }
        }
        let found = difference(&before, &after);
        assert!(!found.within(TOLERANCE), "{scene}: {found}");
    }
}

#[test]
fn a_scene_that_shifted_is_seen() {
    for scene in SCENES {
        let before = picture(scene);
        let (width, height) = before.dimensions();
        let after = RgbImage::from_fn(width, height, |x, y| {
            *before.get_pixel(x.saturating_sub(8), y)
        });
        let found = difference(&before, &after);
        assert!(!found.within(TOLERANCE), "{scene}: {found}");
    }
}

#[test]
fn what_is_missing_is_named() {
    let empty = env::temp_dir().join("tailorbird_no_gallery");
    let error = compare("flag", &empty, &dir()).expect_err("no picture");
    assert!(matches!(error, CompareError::Read { .. }));
    assert!(error.to_string().contains("flag.png"), "{error}");
}
