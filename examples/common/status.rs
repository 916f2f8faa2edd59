//! What the panel shows: frame rate, step time, stretch, now and over the last seconds.

use std::collections::VecDeque;

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin},
    prelude::*,
};
use tailorbird::prelude::*;

/// Keeps a [`Status`].
pub struct StatusPlugin;

impl Plugin for StatusPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(FrameTimeDiagnosticsPlugin::default())
            .init_resource::<Status>()
            .add_systems(Update, observe);
    }
}

/// Figures of now and of the last seconds.
#[derive(Resource, Clone, Debug, Default)]
pub struct Status {
    /// Frames per second.
    pub frame_rate: f64,
    /// Particles of all cloths.
    pub particles: f64,
    /// Constraints of all cloths.
    pub constraints: f64,
    /// Substeps of the last step.
    pub substeps: u32,
    /// Mean stretch [%].
    pub mean_stretch: f64,
    /// One sample per frame, the oldest first.
    pub samples: VecDeque<Sample>,
}

/// Figures at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// [s].
    pub time: f64,
    /// How long a step took [ms].
    pub step_time: f64,
    /// The largest stretch [%].
    pub stretch: f64,
}

impl Status {
    /// How far back the samples go [s].
    pub const SPAN: f64 = 10.0;

    /// Adds a sample and forgets those that are too old.
    pub fn add(&mut self, sample: Sample) {
        self.samples.push_back(sample);
        while self
            .samples
            .front()
            .is_some_and(|first| first.time < sample.time - Self::SPAN)
        {
            self.samples.pop_front();
        }
    }

    /// The newest sample.
    pub fn now(&self) -> Sample {
        self.samples.back().copied().unwrap_or_default()
    }
}

fn observe(time: Res<Time<Real>>, diagnostics: Res<DiagnosticsStore>, mut status: ResMut<Status>) {
    let figure = |path: &DiagnosticPath| diagnostics.get(path);
    let last = |path: &DiagnosticPath| figure(path).and_then(Diagnostic::value).unwrap_or(0.0);
    status.frame_rate = figure(&FrameTimeDiagnosticsPlugin::FPS)
        .and_then(Diagnostic::smoothed)
        .unwrap_or(0.0);
    status.particles = last(&ClothDiagnosticsPlugin::PARTICLES);
    status.constraints = last(&ClothDiagnosticsPlugin::CONSTRAINTS);
    status.substeps = last(&ClothDiagnosticsPlugin::SUBSTEPS).round() as u32;
    status.mean_stretch = last(&ClothDiagnosticsPlugin::MEAN_STRETCH);
    status.add(Sample {
        time: time.elapsed_secs_f64(),
        step_time: last(&ClothDiagnosticsPlugin::STEP_TIME),
        stretch: last(&ClothDiagnosticsPlugin::MAX_STRETCH),
    });
}
