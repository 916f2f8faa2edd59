//! The panel: a plain function from settings to settings, without a world.

use bevy::math::Vec3;
use bevy_egui::egui;
use egui::{DragValue, Slider, Ui};
use tailorbird::prelude::*;

use super::{
    ask::Ask,
    detail::Detail,
    help::CONTROLS,
    notices::{Notices, problems},
    plot::performance,
    scene_list::scene_list,
    settings::{DemoSettings, Look},
    status::Status,
    thumbnails::Pictures,
};

/// Width of what is in the panel [points], where the window is wide enough.
const WIDTH: f32 = 310.0;
/// Of frame, margins and scroll bar [points].
const AROUND: f32 = 26.0;
/// From the window's edge [points].
const MARGIN: f32 = 6.0;
/// The most of the window's width that it covers [-].
const MOST: f32 = 1.0 / 3.0;

/// Width of what is in the panel, in a window of this width [points].
fn inner_width(window: f32) -> f32 {
    WIDTH.min(window * MOST - AROUND - MARGIN).max(80.0)
}

/// The part of a window's width [points] that the panel covers [-].
pub fn covered(window: f32) -> f32 {
    ((inner_width(window) + AROUND + MARGIN) / window.max(1.0)).min(0.5)
}

/// Text of the panel where it is the processor that draws.
pub const LOW: &str = "software renderer; --fine has everything";

/// State that the panel shows and changes.
pub struct PanelState<'a> {
    /// Is changed.
    pub settings: &'a mut DemoSettings,
    /// Is shown.
    pub status: &'a Status,
    /// Are shown, and closed.
    pub notices: &'a mut Notices,
    /// Are shown.
    pub pictures: &'a Pictures,
    /// Requests of the player, to which the panel adds.
    pub asks: &'a mut Vec<Ask>,
}

/// Shows the panel at the right of a window. What does not fit in is scrolled to. Returns where it is [points].
pub fn panel_window(context: &egui::Context, state: &mut PanelState) -> Option<egui::Rect> {
    let screen = context.content_rect();
    let width = inner_width(screen.width());
    let shown = egui::Window::new("Tailorbird")
        .anchor(egui::Align2::RIGHT_TOP, [-MARGIN, MARGIN])
        .resizable(false)
        // It is hidden with a key.
        .collapsible(false)
        .fixed_size([width, screen.height() - 50.0])
        .show(context, |ui| {
            ui.set_width(width);
            // It stays where it is while the rest is scrolled.
            problems(ui, state.notices);
            egui::ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| panel(ui, state));
        });
    shown.map(|window| window.response.rect)
}

/// Shows the settings and changes them as the player wants.
pub fn panel(ui: &mut Ui, state: &mut PanelState) {
    ui.spacing_mut().slider_width = (0.36 * ui.available_width()).min(112.0);
    let status = state.status;
    let decimals = usize::from(status.frame_rate < 10.0);
    ui.label(format!(
        "{:.decimals$} frames/s · {:.0} particles · {:.0} constraints",
        status.frame_rate, status.particles, status.constraints
    ));
    if status.detail == Detail::Low {
        ui.small(LOW);
    }
    scene(ui, state);
    section(ui, "Material", true, |ui| material(ui, state.settings));
    section(ui, "Air and gravity", true, |ui| air(ui, state.settings));
    section(ui, "Solver", true, |ui| {
        solver(ui, state.settings, status.substeps);
    });
    section(ui, "Performance", true, |ui| {
        performance(ui, state.settings, status);
    });
    section(ui, "Ball and hand", false, |ui| {
        ball_and_hand(ui, state.settings);
    });
    section(ui, "Look", false, |ui| look(ui, state.settings));
    section(ui, "Keys", false, keys);
}

fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(title)
        .default_open(open)
        .show(ui, add);
}

fn scene(ui: &mut Ui, state: &mut PanelState) {
    let settings = &mut *state.settings;
    ui.scope(|ui| scene_list(ui, settings, state.pictures));
    ui.horizontal_wrapped(|ui| {
        if ui.button("Reset").clicked() {
            settings.reset();
        }
        let pause = if settings.paused { "Go on" } else { "Pause" };
        if ui.button(pause).clicked() {
            settings.paused = !settings.paused;
        }
        if ui
            .add_enabled(settings.paused, egui::Button::new("Single step"))
            .clicked()
        {
            settings.single_steps = settings.single_steps.wrapping_add(1);
        }
    });
    ui.horizontal_wrapped(|ui| {
        for (name, ask, hint) in [
            ("Save", Ask::Save, "save the settings (F5)"),
            ("Load", Ask::Load, "load the settings (F9)"),
            (
                "Picture",
                Ask::Picture,
                "save a picture of the window (F12)",
            ),
            ("Hide", Ask::Panel, "hide the panel; H shows it again"),
        ] {
            if ui.button(name).on_hover_text(hint).clicked() {
                state.asks.push(ask);
            }
        }
    });
}

fn air(ui: &mut Ui, settings: &mut DemoSettings) {
    ui.add(Slider::new(&mut settings.gravity, 0.0..=20.0).text("gravity [m/s²]"));
    let wind = &mut settings.wind;
    let Vec3 { x, y, z } = &mut wind.velocity;
    ui.horizontal(|ui| {
        for (name, value) in [("x ", x), ("y ", y), ("z ", z)] {
            ui.add(
                DragValue::new(value)
                    .prefix(name)
                    .speed(0.05)
                    .range(-20.0..=20.0),
            );
        }
        ui.label("wind [m/s]");
    });
    ui.add(Slider::new(&mut wind.gusts.strength, 0.0..=1.0).text("gusts"));
    ui.add(Slider::new(&mut wind.gusts.period, 0.5..=10.0).text("between gusts [s]"));
    let swirls = &mut wind.turbulence;
    ui.add(Slider::new(&mut swirls.speed, 0.0..=5.0).text("turbulence [m/s]"));
    ui.add(Slider::new(&mut swirls.scale, 0.2..=5.0).text("largest eddies [m]"));
    ui.horizontal(|ui| {
        ui.radio_value(
            &mut wind.model,
            ClothWindModel::Aerodynamic,
            "drag and lift",
        );
        ui.radio_value(&mut wind.model, ClothWindModel::Classic, "classic");
    });
}

fn solver(ui: &mut Ui, settings: &mut DemoSettings, substeps_now: u32) {
    ui.horizontal(|ui| {
        ui.radio_value(&mut settings.solver, ClothSolver::Chains, "chains");
        ui.radio_value(
            &mut settings.solver,
            ClothSolver::GaussSeidel,
            "Gauss–Seidel",
        );
    });
    let mut automatic = settings.substeps.is_none();
    let mut substeps = settings.substeps.unwrap_or(substeps_now.max(1));
    ui.checkbox(&mut automatic, "as many substeps as needed");
    let slider = Slider::new(&mut substeps, 1..=30).text("substeps");
    ui.add_enabled(!automatic, slider);
    settings.substeps = (!automatic).then_some(substeps);
    ui.add(Slider::new(&mut settings.iterations, 0..=30).text("iterations"));
    ui.add(Slider::new(&mut settings.resolution, 4..=256).text("resolution"));
}

fn material(ui: &mut Ui, settings: &mut DemoSettings) {
    ui.horizontal_wrapped(|ui| {
        for fabric in ClothFabric::ALL {
            let name = &*fabric.name;
            // A click on the one that is chosen takes its values back.
            if ui.selectable_label(settings.preset == name, name).clicked() {
                settings.choose_preset(name);
            }
        }
    });
    let material = &mut settings.material;
    compliance(ui, &mut material.warp_compliance, 1.0, "warp [m/N]");
    compliance(ui, &mut material.weft_compliance, 1.0, "weft [m/N]");
    compliance(ui, &mut material.shear_compliance, 1.0, "shear [m/N]");
    compliance(ui, &mut material.bend_compliance, 1e7, "bend [1/(N m)]");
    ui.add(Slider::new(&mut material.viscosity, 0.0..=0.5).text("viscosity [m²/s]"));
    ui.add(Slider::new(&mut material.damping, 0.0..=10.0).text("damping [1/s]"));
    ui.add(Slider::new(&mut material.areal_density, 0.02..=2.0).text("density [kg/m²]"));
    ui.add(Slider::new(&mut material.friction, 0.0..=2.0).text("friction"));
    ui.add(Slider::new(&mut material.thickness, 0.0..=0.03).text("thickness [m]"));
}

/// 0 is rigid; above, orders of magnitude matter.
fn compliance(ui: &mut Ui, value: &mut f32, most: f32, text: &str) {
    let slider = Slider::new(value, 0.0..=most)
        .logarithmic(true)
        .smallest_positive(1e-7)
        .custom_formatter(|value, _| {
            if value == 0.0 {
                "0".into()
            } else {
                format!("{value:.0e}")
            }
        });
    ui.add(slider.text(text));
}

fn ball_and_hand(ui: &mut Ui, settings: &mut DemoSettings) {
    ui.add(Slider::new(&mut settings.sphere_radius, 0.05..=0.8).text("radius [m]"));
    ui.add(Slider::new(&mut settings.sphere_speed, 0.1..=10.0).text("speed [m/s]"));
    ui.add(Slider::new(&mut settings.grab_radius, 0.0..=0.3).text("hand [m]"));
    ui.horizontal(|ui| {
        ui.label("picking:");
        ui.radio_value(&mut settings.picking, ClothPickingBackend::Ray, "ray");
        ui.radio_value(&mut settings.picking, ClothPickingBackend::Depth, "depth");
    });
}

fn look(ui: &mut Ui, settings: &mut DemoSettings) {
    ui.horizontal(|ui| {
        ui.radio_value(&mut settings.shading, ClothShading::Smooth, "smooth");
        ui.radio_value(&mut settings.shading, ClothShading::Flat, "flat");
    });
    ui.horizontal_wrapped(|ui| {
        for (name, value) in settings.look.toggles() {
            ui.checkbox(value, name);
        }
    });
    let look = &mut settings.look;
    let lens = Slider::new(&mut look.f_number, Look::F_NUMBERS).logarithmic(true);
    ui.add_enabled(look.depth_of_field, lens.text("f-number"));
}

fn keys(ui: &mut Ui) {
    egui::Grid::new("keys").num_columns(2).show(ui, |ui| {
        for (control, action) in CONTROLS {
            ui.label(egui::RichText::new(control).strong());
            ui.label(action);
            ui.end_row();
        }
    });
}
