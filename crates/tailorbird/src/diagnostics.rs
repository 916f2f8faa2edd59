//! Figures about the cloths for Bevy's `DiagnosticsStore`.

use bevy_app::{App, Plugin, PostUpdate};
use bevy_diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy_ecs::prelude::*;
use tailorbird_cloth::prelude::*;

/// Counts particles and constraints, times steps and measures stretch, in `PostUpdate`.
pub struct ClothDiagnosticsPlugin;

impl ClothDiagnosticsPlugin {
    /// Duration of the last step \[ms\].
    pub const STEP_TIME: DiagnosticPath = DiagnosticPath::const_new("cloth/step_time");
    /// Substeps of the last step.
    pub const SUBSTEPS: DiagnosticPath = DiagnosticPath::const_new("cloth/substeps");
    /// Particles of all cloths.
    pub const PARTICLES: DiagnosticPath = DiagnosticPath::const_new("cloth/particles");
    /// Constraints of all cloths.
    pub const CONSTRAINTS: DiagnosticPath = DiagnosticPath::const_new("cloth/constraints");
    /// Mean stretch over all edges of all cloths [%], every 15th step.
    pub const MEAN_STRETCH: DiagnosticPath = DiagnosticPath::const_new("cloth/mean_stretch");
    /// Largest stretch of any edge [%], every 15th step.
    pub const MAX_STRETCH: DiagnosticPath = DiagnosticPath::const_new("cloth/max_stretch");
}

impl Plugin for ClothDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        app.register_diagnostic(Diagnostic::new(Self::STEP_TIME).with_suffix(" ms"))
            .register_diagnostic(Diagnostic::new(Self::SUBSTEPS))
            .register_diagnostic(Diagnostic::new(Self::PARTICLES))
            .register_diagnostic(Diagnostic::new(Self::CONSTRAINTS))
            .register_diagnostic(Diagnostic::new(Self::MEAN_STRETCH).with_suffix(" %"))
            .register_diagnostic(Diagnostic::new(Self::MAX_STRETCH).with_suffix(" %"))
            .add_systems(PostUpdate, measure.run_if(resource_exists::<ClothStep>));
    }
}

/// Steps from one measurement of stretch to the next: it costs a good part of a step.
const STRETCH_EVERY: u64 = 15;

/// Measures, in frames in which the simulation went on.
fn measure(
    step: Res<ClothStep>,
    step_time: Res<ClothStepTime>,
    mut measured: Local<u64>,
    mut stretched: Local<u64>,
    cloths: Query<(&ClothTopology, &ClothParticles)>,
    mut diagnostics: Diagnostics,
) {
    if *measured == step.steps() {
        return;
    }
    *measured = step.steps();
    let particles: usize = cloths.iter().map(|(_, particles)| particles.len()).sum();
    let constraints: usize = cloths
        .iter()
        .map(|(topology, _)| topology.constraint_count())
        .sum();
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::STEP_TIME, || {
        step_time.total.as_secs_f64() * 1e3
    });
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::SUBSTEPS, || {
        f64::from(step.substeps())
    });
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::PARTICLES, || particles as f64);
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::CONSTRAINTS, || constraints as f64);

    if step.steps() < *stretched + STRETCH_EVERY && *stretched > 0 {
        return;
    }
    *stretched = step.steps();
    let (mut sum, mut weight, mut max) = (0.0, 0.0, 0.0f32);
    for (topology, particles) in &cloths {
        let stretch = particles.stretch(topology);
        sum += f64::from(stretch.mean) * particles.len() as f64;
        weight += particles.len() as f64;
        max = max.max(stretch.max);
    }
    if weight > 0.0 {
        diagnostics.add_measurement(&ClothDiagnosticsPlugin::MEAN_STRETCH, || {
            100.0 * sum / weight
        });
        diagnostics.add_measurement(&ClothDiagnosticsPlugin::MAX_STRETCH, || {
            100.0 * f64::from(max)
        });
    }
}
