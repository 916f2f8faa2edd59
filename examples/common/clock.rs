//! Times of the parts of a step, and what a frame does with them.

use std::time::Duration;

use tailorbird::cloth::wall_clock::WallClock;

use bevy::prelude::*;
use tailorbird::{mesh::ClothMeshSystems, prelude::*};

/// Measures the writing of meshes; the plugin measures the step.
pub struct StageClockPlugin;

/// Times of the stages in the last step.
#[derive(Resource, Clone, Debug, Default)]
pub struct StageTimes {
    start: Option<WallClock>,
    mesh: Duration,
}

impl StageTimes {
    /// Each stage with its time [ms], given that of the step.
    pub fn milliseconds(&self, step: &ClothStepTime) -> [(&'static str, f64); 3] {
        [
            ("substeps", step.simulate),
            ("before and after", step.total.saturating_sub(step.simulate)),
            // Other systems of the frame may run at the same time.
            ("mesh, each frame, at most", self.mesh),
        ]
        .map(|(name, time)| (name, 1e3 * time.as_secs_f64()))
    }
}

impl Plugin for StageClockPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<StageTimes>().add_systems(
            PostUpdate,
            (start.before(ClothMeshSystems), stop.after(ClothMeshSystems)).chain(),
        );
    }
}

fn start(mut times: ResMut<StageTimes>) {
    times.start = Some(WallClock::start());
}

fn stop(mut times: ResMut<StageTimes>) {
    times.mesh = times.start.map_or(Duration::ZERO, |start| start.elapsed());
}
