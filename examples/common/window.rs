//! The window with the panel, and what the windowed examples share.

use bevy::{pbr::wireframe::WireframePlugin, prelude::*, window::PrimaryWindow};
use bevy_egui::{EguiContexts, EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, egui};

use super::{
    camera::OrbitCamera,
    panel::{PanelState, panel},
    settings::DemoSettings,
    status::{Status, StatusPlugin},
};

/// The panel over the window, and wireframes.
pub struct PanelPlugin;

/// Width of the panel [points].
const PANEL_WIDTH: f32 = 310.0;

impl Plugin for PanelPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            EguiPlugin::default(),
            WireframePlugin::default(),
            StatusPlugin,
        ))
        .add_systems(Startup, keep_input_of_panel)
        .add_systems(Update, make_room_for_panel)
        .add_systems(EguiPrimaryContextPass, show_panel);
    }
}

/// What is typed into the panel, or done over it, reaches nothing else.
fn keep_input_of_panel(mut egui: ResMut<EguiGlobalSettings>) {
    egui.enable_absorb_bevy_input_system = true;
}

/// Draws the panel; the settings count as changed only where the player changed them.
fn show_panel(
    mut contexts: EguiContexts,
    mut settings: ResMut<DemoSettings>,
    status: Res<Status>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let mut changed = settings.clone();
    let height = context.content_rect().height();
    egui::Window::new("Tailorbird")
        .anchor(egui::Align2::RIGHT_TOP, [-6.0, 6.0])
        .resizable(false)
        .fixed_size([PANEL_WIDTH, height - 50.0])
        .show(context, |ui| {
            ui.set_width(PANEL_WIDTH);
            let mut state = PanelState {
                settings: &mut changed,
                status: &status,
            };
            egui::ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| panel(ui, &mut state));
        });
    settings.set_if_neq(changed);
    Ok(())
}

/// Moves the middle of the picture to the middle of what the panel leaves free.
fn make_room_for_panel(
    window: Single<&Window, With<PrimaryWindow>>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    let covered = (PANEL_WIDTH / window.width().max(1.0)).min(0.5);
    for mut camera in &mut cameras {
        if camera.covered != covered {
            camera.covered = covered;
        }
    }
}

/// Ends the app after as many frames as `TAILORBIRD_EXIT_AFTER_FRAMES` says, for tests.
pub struct ExitAfterFrames;

impl Plugin for ExitAfterFrames {
    fn build(&self, app: &mut App) {
        let frames = std::env::var("TAILORBIRD_EXIT_AFTER_FRAMES").ok();
        if let Some(frames) = frames.and_then(|frames| frames.parse::<u32>().ok()) {
            let exit = move |mut done: Local<u32>, mut exit: MessageWriter<AppExit>| {
                *done += 1;
                if *done >= frames {
                    exit.write(AppExit::Success);
                }
            };
            app.add_systems(Last, exit);
        }
    }
}
