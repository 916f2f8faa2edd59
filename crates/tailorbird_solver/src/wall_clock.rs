//! Measurement of time.

use std::time::Duration;

#[expect(
    clippy::disallowed_types,
    reason = "Bevy's name for the standard type, but in browsers, where that panics"
)]
type Moment = bevy_platform::time::Instant;

/// A stopwatch, in browsers as well. It is the only code that asks the clock of the machine: nothing that is simulated may.
#[derive(Clone, Copy, Debug)]
pub struct WallClock(Moment);

impl WallClock {
    /// Starts now.
    pub fn start() -> Self {
        Self(Moment::now())
    }

    /// The time since the start.
    pub fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }
}
