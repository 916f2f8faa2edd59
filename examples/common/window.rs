//! The window with the panel, and what the windowed examples share.

use bevy::{pbr::wireframe::WireframePlugin, prelude::*, window::PrimaryWindow};
use bevy_egui::{EguiContexts, EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass};

use super::{
    ask::{Ask, AskPlugin, PanelShown},
    camera::OrbitCamera,
    hand::Hand,
    notices::{Notices, toasts},
    panel::{PanelState, covered, panel_window},
    photo::PhotoPlugin,
    plot::beside,
    settings::DemoSettings,
    status::{Status, StatusPlugin},
    thumbnails::{Pictures, Thumbnails, ThumbnailsPlugin},
};

/// The panel over the window, wireframes and pictures.
pub struct PanelPlugin;

impl Plugin for PanelPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            EguiPlugin::default(),
            WireframePlugin::default(),
            StatusPlugin,
            ThumbnailsPlugin,
            AskPlugin,
            PhotoPlugin,
        ))
        .add_systems(Startup, keep_input_of_panel)
        .add_systems(Update, make_room_for_panel)
        .add_systems(EguiPrimaryContextPass, show_panel);
    }
}

/// Keeps to the panel what is typed into it, or done over it.
fn keep_input_of_panel(mut egui: ResMut<EguiGlobalSettings>) {
    egui.enable_absorb_bevy_input_system = true;
}

/// Draws the panel; the settings count as changed only where the player changed them.
fn show_panel(
    mut contexts: EguiContexts,
    shown: Res<PanelShown>,
    mut settings: ResMut<DemoSettings>,
    status: Res<Status>,
    mut notices: ResMut<Notices>,
    thumbnails: Option<Res<Thumbnails>>,
    hand: Res<Hand>,
    mut asks: MessageWriter<Ask>,
) -> Result {
    let context = contexts.ctx_mut()?;
    if shown.0 {
        let mut changed = settings.clone();
        let mut asked = Vec::new();
        let pictures = thumbnails.map_or_else(Pictures::default, |found| found.pictures);
        let mut state = PanelState {
            settings: &mut changed,
            status: &status,
            notices: notices.bypass_change_detection(),
            pictures: &pictures,
            asks: &mut asked,
        };
        panel_window(context, &mut state);
        settings.set_if_neq(changed);
        asks.write_batch(asked);
    }
    if settings.beside {
        beside(context, &status);
    }
    toasts(context, &notices, shown.0);
    hand.draw(context);
    Ok(())
}

/// Moves the middle of the picture to the middle of what the panel leaves free.
fn make_room_for_panel(
    window: Single<&Window, With<PrimaryWindow>>,
    shown: Res<PanelShown>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    let covered = if shown.0 {
        covered(window.width())
    } else {
        0.0
    };
    for mut camera in &mut cameras {
        if camera.covered != covered {
            camera.covered = covered;
        }
    }
}

/// Ends the app after as many frames as `TAILORBIRD_EXIT_AFTER_FRAMES` says, for tests, and logs how many a second
/// the later half of them were.
pub struct ExitAfterFrames;

impl Plugin for ExitAfterFrames {
    fn build(&self, app: &mut App) {
        let frames = std::env::var("TAILORBIRD_EXIT_AFTER_FRAMES").ok();
        if let Some(frames) = frames.and_then(|frames| frames.parse::<u32>().ok()) {
            let exit = move |time: Res<Time<Real>>,
                             mut done: Local<u32>,
                             mut since: Local<f64>,
                             mut exit: MessageWriter<AppExit>| {
                *done += 1;
                let now = time.elapsed_secs_f64();
                if *done == frames / 2 {
                    *since = now;
                }
                if *done >= frames {
                    let rate = f64::from(*done - frames / 2) / (now - *since).max(1e-6);
                    info!("{rate:.1} frames/s");
                    exit.write(AppExit::Success);
                }
            };
            app.add_systems(Last, exit);
        }
    }
}
