//! Detail that a window of the demo opens with: what suits the renderer, unless the player wishes for something else.

use bevy::prelude::*;

use crate::common::{
    detail::{Detail, Start, Wishes},
    graphics::Adapter,
    scenes::SceneKind,
    settings::DemoSettings,
};

fn start(adapter: Adapter, wishes: Wishes) -> Start {
    Start::new(adapter, wishes, DemoSettings::of(SceneKind::Flag))
}

#[test]
fn a_graphics_card_draws_everything() {
    for fine in [false, true] {
        let wishes = Wishes { fine, ..default() };
        let start = start(Adapter::Hardware, wishes);
        assert_eq!(start.detail, Detail::Full);
        assert_eq!(start.size, UVec2::new(1280, 720));
        assert_eq!(start.settings, DemoSettings::of(SceneKind::Flag));
    }
}

#[test]
fn a_processor_draws_less_and_the_scene_stays() {
    let start = start(Adapter::Software, Wishes::default());
    let full = DemoSettings::of(SceneKind::Flag);
    assert_eq!(start.detail, Detail::Low);
    assert!(start.size.cmplt(Detail::Full.size()).all());
    assert!(start.settings.resolution < full.resolution);
    assert!(Detail::Low.shadow_map() < Detail::Full.shadow_map());
    let as_fine = DemoSettings {
        resolution: full.resolution,
        ..start.settings
    };
    assert_eq!(as_fine, full);
}

#[test]
fn fine_draws_everything_on_a_processor_as_well() {
    let fine = Wishes {
        fine: true,
        ..default()
    };
    assert_eq!(
        start(Adapter::Software, fine),
        start(Adapter::Hardware, Wishes::default())
    );
}

#[test]
fn what_the_player_names_wins() {
    let wishes = Wishes {
        size: Some(UVec2::new(640, 480)),
        resolution: Some(200),
        ..default()
    };
    for adapter in [Adapter::Software, Adapter::Hardware] {
        for fine in [false, true] {
            for from_file in [false, true] {
                let wishes = Wishes {
                    fine,
                    from_file,
                    ..wishes
                };
                let start = start(adapter, wishes);
                assert_eq!(start.size, UVec2::new(640, 480));
                assert_eq!(start.settings.resolution, 200);
                assert_eq!(start.detail, Detail::of(adapter, fine));
            }
        }
    }
}

#[test]
fn a_file_of_settings_says_itself_how_many_particles_there_are() {
    let wishes = Wishes {
        from_file: true,
        ..default()
    };
    let saved = DemoSettings {
        resolution: 77,
        ..DemoSettings::of(SceneKind::Cape)
    };
    let start = Start::new(Adapter::Software, wishes, saved.clone());
    assert_eq!(start.detail, Detail::Low);
    assert_eq!(start.settings, saved);
}
