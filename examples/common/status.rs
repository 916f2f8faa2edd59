//! Figures that the panel shows: frame rate, times, stretch, now and over the last seconds.

use std::collections::VecDeque;

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin},
    prelude::*,
};
use tailorbird::prelude::*;

use super::{
    clock::{StageClockPlugin, StageTimes},
    compare::{self, Beside, ClothFigures},
    detail::Detail,
    scenes::SceneCloth,
    settings::DemoSettings,
};

/// Keeps a [`Status`].
pub struct StatusPlugin;

impl Plugin for StatusPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((FrameTimeDiagnosticsPlugin::default(), StageClockPlugin))
            .init_resource::<Status>()
            .add_systems(Update, (observe, observe_cloths));
    }
}

/// Figures of now and of the last seconds.
#[derive(Resource, Clone, Debug, Default)]
pub struct Status {
    /// Detail of the picture.
    pub detail: Detail,
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
    /// The stages of a step with their times [ms].
    pub stages: Vec<(&'static str, f64)>,
    /// The cloths of the scene, every 15th step.
    pub cloths: Vec<ClothFigures>,
    /// The time of a step with one cloth, and with a second beside it [ms], smoothed; 0 where it was not measured.
    pub step_times: [f64; 2],
}

/// Figures at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// [s].
    pub time: f64,
    /// Time of a step [ms].
    pub step_time: f64,
    /// Time of a frame [ms].
    pub frame_time: f64,
    /// The largest stretch [%].
    pub stretch: f64,
}

impl Status {
    /// Time that the samples go back [s].
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

fn observe(
    time: Res<Time<Real>>,
    diagnostics: Res<DiagnosticsStore>,
    stages: Res<StageTimes>,
    step: Res<ClothStepTime>,
    detail: Option<Res<Detail>>,
    mut status: ResMut<Status>,
) {
    status.detail = detail.map_or_else(Detail::default, |detail| *detail);
    let figure = |path: &DiagnosticPath| diagnostics.get(path);
    let last = |path: &DiagnosticPath| figure(path).and_then(Diagnostic::value).unwrap_or(0.0);
    status.frame_rate = figure(&FrameTimeDiagnosticsPlugin::FPS)
        .and_then(Diagnostic::smoothed)
        .unwrap_or(0.0);
    status.particles = last(&ClothDiagnosticsPlugin::PARTICLES);
    status.constraints = last(&ClothDiagnosticsPlugin::CONSTRAINTS);
    status.substeps = last(&ClothDiagnosticsPlugin::SUBSTEPS).round() as u32;
    status.mean_stretch = last(&ClothDiagnosticsPlugin::MEAN_STRETCH);
    status.stages = stages.milliseconds(&step).into();
    status.add(Sample {
        time: time.elapsed_secs_f64(),
        step_time: last(&ClothDiagnosticsPlugin::STEP_TIME),
        frame_time: last(&FrameTimeDiagnosticsPlugin::FRAME_TIME),
        stretch: last(&ClothDiagnosticsPlugin::MAX_STRETCH),
    });
}

/// Steps from one measurement of stretch to the next: it costs a good part of a step.
const STRETCH_EVERY: u64 = 15;

fn observe_cloths(
    step: Res<ClothStep>,
    step_time: Res<ClothStepTime>,
    settings: Res<DemoSettings>,
    cloths: Query<(&ClothSolver, &ClothParticles, &ClothTopology, Has<Beside>), With<SceneCloth>>,
    mut seen: Local<(u64, u64, usize)>,
    mut status: ResMut<Status>,
) {
    let count = cloths.iter().len();
    let (steps, stretched, before) = &mut *seen;
    let now = step.steps();
    if *steps != now && count > 0 {
        *steps = now;
        let last = 1e3 * step_time.total.as_secs_f64();
        let smooth = &mut status.step_times[usize::from(settings.beside)];
        // The first steps build things.
        *smooth = if *smooth == 0.0 || *before != count {
            last
        } else {
            *smooth + 0.05 * (last - *smooth)
        };
    }
    if now >= *stretched + STRETCH_EVERY || *before != count {
        (*stretched, *before) = (now, count);
        status.cloths = compare::figures(&cloths);
    }
}
