//! Draws mean stretch against time, both logarithmic: a line for each solver and size.
//!
//! The picture is SVG, whose text the viewer sets, so no font is needed here. Its ground is white, whatever it is shown
//! on.

mod axis;
mod series;

use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use crate::{cli::PlotArgs, error::Error, record};
use axis::Axis;
use series::{Mark, Series};

/// Of the picture [px].
const SIZE: (u32, u32) = (960, 560);
/// Width of the legend [px].
const LEGEND: u32 = 200;
/// Distance between the legend's lines [px].
const LINE: i32 = 26;
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
const GRID: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawingResult = Result<(), Box<dyn std::error::Error>>;

/// Draws the figures in some files.
///
/// # Errors
/// When a file cannot be read, holds something else, there is nothing to draw, or the picture cannot be written.
pub fn draw(args: &PlotArgs) -> Result<(), Error> {
    let mut records = Vec::new();
    for file in &args.files {
        records.extend(record::read(file)?);
    }
    let (of_scene, other): (Vec<_>, Vec<_>) =
        records.into_iter().partition(|r| r.scene == args.scene);
    let (records, unfit): (Vec<_>, Vec<_>) = of_scene.into_iter().partition(|r| {
        [r.ms, r.stretch_mean]
            .iter()
            .all(|v| v.is_finite() && *v > 0.0)
    });
    for (left_out, why) in [
        (other.len(), "of other scenes"),
        (unfit.len(), "whose time or mean stretch is not above zero"),
    ] {
        if left_out > 0 {
            eprintln!("note: left out {left_out} {why}");
        }
    }
    if records.is_empty() {
        return Err(Error::NothingToDraw(args.scene.clone()));
    }
    let series = series::group(&records);
    let result = picture(args, &series);
    result.map_err(|reason| Error::Drawing {
        path: args.out.clone(),
        reason: reason.to_string(),
    })
}

fn picture(args: &PlotArgs, series: &[Series]) -> DrawingResult {
    let root = SVGBackend::new(&args.out, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(SIZE.0 - LEGEND);
    chart(&left, series, &args.scene)?;
    legend(&right, series)?;
    root.present()?;
    Ok(())
}

fn chart(area: &Area, series: &[Series], scene: &str) -> DrawingResult {
    let points = || series.iter().flat_map(|s| &s.points);
    let x = Axis::around(points().map(|p| p.ms));
    let y = Axis::around(points().map(|p| p.percent));
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .caption(
            format!("Scene `{scene}`: further down stretches less, further left takes less time"),
            (FONT, 17).into_font().color(&INK),
        )
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(
            x.range().log_scale().with_key_points(x.ticks()),
            y.range().log_scale().with_key_points(y.ticks()),
        )?;
    let label = |value: &f64| format!("{value}");
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style((FONT, 15).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .x_label_formatter(&label)
        .y_label_formatter(&|value| format!("{value} %"))
        .x_desc("time per step [ms]")
        .y_desc("mean stretch")
        .draw()?;
    for one in series {
        let at = one.points.iter().map(|p| (p.ms, p.percent));
        chart.draw_series(LineSeries::new(at, one.color.stroke_width(2)))?;
    }
    // Above all lines.
    for one in series {
        let at = one.points.iter().map(|p| (p.ms, p.percent));
        let style = TextStyle::from((FONT, 12).into_font())
            .color(&INK)
            .pos(Pos::new(HPos::Left, VPos::Bottom));
        for (point, at) in one.points.iter().zip(at) {
            let text = Text::new(format!("{}", point.passes), (6, -4), style.clone());
            chart.draw_series([EmptyElement::at(at) + text])?;
            match one.mark {
                Mark::Circle => chart.draw_series([Circle::new(at, 5, one.color.filled())])?,
                Mark::Triangle => {
                    chart.draw_series([TriangleMarker::new(at, 7, one.color.filled())])?
                }
                Mark::Cross => chart.draw_series([Cross::new(at, 5, one.color.stroke_width(3))])?,
                Mark::Ring => chart.draw_series([
                    Circle::new(at, 5, WHITE.filled()),
                    Circle::new(at, 5, one.color.stroke_width(2)),
                ])?,
            };
        }
    }
    Ok(())
}

fn legend(area: &Area, series: &[Series]) -> DrawingResult {
    let style = TextStyle::from((FONT, 15).into_font())
        .color(&INK)
        .pos(Pos::new(HPos::Left, VPos::Center));
    let first = 62;
    for (one, y) in series.iter().zip((first..).step_by(LINE as usize)) {
        let middle = (18, y);
        let line = vec![(2, y), (34, y)];
        area.draw(&PathElement::new(line, one.color.stroke_width(2)))?;
        match one.mark {
            Mark::Circle => area.draw(&Circle::new(middle, 5, one.color.filled()))?,
            Mark::Triangle => area.draw(&TriangleMarker::new(middle, 7, one.color.filled()))?,
            Mark::Cross => area.draw(&Cross::new(middle, 5, one.color.stroke_width(3)))?,
            Mark::Ring => {
                area.draw(&Circle::new(middle, 5, WHITE.filled()))?;
                area.draw(&Circle::new(middle, 5, one.color.stroke_width(2)))?;
            }
        }
        area.draw(&Text::new(one.name(), (44, y), style.clone()))?;
    }
    let end = first + LINE * series.len() as i32 + LINE / 2;
    for (text, y) in ["Numbers are passes", "per step."]
        .iter()
        .zip([end, end + 18])
    {
        let small = TextStyle::from((FONT, 13).into_font())
            .color(&INK)
            .pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(*text, (2, y), small))?;
    }
    Ok(())
}
