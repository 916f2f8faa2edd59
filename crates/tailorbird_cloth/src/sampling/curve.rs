//! The path between the places that were seen: without kinks, where there were none.

use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;

use super::clock::Moment;

/// Number of places that a curve goes by.
pub(super) const PLACES: usize = 4;

/// A point of the curve through the last two of four values, at a part of the path between them.
///
/// A cubic (Hermite) whose slopes at both ends are those of the parabolas through these ends and the two values before, so that nothing
/// after them need be known, and that one piece begins as the one before ended: straight lines would jolt cloth at each frame. A slope is
/// no more than twice that of the chord, nor three times that of the chord that follows, so that what stops stands still (Fritsch and Carlson
/// 1980). `gaps` is how much time is between the four \[s\].
fn cubic(values: [Vec3; PLACES], [before, last, gap]: [f32; 3], part: f32) -> Vec3 {
    let [first, second, from, to] = values;
    let chord = to - from;
    if chord == Vec3::ZERO || gap <= 0.0 {
        return from;
    }
    // Displacements within the gap.
    let slope = |displacement: Vec3, time: f32| {
        if time > 0.0 {
            displacement * (gap / time)
        } else {
            Vec3::ZERO
        }
    };
    let (d0, d1) = (slope(second - first, before), slope(from - second, last));
    let at_end = |d: Vec3, d_before: Vec3, time: f32, time_before: f32| {
        let bend = (d - d_before) * (time / (time + time_before).max(f32::MIN_POSITIVE));
        d + bend.clamp_length_max(d.length())
    };
    let start = at_end(d1, d0, last, before).clamp_length_max(3.0 * chord.length());
    let end = at_end(chord, d1, gap, last);
    let (u, v) = (part, 1.0 - part);
    from + chord * (u * u * (3.0 - 2.0 * u)) + start * (u * v * v) - end * (u * u * v)
}

/// Place at a moment, on the curve by these places, the last one first.
pub(super) fn between(frames: &[Transform], moment: &Moment) -> Transform {
    let [first, second, from, to] = moment.frames.map(|k| &frames[k]);
    if moment.part <= 0.0 || from == to {
        return *from;
    }
    let at = |value: fn(&Transform) -> Vec3| {
        let values = [first, second, from, to].map(value);
        cubic(values, moment.gaps, moment.part)
    };
    Transform {
        translation: at(|place| place.translation),
        rotation: turned(
            [first, second, from, to].map(|place| place.rotation),
            moment,
        ),
        scale: at(|place| place.scale),
    }
}

fn turned(rotations: [Quat; PLACES], moment: &Moment) -> Quat {
    let from = rotations[2];
    if from == rotations[3] {
        return from;
    }
    let back = from.inverse();
    let relative = |rotation: Quat| {
        let turn = back * rotation;
        let shortest = if turn.w < 0.0 { -turn } else { turn };
        shortest.to_scaled_axis()
    };
    let turn = cubic(rotations.map(relative), moment.gaps, moment.part);
    (from * Quat::from_scaled_axis(turn)).normalize()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A fall is sampled exactly.
        #[test]
        fn parabolas_are_exact(gaps in [0.005f32..0.04, 0.005f32..0.04, 0.005f32..0.04], part in 0.0f32..1.0) {
            let fall = |t: f32| Vec3::new(2.0 * t, 3.0 * t - 4.9 * t * t, 0.0);
            let t = [0.0, gaps[0], gaps[0] + gaps[1], gaps[0] + gaps[1] + gaps[2]];
            let is = cubic(t.map(fall), gaps, part);
            prop_assert!(is.distance(fall(t[2] + part * gaps[2])) < 1e-6);
        }

        /// One piece goes on as fast as the last one ended, where nothing comes near to standing still.
        #[test]
        fn there_are_no_kinks(x in proptest::collection::vec(1.0f32..1.5, 5), gaps in [0.01f32..0.015, 0.01f32..0.015, 0.01f32..0.015, 0.01f32..0.015]) {
            let mut sum = 0.0;
            let places: Vec<Vec3> = x.iter().map(|x| { sum += x; Vec3::X * sum }).collect();
            let at = |k: usize, part| {
                let four = [places[k], places[k + 1], places[k + 2], places[k + 3]];
                cubic(four, [gaps[k], gaps[k + 1], gaps[k + 2]], part).x
            };
            let small = 1e-3;
            let before = (at(0, 1.0) - at(0, 1.0 - small)) / (small * gaps[2]);
            let after = (at(1, small) - at(1, 0.0)) / (small * gaps[3]);
            prop_assert!((before - after).abs() < 0.05 * before.abs() + 1.0, "{before} {after}");
        }
    }

    #[test]
    fn what_stops_stands_still() {
        let gaps = [0.03; 3];
        let stopped = [0.0, 0.1, 0.2, 0.2].map(|x| Vec3::X * x);
        for part in [0.1, 0.5, 0.9] {
            assert_eq!(cubic(stopped, gaps, part), stopped[3]);
        }
    }
}
