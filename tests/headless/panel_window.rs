//! The panel in windows of any size, what is told without it, and the files that it shows and writes.

use std::fs;

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_egui::egui::{self, Event, Pos2, RawInput, Rect, Shape, Vec2};

use crate::{
    common::{
        notices::{Notices, toasts},
        panel::{PanelState, panel_window},
        photo::save_new,
        scenes::SceneKind,
        settings::DemoSettings,
        status::Status,
    },
    panel::find,
};

/// A window of this size [points].
fn window(width: f32, height: f32, scale: f32) -> RawInput {
    let mut input = RawInput {
        screen_rect: Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(width, height))),
        ..RawInput::default()
    };
    let viewport = input.viewports.entry(input.viewport_id).or_default();
    viewport.native_pixels_per_point = Some(scale);
    input
}

#[test]
fn it_fits_in_and_scrolls_in_small_and_large_windows() {
    // 1280 × 720, and 3840 × 2160 with a scale of 2.
    for (width, height, scale) in [(1280.0, 720.0, 1.0), (1920.0, 1080.0, 2.0)] {
        let context = egui::Context::default();
        let mut settings = DemoSettings::default();
        let status = Status::default();
        let mut notices = Notices::default();
        let pictures = [Some(egui::TextureId::User(0)); SceneKind::ALL.len()];
        let mut place = Rect::NOTHING;
        let mut lowest = f32::INFINITY;
        let mut pass = |pass: u32, events: Vec<Event>| {
            let input = RawInput {
                events,
                time: Some(0.5 * f64::from(pass)),
                ..window(width, height, scale)
            };
            let mut output = context.run_ui(input, |ui| {
                let mut state = PanelState {
                    settings: &mut settings,
                    status: &status,
                    notices: &mut notices,
                    pictures: &pictures,
                    asks: &mut Vec::new(),
                };
                place = panel_window(ui.ctx(), &mut state).expect("open");
            });
            output.textures_delta.clear();
            assert_eq!(output.pixels_per_point, scale);
            let shapes: Vec<Shape> = output
                .shapes
                .into_iter()
                .map(|clipped| clipped.shape)
                .collect();
            if let Some(keys) = find(&shapes, "Keys") {
                lowest = keys.y;
            }
            (place, lowest)
        };
        for k in 0..5 {
            pass(k, Vec::new());
        }
        let (place, before) = pass(5, Vec::new());
        assert!(place.width() <= width / 3.0, "{width}: {place}");
        assert!(
            place.right() <= width && place.bottom() <= height,
            "{place}"
        );
        let scroll = || {
            vec![
                Event::PointerMoved(place.center()),
                Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Page,
                    delta: Vec2::new(0.0, -9.0),
                    phase: egui::TouchPhase::Move,
                    modifiers: egui::Modifiers::default(),
                },
            ]
        };
        for k in 6..12 {
            pass(k, scroll());
        }
        let (_, after) = pass(12, Vec::new());
        assert!(after < height, "{width}: {before} {after}");
    }
}

#[test]
fn without_the_panel_all_is_told_at_the_edge() {
    for panel_shown in [true, false] {
        let mut notices = Notices::default();
        notices.wrong("this is wrong");
        notices.done("this was done");
        let context = egui::Context::default();
        let mut shapes = Vec::new();
        for _ in 0..3 {
            let mut output = context.run_ui(window(1280.0, 720.0, 1.0), |ui| {
                toasts(ui.ctx(), &notices, panel_shown);
            });
            output.textures_delta.clear();
            shapes = output
                .shapes
                .into_iter()
                .map(|clipped| clipped.shape)
                .collect();
        }
        assert_eq!(find(&shapes, "this is wrong").is_some(), !panel_shown);
        let place = find(&shapes, "this was done").expect("shown");
        assert!(place.x < 300.0 && place.y > 600.0, "{place}");
    }
}

#[test]
fn pictures_never_replace_others() {
    let folder = std::env::temp_dir().join(format!("tailorbird-photo-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let size = Extent3d {
        width: 4,
        height: 2,
        depth_or_array_layers: 1,
    };
    let picture = Image::new_fill(
        size,
        TextureDimension::D2,
        &[200, 100, 50, 255],
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::MAIN_WORLD,
    );
    let first = save_new(&folder, &picture).expect("saved");
    let second = save_new(&folder, &picture).expect("saved");
    assert!(first.ends_with("tailorbird-0001.png") && second.ends_with("tailorbird-0002.png"));
    assert_eq!(image::image_dimensions(&first).expect("a picture"), (4, 2));
    assert!(save_new(&folder.join("missing"), &picture).is_err());
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn each_scene_has_a_small_picture() {
    for scene in SceneKind::ALL {
        let file = format!("assets/thumbnails/{scene}.png");
        let size = fs::metadata(&file).expect(&file).len();
        assert!(size < 15_000, "{file}: {size} bytes");
        let (width, height) = image::image_dimensions(&file).expect("a picture");
        assert_eq!(width * 9, height * 16, "{file}");
    }
}
