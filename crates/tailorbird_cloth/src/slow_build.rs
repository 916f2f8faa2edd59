//! Says so where cloth is slow because it was built without optimisation: nothing else in a game tells.

use bevy_ecs::prelude::*;
use tailorbird_solver::UNOPTIMISED;
use tracing::warn;

use crate::{diagnostics::ClothStepTime, step::ClothStep};

/// Lines for `Cargo.toml` that make a development build as fast as a release build, where cloth is concerned.
pub const PROFILE_LINES: &str = include_str!("profile.toml");

/// Warns once when a step takes longer than it lasts, and the build is why.
pub(crate) fn warn_of_slow_build(
    step: Res<ClothStep>,
    time: Res<ClothStepTime>,
    mut warned: Local<bool>,
) {
    if !UNOPTIMISED || *warned || !step.running() || time.simulate.as_secs_f32() <= step.seconds() {
        return;
    }
    *warned = true;
    warn!(
        "a step of {:.1} ms of cloth took {:.0} ms, since tailorbird_solver was built without optimisation: that is some 200 times as \
         slow as it need be. Development builds are fast with these lines in Cargo.toml:\n\n{PROFILE_LINES}",
        step.seconds() * 1e3,
        time.simulate.as_secs_f32() * 1e3,
    );
}
