//! The lines of a chart: one for each solver and size.

use std::collections::BTreeMap;

use plotters::style::RGBColor;

use crate::record::Record;

/// Told apart by people who see colours differently (Okabe and Ito, Color Universal Design, 2008).
const COLORS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
];

/// The form of a marker. Tells sizes apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Circle,
    Triangle,
    Cross,
    Ring,
}

const MARKS: [Mark; 4] = [Mark::Circle, Mark::Triangle, Mark::Cross, Mark::Ring];

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Passes in a step.
    pub passes: u32,
    /// Time per step [ms].
    pub ms: f64,
    /// Mean stretch [%].
    pub percent: f64,
}

/// The measurements of a solver at one size, by passes.
#[derive(Debug, Clone)]
pub struct Series {
    /// Who.
    pub solver: String,
    /// Particles along a side.
    pub size: u32,
    /// Of the solver.
    pub color: RGBColor,
    /// Of the size.
    pub mark: Mark,
    /// At least one.
    pub points: Vec<Point>,
}

impl Series {
    /// For the legend.
    pub fn name(&self) -> String {
        format!("{}, {}²", self.solver, self.size)
    }
}

/// Sorts records into series: solvers in the order of their first record, sizes from small to large.
pub fn group(records: &[Record]) -> Vec<Series> {
    let mut solvers: Vec<&str> = Vec::new();
    let mut sizes: Vec<u32> = Vec::new();
    let mut groups: BTreeMap<(usize, u32), Vec<Point>> = BTreeMap::new();
    for record in records {
        let place = solvers.iter().position(|name| *name == record.solver);
        let solver = place.unwrap_or_else(|| {
            solvers.push(&record.solver);
            solvers.len() - 1
        });
        sizes.push(record.size);
        groups
            .entry((solver, record.size))
            .or_default()
            .push(Point {
                passes: record.passes,
                ms: record.ms,
                percent: record.stretch_mean * 100.0,
            });
    }
    sizes.sort_unstable();
    sizes.dedup();
    groups
        .into_iter()
        .map(|((solver, size), mut points)| {
            points.sort_by(|a, b| a.passes.cmp(&b.passes).then(a.ms.total_cmp(&b.ms)));
            let rank = sizes.iter().take_while(|other| **other < size).count();
            Series {
                solver: solvers[solver].to_owned(),
                size,
                color: COLORS[solver % COLORS.len()],
                mark: MARKS[rank % MARKS.len()],
                points,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(solver: &str, size: u32, passes: u32) -> Record {
        Record {
            solver: solver.to_owned(),
            scene: "hang".to_owned(),
            size,
            passes,
            ms: f64::from(passes),
            stretch_mean: 0.01,
            stretch_p99: 0.02,
            stretch_max: 0.03,
        }
    }

    #[test]
    fn a_series_for_each_solver_and_size_by_passes() {
        let records = [("b", 64, 30), ("a", 64, 15), ("b", 64, 15), ("b", 32, 15)];
        let series = group(&records.map(|(solver, size, passes)| record(solver, size, passes)));
        let names: Vec<_> = series.iter().map(Series::name).collect();
        assert_eq!(names, ["b, 32²", "b, 64²", "a, 64²"]);
        let passes: Vec<_> = series[1].points.iter().map(|point| point.passes).collect();
        assert_eq!(passes, [15, 30]);
        assert_eq!(series[0].color, series[1].color);
        assert_eq!(series[1].mark, series[2].mark);
    }
}
