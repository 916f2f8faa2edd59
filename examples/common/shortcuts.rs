//! The keys of the demo. Those of the ball and of pinning belong to the plugin.

use bevy::prelude::*;

use super::{scenes::SceneKind, settings::DemoSettings};

/// The keys that show a scene.
const SCENES: [KeyCode; 9] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
];

/// Does what the keys say.
pub fn use_shortcuts(keys: Option<Res<ButtonInput<KeyCode>>>, mut settings: ResMut<DemoSettings>) {
    let Some(keys) = keys else {
        return;
    };
    if keys.just_pressed(KeyCode::KeyR) {
        settings.reset();
    }
    if keys.just_pressed(KeyCode::Space) {
        settings.paused = !settings.paused;
    }
    if keys.just_pressed(KeyCode::KeyN) {
        settings.paused = true;
        settings.single_steps = settings.single_steps.wrapping_add(1);
    }
    if keys.just_pressed(KeyCode::KeyB) {
        settings.look.depth_of_field = !settings.look.depth_of_field;
    }
    if keys.just_pressed(KeyCode::KeyC) {
        settings.beside = !settings.beside;
    }
    for (key, places) in [(KeyCode::BracketLeft, -1), (KeyCode::BracketRight, 1)] {
        if keys.just_pressed(key) {
            settings.show_next(places);
        }
    }
    for (key, scene) in SCENES.into_iter().zip(SceneKind::ALL) {
        if keys.just_pressed(key) {
            settings.show(scene);
        }
    }
}
