//! The figures about a sheet.

use std::{
    fmt::{self, Display, Formatter},
    time::Duration,
};

use serde::Serialize;
use tailorbird_cloth::prelude::*;

use super::{cli::Args, scene::Sheet};

/// Report; the names are those of the JSON.
#[derive(Serialize, Clone, Debug)]
pub struct Report {
    particles: usize,
    constraints: usize,
    substeps: u32,
    steps: u32,
    /// The whole step, from reading transforms to normals and bounds [ms].
    ms_per_step_median: f64,
    /// Mean of max(0, l/L − 1) over the structural edges, at the end [-].
    stretch_mean: f32,
    /// The value that 99 % of the edges do not exceed [-].
    stretch_p99: f32,
    /// The largest [-].
    stretch_max: f32,
    /// Displacement of the particles in the last step, by its length, root of the mean square [m/s].
    step_speed_rms: f64,
    /// The largest [m/s].
    step_speed_max: f32,
    /// The fastest free particle from step to step in the last second [m/s].
    speed_max: f32,
    /// The same of the whole run [m/s].
    speed_peak: f32,
    /// The largest stretch of the whole run [-].
    stretch_peak: f32,
    /// The most by which the energy of motion and height was above that at the start [J].
    energy_gained: f64,
    /// The lowest particle [m].
    lowest_y: f32,
    /// The highest particle [m].
    highest_y: f32,
    /// Of the particles that are not pinned [J].
    kinetic_energy: f64,
    /// Of the particles that are not pinned, in world axes [kg m/s].
    momentum: [f32; 3],
    /// From the nearest particle to the sphere, negative inside [m]; none without a sphere.
    min_sphere_clearance: Option<f32>,
    /// Of all bits of the positions.
    state_hash: String,
}

impl Report {
    /// The figures about a sheet whose steps took this long.
    pub fn of(args: &Args, sheet: &Sheet, step_time: Duration) -> Self {
        let particles = sheet.get::<ClothParticles>();
        let topology = sheet.get::<ClothTopology>();
        let frame = sheet.get::<ClothFrame>();
        let stretch = particles.stretch(topology);
        let speeds: Vec<f32> = particles
            .points()
            .iter()
            .zip(particles.previous_points().iter())
            .map(|(to, from)| to.distance(from) * args.hz as f32)
            .collect();
        let lowest = |lowest: f32, value: f32| lowest.min(value);
        Self {
            particles: particles.len(),
            constraints: topology.constraint_count(),
            substeps: sheet.app.world().resource::<ClothStep>().substeps(),
            steps: args.steps(),
            ms_per_step_median: step_time.as_secs_f64() * 1e3,
            stretch_mean: stretch.mean,
            stretch_p99: stretch.p99,
            stretch_max: stretch.max,
            step_speed_rms: (speeds.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>()
                / speeds.len() as f64)
                .sqrt(),
            step_speed_max: speeds.iter().copied().fold(0.0, f32::max),
            speed_max: sheet.peaks.speed_of_last_second(),
            speed_peak: sheet.peaks.all.speed,
            stretch_peak: sheet.peaks.all.stretch,
            energy_gained: sheet.peaks.energy_gained,
            highest_y: sheet
                .world_positions()
                .map(|p| p.y)
                .fold(f32::NEG_INFINITY, f32::max),
            lowest_y: sheet
                .world_positions()
                .map(|p| p.y)
                .fold(f32::INFINITY, lowest),
            kinetic_energy: particles.kinetic_energy(),
            momentum: frame.vector_to_world(particles.momentum()).to_array(),
            min_sphere_clearance: args.sphere().map(|sphere| {
                sheet
                    .world_positions()
                    .map(|p| p.distance(sphere.center) - sphere.radius)
                    .fold(f32::INFINITY, lowest)
            }),
            state_hash: format!("{:016x}", hash(particles)),
        }
    }

    /// Time for one constraint in one pass, if the whole step were nothing else [ns].
    fn ns_per_constraint(&self, args: &Args) -> f64 {
        let passes = f64::from(self.substeps * args.iterations);
        self.ms_per_step_median * 1e6 / (self.constraints as f64 * passes)
    }
}

/// FNV-1a, 64 bits, over the bits of all coordinates in the cloth's frame.
fn hash(particles: &ClothParticles) -> u64 {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    particles
        .positions()
        .flat_map(|p| p.to_array())
        .flat_map(|v| v.to_bits().to_le_bytes())
        .fold(OFFSET_BASIS, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(PRIME)
        })
}

/// The report as a table, with the arguments that shape it.
pub struct Table<'a>(pub &'a Report, pub &'a Args);

impl Display for Table<'_> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Self(report, args) = self;
        let percent = |v: f32| format!("{:.4} %", v * 100.0);
        let [x, y, z] = report.momentum;
        let clearance = report
            .min_sphere_clearance
            .map_or("-".into(), |v| format!("{v:.6} m"));
        let rows = [
            ("particles", report.particles.to_string()),
            ("constraints", report.constraints.to_string()),
            ("steps", report.steps.to_string()),
            (
                "passes per step",
                format!("{} × {}", report.substeps, args.iterations),
            ),
            (
                "step, median",
                format!("{:.4} ms", report.ms_per_step_median),
            ),
            (
                "per constraint and pass",
                format!("{:.2} ns", report.ns_per_constraint(args)),
            ),
            ("stretch, mean", percent(report.stretch_mean)),
            ("stretch, 99 %", percent(report.stretch_p99)),
            ("stretch, largest", percent(report.stretch_max)),
            ("speed, rms", format!("{:.3e} m/s", report.step_speed_rms)),
            (
                "speed, largest",
                format!("{:.3e} m/s", report.step_speed_max),
            ),
            (
                "speed, last second",
                format!("{:.3e} m/s", report.speed_max),
            ),
            ("speed, peak", format!("{:.3e} m/s", report.speed_peak)),
            ("stretch, peak", percent(report.stretch_peak)),
            ("energy gained", format!("{:.3e} J", report.energy_gained)),
            ("highest y", format!("{:.6} m", report.highest_y)),
            ("lowest y", format!("{:.6} m", report.lowest_y)),
            ("kinetic energy", format!("{:.3e} J", report.kinetic_energy)),
            ("momentum", format!("{x:.3e}, {y:.3e}, {z:.3e} kg m/s")),
            ("clearance of the sphere", clearance),
            ("state hash", report.state_hash.clone()),
        ];
        for (name, value) in rows {
            writeln!(f, "{name:<24} {value}")?;
        }
        Ok(())
    }
}
