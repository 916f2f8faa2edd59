//! Step time and stretch over the last seconds.

use bevy_egui::egui;
use egui_plot::{Line, Plot, PlotPoints};

use super::status::{Sample, Status};

/// Draws both.
pub fn plots(ui: &mut egui::Ui, status: &Status) {
    let now = status.now();
    ui.label(format!("Step time: {:.2} ms", now.step_time));
    plot(
        ui,
        "step time",
        status,
        |sample| sample.step_time,
        egui::Color32::from_rgb(90, 170, 250),
    );
    ui.label(format!(
        "Largest stretch: {:.1} % (mean {:.2} %)",
        now.stretch, status.mean_stretch
    ));
    plot(
        ui,
        "stretch",
        status,
        |sample| sample.stretch,
        egui::Color32::from_rgb(250, 160, 80),
    );
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
        .height(70.0)
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
