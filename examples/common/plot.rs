//! Times and stretch over the last seconds, and what the cloths do.

use bevy_egui::egui;
use egui_plot::{Line, Plot, PlotPoints};
use tailorbird::prelude::*;

use super::{
    settings::DemoSettings,
    status::{Sample, Status},
};

const BLUE: egui::Color32 = egui::Color32::from_rgb(90, 170, 250);
const ORANGE: egui::Color32 = egui::Color32::from_rgb(250, 160, 80);
const GREEN: egui::Color32 = egui::Color32::from_rgb(120, 200, 120);

/// Times, stretch, and both solvers side by side.
pub fn performance(ui: &mut egui::Ui, settings: &mut DemoSettings, status: &Status) {
    ui.label(format!("{:.0} particles", status.particles));
    let now = status.now();
    ui.label(format!("Frame: {:.1} ms", now.frame_time));
    plot(ui, "frame time", status, |sample| sample.frame_time, GREEN);
    ui.label(format!("Step: {:.2} ms", now.step_time));
    plot(ui, "step time", status, |sample| sample.step_time, BLUE);
    stages(ui, status);
    ui.label(format!(
        "Largest stretch: {:.1} % (mean {:.2} %)",
        now.stretch, status.mean_stretch
    ));
    plot(ui, "stretch", status, |sample| sample.stretch, ORANGE);
    ui.checkbox(&mut settings.beside, "the other solver beside (C)");
    solvers(ui, settings.beside, status);
}

fn stages(ui: &mut egui::Ui, status: &Status) {
    egui::Grid::new("stages").num_columns(2).show(ui, |ui| {
        for (name, milliseconds) in &status.stages {
            ui.label(*name);
            ui.label(format!("{milliseconds:.2} ms"));
            ui.end_row();
        }
    });
}

/// Each cloth's stretch; of the second one, by how much a step is longer with it.
fn solvers(ui: &mut egui::Ui, beside: bool, status: &Status) {
    if status.cloths.is_empty() {
        return;
    }
    let [alone, both] = status.step_times;
    let times = if beside {
        [alone, both - alone]
    } else {
        [alone, 0.0]
    };
    let known = alone > 0.0 && (!beside || both > 0.0);
    egui::Grid::new("solvers")
        .num_columns(5)
        .spacing([10.0, 4.0])
        .striped(true)
        .show(ui, |ui| {
            for head in ["", "mean", "99 %", "max", "step"] {
                ui.label(egui::RichText::new(head).strong());
            }
            ui.end_row();
            for (cloth, time) in status.cloths.iter().zip(times) {
                ui.label(solver_name(cloth.solver));
                let ClothStretch { mean, p99, max } = cloth.stretch;
                for part in [mean, p99, max] {
                    ui.label(percent(part));
                }
                ui.label(if known {
                    format!("{:.1} ms", time.max(0.0))
                } else {
                    "–".into()
                });
                ui.end_row();
            }
        });
}

/// Shows what the cloths that hang side by side do, at the upper left of the window, with the panel or without.
pub fn beside(context: &egui::Context, status: &Status) {
    egui::Area::new("beside".into())
        .anchor(egui::Align2::LEFT_TOP, [12.0, 12.0])
        .interactable(false)
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.label("ClothStretch and time, from left to right");
                solvers(ui, true, status);
            });
        });
}

/// Name of a solver in the panel.
pub fn solver_name(solver: ClothSolver) -> &'static str {
    match solver {
        ClothSolver::Chains => "chains",
        ClothSolver::GaussSeidel => "classic",
    }
}

fn percent(part: f32) -> String {
    let percent = 100.0 * part;
    if percent < 10.0 {
        format!("{percent:.2} %")
    } else {
        format!("{percent:.0} %")
    }
}

fn plot(
    ui: &mut egui::Ui,
    name: &str,
    status: &Status,
    value: impl Fn(&Sample) -> f64,
    color: egui::Color32,
) {
    let end = status.now().time;
    let points: Vec<[f64; 2]> = status
        .samples
        .iter()
        .map(|sample| [sample.time - end, value(sample)])
        .collect();
    Plot::new(name)
        .height(56.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_x(false)
        .include_x(-Status::SPAN)
        .include_x(0.0)
        .include_y(0.0)
        .y_axis_min_width(28.0)
        .show(ui, |plot| {
            plot.line(Line::new(name, PlotPoints::from(points)).color(color));
        });
}
