//! Requests of a player that are no settings: save, load, a picture, the panel. Keys and buttons ask alike.

use std::path::PathBuf;

use bevy::prelude::*;

use super::{
    notices::{Notices, NoticesPlugin},
    settings::DemoSettings,
    settings_file::{self, FILE},
};

/// Something that is to be done once.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Save the settings.
    Save,
    /// Load the settings.
    Load,
    /// Save what the window shows.
    Picture,
    /// Show or hide the panel.
    Panel,
}

/// File that settings are saved to and loaded from.
#[derive(Resource, Clone, Debug)]
pub struct SettingsPath(pub PathBuf);

impl Default for SettingsPath {
    fn default() -> Self {
        Self(FILE.into())
    }
}

/// Visibility of the panel.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanelShown(pub bool);

impl Default for PanelShown {
    fn default() -> Self {
        Self(true)
    }
}

/// Does what is asked for; pictures belong to [`photo`](super::photo).
pub struct AskPlugin;

impl Plugin for AskPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(NoticesPlugin)
            .add_message::<Ask>()
            .init_resource::<SettingsPath>()
            .init_resource::<PanelShown>()
            .add_systems(Update, (ask_by_keys, answer).chain());
    }
}

/// The keys that ask.
const KEYS: [(KeyCode, Ask); 4] = [
    (KeyCode::F5, Ask::Save),
    (KeyCode::F9, Ask::Load),
    (KeyCode::F12, Ask::Picture),
    (KeyCode::KeyH, Ask::Panel),
];

fn ask_by_keys(keys: Option<Res<ButtonInput<KeyCode>>>, mut asks: MessageWriter<Ask>) {
    let Some(keys) = keys else {
        return;
    };
    for (key, ask) in KEYS {
        if keys.just_pressed(key) {
            asks.write(ask);
        }
    }
}

fn answer(
    mut asks: MessageReader<Ask>,
    path: Res<SettingsPath>,
    mut settings: ResMut<DemoSettings>,
    mut panel: ResMut<PanelShown>,
    mut notices: ResMut<Notices>,
) {
    let file = path.0.as_path();
    for ask in asks.read() {
        match ask {
            Ask::Save => match settings_file::save(file, &settings) {
                Ok(()) => notices.done(format!("settings saved to {}", file.display())),
                Err(error) => notices.wrong(error),
            },
            Ask::Load => match settings_file::load(file) {
                Ok(loaded) => {
                    settings.take_over(loaded);
                    notices.done(format!("settings loaded from {}", file.display()));
                }
                Err(error) => notices.wrong(error),
            },
            Ask::Panel => {
                panel.0 = !panel.0;
                if !panel.0 {
                    notices.done("H shows the panel again");
                }
            }
            Ask::Picture => {}
        }
    }
}
