//! Times of frames and steps.

use std::time::Duration;

use bevy_ecs::prelude::*;

/// Number of past frames for which places are known.
pub(crate) const DEPTH: usize = 8;

/// Over how many frames the longest one is looked for.
const RECENT: usize = 32;

/// A frame that takes longer \[ns\], and three times as long as the one before, is a hitch.
const HITCH: i64 = 100_000_000;

/// The frames so far, and the moment that is sampled in the step in progress. In nanoseconds of `Time<Virtual>`, as frames that are
/// equally long must give equal fractions.
#[derive(Resource, Clone, Debug, Default)]
pub struct ClothFrameClock {
    /// Times of the last places, the last frame first.
    times: [i64; DEPTH],
    known: usize,
    /// The lengths of the last frames, those left out that are longer than a hitch.
    lengths: [i64; RECENT],
    /// The length of the last frame.
    length: i64,
    hitch: bool,
    /// True if a new frame takes the place of the last one.
    pub(super) replaces: bool,
    /// The last frame and the one in progress.
    span: [i64; 2],
    /// Delay of sampling at both ends of that.
    delay: [i64; 2],
    pub(super) kind: FrameKind,
    /// Number of frames that have begun.
    pub(super) frame: u64,
    /// Number of frames that were seen at a time of their own.
    seen: u64,
    /// Number of steps that have been sampled.
    pub(super) step: u64,
    /// True while the fixed loop is running.
    pub(super) looping: bool,
    /// Moment that is sampled in the step in progress.
    pub(super) moment: Moment,
}

/// Event between the places of the last two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum FrameKind {
    /// No place is known before.
    #[default]
    First,
    /// No time has passed at all yet: it is where it begins, whoever puts it there last.
    Start,
    /// Time stood still.
    Still,
    /// A pause so long that nobody saw what happened.
    Hitch,
    /// Seconds between the two.
    Passed(f32),
}

/// A moment between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moment {
    /// Ages of the two frames, in frames, after two more before them.
    pub frames: [usize; 4],
    /// The times between the four \[s\].
    pub gaps: [f32; 3],
    /// The part of the time between the last two, 0 to 1.
    pub part: f32,
}

fn nanoseconds(time: Duration) -> i64 {
    i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
}

impl ClothFrameClock {
    /// Event between the places of the last two frames.
    pub(crate) fn kind(&self) -> FrameKind {
        self.kind
    }

    /// Number of frames that have begun.
    pub(crate) fn frame(&self) -> u64 {
        self.frame
    }

    /// The number of the last frame, those left out at whose start no time had passed.
    pub(crate) fn seen(&self) -> u64 {
        self.seen
    }

    /// Returns whether the fixed loop is running.
    pub(crate) fn is_looping(&self) -> bool {
        self.looping
    }

    /// Moment that is sampled in the step in progress.
    pub(crate) fn moment(&self) -> Moment {
        self.moment
    }

    /// Begins a frame that ends at `elapsed` and lasts `delta`. What is seen now was put there at its beginning.
    pub(super) fn begin_frame(&mut self, elapsed: Duration, delta: Duration) {
        let (end, length) = (nanoseconds(elapsed), nanoseconds(delta));
        let start = end - length;
        self.frame += 1;
        let newest = self.times[0];
        let after_hitch = self.hitch;
        self.kind = if self.known == 0 || start < newest {
            *self = Self {
                frame: self.frame,
                step: self.step,
                seen: self.seen + 1,
                times: [start; DEPTH],
                known: 1,
                delay: [length; 2],
                ..Self::default()
            };
            FrameKind::First
        } else if start > newest {
            // What is denser than a quarter of the delay is not needed, but for what lies around the moment that is sampled.
            let ahead = self.times[1] >= start - self.delay[1];
            self.replaces = ahead && newest - self.times[1] < self.delay[1] / 4;
            if !self.replaces {
                self.times.rotate_right(1);
                self.seen += 1;
                self.known = (self.known + 1).min(DEPTH);
            }
            self.times[0] = start;
            if after_hitch {
                FrameKind::Hitch
            } else {
                FrameKind::Passed((start - newest) as f32 * 1e-9)
            }
        } else if start == 0 {
            FrameKind::Start
        } else {
            FrameKind::Still
        };
        self.span = [start, end];
        if length > 0 {
            self.hitch = length > HITCH && length > 3 * self.length;
            self.length = length;
            self.plan_delay(length, after_hitch);
        }
    }

    /// No later than it must be: the last frames must not end before the moment that is sampled, or things would stand still, and a
    /// delay that varied with them would make speeds vary.
    fn plan_delay(&mut self, length: i64, after_hitch: bool) {
        if length <= HITCH {
            self.lengths.rotate_right(1);
            self.lengths[0] = length;
        }
        let longest = self.lengths.iter().copied().max().unwrap_or(length);
        let from = if after_hitch { longest } else { self.delay[1] };
        // What is too much goes within a quarter of a second, by the exponential.
        let excess = i128::from((from - longest).max(0)) * i128::from(length) / 250_000_000;
        let less = (length / 10).max(excess as i64).min(length / 2);
        let mut to = length.max(longest).max(from - less);
        if self.known == DEPTH {
            to = to.min(self.span[1] - self.times[DEPTH - 1]);
        }
        self.delay = [from, to];
    }

    /// The moment that a step samples which ends at `time`.
    pub(super) fn moment_at(&self, time: Duration) -> Moment {
        let [start, end] = self.span;
        let [late, later] = self.delay;
        let (from, to) = (start - late, end - later);
        let passed = (nanoseconds(time) - start).clamp(0, (end - start).max(0));
        let elapsed = i128::from(to - from) * i128::from(passed) / i128::from((end - start).max(1));
        let moment = from + elapsed as i64;
        let known = &self.times[..self.known];
        let oldest = self.known.saturating_sub(1);
        let found = known.iter().position(|time| *time <= moment);
        let older = found.unwrap_or(oldest);
        let newer = if found.is_some() {
            older.saturating_sub(1)
        } else {
            older
        };
        let frames = [older + 2, older + 1, older, newer].map(|k| k.min(oldest));
        let seconds = |from: usize, to: usize| (self.times[to] - self.times[from]) as f32 * 1e-9;
        let gaps = [0, 1, 2].map(|k| seconds(frames[k], frames[k + 1]));
        let gap = self.times[newer] - self.times[older];
        let part = if gap > 0 {
            (moment - self.times[older]) as f32 / gap as f32
        } else {
            0.0
        };
        Moment { frames, gaps, part }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(nanoseconds: i64) -> Duration {
        Duration::from_nanos(nanoseconds as u64)
    }

    /// The time that a moment stands for \[ns\].
    fn time(clock: &ClothFrameClock, moment: Moment) -> f64 {
        let [_, _, older, newer] = moment.frames.map(|k| clock.times[k] as f64);
        older + f64::from(moment.part) * (newer - older)
    }

    #[test]
    fn a_step_at_the_end_of_each_frame_sees_things_as_they_are() {
        let mut clock = ClothFrameClock::default();
        for frame in 1..100 {
            clock.begin_frame(at(16_666_667 * frame), at(16_666_667));
            let moment = clock.moment_at(at(16_666_667 * frame));
            assert_eq!((moment.frames[2], moment.part), (0, 0.0));
        }
    }

    #[test]
    fn after_a_hitch_the_delay_is_what_it_was() {
        let mut clock = ClothFrameClock::default();
        let mut end = 0;
        for frame in 0..40 {
            let length = if frame == 20 { 250_000_000 } else { 16_000_000 };
            end += length;
            clock.begin_frame(at(end), at(length));
            assert_eq!(clock.kind == FrameKind::Hitch, frame == 21, "{frame}");
            if frame != 20 {
                assert_eq!(clock.delay[1], 16_000_000, "{frame}");
            }
        }
    }

    /// Loading a level makes several frames long.
    #[test]
    fn long_frames_do_not_delay_what_comes_after_them_for_long() {
        let mut clock = ClothFrameClock::default();
        let (mut end, mut since) = (0, 0);
        for frame in 0..200 {
            let length = [250, 180, 200, 150]
                .get(frame)
                .map_or(16_000_000, |ms| ms * 1_000_000);
            end += length;
            since += if frame < 4 { 0 } else { length };
            clock.begin_frame(at(end), at(length));
            if since > 1_000_000_000 {
                assert!(clock.delay[1] < 25_000_000, "{frame}: {}", clock.delay[1]);
            }
        }
    }

    proptest! {
        /// Whatever the frames do: never ahead of what is known, never back, and no faster than a tenth faster.
        #[test]
        fn what_is_sampled_passes_evenly(lengths in proptest::collection::vec(2_000_000i64..60_000_000, 3..60), hz in 30i64..240) {
            let mut clock = ClothFrameClock::default();
            let step = 1_000_000_000 / hz;
            let (mut end, mut next) = (0, step);
            let mut last: Option<f64> = None;
            for (k, length) in lengths.into_iter().enumerate() {
                end += length;
                clock.begin_frame(at(end), at(length));
                while next <= end {
                    let moment = clock.moment_at(at(next));
                    let now = time(&clock, moment);
                    prop_assert!(now <= clock.times[0] as f64 + 8.0);
                    if let Some(last) = last {
                        let advance = now - last;
                        prop_assert!(advance >= -8.0, "{advance}");
                        // Unless the frames become so short that the memory ends.
                        if k > DEPTH && clock.delay[1] < end - clock.times[DEPTH - 1] {
                            prop_assert!(advance <= 2.0 * step as f64 + 8.0, "{advance} {step}");
                        }
                    }
                    last = Some(now);
                    next += step;
                }
            }
        }

        #[test]
        fn frames_that_vary_a_little_are_sampled_at_their_own_speed(lengths in proptest::collection::vec(10_000_000i64..20_000_000, 60)) {
            let mut clock = ClothFrameClock::default();
            let step = 16_000_000;
            let (mut end, mut next) = (0, step);
            let mut last: Option<(f64, i64)> = None;
            // The longest one first, so that the delay is settled.
            for (k, length) in [20_000_000].into_iter().chain(lengths.into_iter().flat_map(|l| [l, 20_000_000])).enumerate() {
                end += length;
                clock.begin_frame(at(end), at(length));
                while next <= end {
                    let now = time(&clock, clock.moment_at(at(next)));
                    if let Some((last, then)) = last && k > 8 {
                        let rate = (now - last) / (next - then) as f64;
                        prop_assert!((rate - 1.0).abs() < 1e-5, "{k} {rate}");
                    }
                    last = Some((now, next));
                    next += step;
                }
            }
        }
    }
}
