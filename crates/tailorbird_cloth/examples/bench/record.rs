//! One measurement, as it is printed and written.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

/// One measurement. The names are those of the JSON; the first eight are those that `benches/peers` reads.
#[derive(Serialize, Clone, Debug)]
pub struct Record {
    pub solver: &'static str,
    pub scene: &'static str,
    /// Particles along a side.
    pub size: u32,
    /// Passes over the constraints in a step.
    pub passes: u32,
    /// The whole step, median \[ms\].
    pub ms: f64,
    /// Mean of max(0, l/L − 1) over the edges along rows and columns \[-\].
    pub stretch_mean: f64,
    /// The value that 99 % of them do not exceed \[-\].
    pub stretch_p99: f64,
    /// The largest \[-\].
    pub stretch_max: f64,
    pub substeps: u32,
    /// True if the solver chose the number of substeps.
    pub automatic: bool,
    /// Passes in a substep.
    pub iterations: u32,
    /// Mean of max(0, 1 − l/L) \[-\]; for scenes with a sphere.
    pub compression_mean: Option<f64>,
    /// \[ns\].
    pub ns_per_particle_substep: f64,
    /// Of all cloths.
    pub particles: usize,
    /// Of state, normals, tethers and topology.
    pub bytes_per_particle: f64,
    /// To build one topology \[ms\].
    pub topology_ms: f64,
}

/// The head of the table.
pub const HEADER: &str = "scene         size solver        passes    ms/step  ns/part/sub      mean      99 %   largest    shrunk  particles  B/part  topology";

impl Display for Record {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let percent = |v: f64| format!("{:.4} %", v * 100.0);
        let automatic = if self.automatic { "*" } else { " " };
        let passes = format!("{}×{}{automatic}", self.substeps, self.iterations);
        write!(
            f,
            "{:<13} {:>4} {:<13} {passes:>6} {:>10.3} {:>12.2} {:>9} {:>9} {:>9} {:>9} {:>10} {:>7.0} {:>6.2} ms",
            self.scene,
            self.size,
            self.solver,
            self.ms,
            self.ns_per_particle_substep,
            percent(self.stretch_mean),
            percent(self.stretch_p99),
            percent(self.stretch_max),
            self.compression_mean.map_or_else(|| "-".into(), percent),
            self.particles,
            self.bytes_per_particle,
            self.topology_ms,
        )
    }
}
