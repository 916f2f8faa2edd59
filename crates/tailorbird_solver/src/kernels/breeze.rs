//! Air whose velocity differs from place to place.

use std::ops::Range;

use bevy_math::{Isometry3d, Mat3, Vec3};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, SharedPoints, V3, each_window};
use crate::{
    points::Points,
    wind::{WAVES, Wave, WindRegion},
};

/// A wind in a part of the world, with its eddies, in the axes of a cloth's frame.
#[derive(Clone, Copy, Debug)]
pub struct Breeze {
    /// Mean velocity [m/s].
    pub velocity: Vec3,
    /// Its eddies, where it has any.
    pub waves: Option<[Wave; WAVES]>,
    pub shape: WindRegion,
    /// Width of the border over which the wind rises \[m\].
    pub falloff: f32,
    /// From the frame's axes to those of the shape.
    pub to_own: Isometry3d,
}

/// Adds the displacement of the air in `seconds` to the points `out` of a range of particles.
///
/// # Panics
/// When the number of points differs from that of particles, or the range is not within.
pub fn add(
    level: Level,
    breeze: &Breeze,
    seconds: f32,
    position: &Points,
    out: SharedPoints,
    range: Range<usize>,
) {
    assert!(
        range.end <= position.len() && out.is_of(position.len()),
        "one of each for {} particles",
        position.len()
    );
    dispatch!(level, simd => add_to(simd, breeze, seconds, position, out, range));
}

#[inline(always)]
fn add_to<S: Simd>(
    simd: S,
    breeze: &Breeze,
    seconds: f32,
    position: &Points,
    out: SharedPoints,
    range: Range<usize>,
) {
    let seconds = S::f32s::splat(simd, seconds);
    let mean = V3::splat(simd, breeze.velocity);
    each_window(
        simd,
        range,
        #[inline(always)]
        |window| {
            let p: V3<S> = position.window(simd, window, 0);
            let mut velocity = mean;
            for wave in breeze.waves.iter().flatten() {
                let turns = V3::splat(simd, wave.turns).dot(p) + S::f32s::splat(simd, wave.phase);
                velocity = velocity + Factor(sine(simd, turns)) * V3::splat(simd, wave.amplitude);
            }
            let displacement = Factor(seconds * strength(simd, breeze, p)) * velocity;
            let before = out.load_at(simd, window, 0);
            out.store_at(simd, window, 0, before + displacement);
        },
    );
}

/// [`crate::wind::sine`].
#[inline(always)]
fn sine<S: Simd>(simd: S, turns: S::f32s) -> S::f32s {
    let [half, eight, sixteen, a, b] = [0.5, 8.0, 16.0, 0.775, 0.225].map(
        #[inline(always)]
        |v| S::f32s::splat(simd, v),
    );
    let t = turns - (turns + half).floor();
    let s = eight * t - sixteen * t * t.abs();
    s * (a + b * s.abs())
}

/// Strength of the wind at a place: 0 to 1.
#[inline(always)]
fn strength<S: Simd>(simd: S, breeze: &Breeze, p: V3<S>) -> S::f32s {
    let [zero, one] = [S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0)];
    let depth = match breeze.shape {
        WindRegion::Everywhere => return one,
        WindRegion::Cuboid { half_size } => {
            let (q, half) = (own(simd, breeze, p), V3::<S>::splat(simd, half_size));
            let y = half.y - q.y.abs();
            (half.x - q.x.abs()).min(y).min(half.z - q.z.abs())
        }
        WindRegion::Sphere { radius } => {
            let q = own(simd, breeze, p);
            S::f32s::splat(simd, radius) - q.dot(q).sqrt()
        }
    };
    if breeze.falloff > 0.0 {
        let t = depth / S::f32s::splat(simd, breeze.falloff);
        let t = t.max(zero).min(one);
        t * t * (S::f32s::splat(simd, 3.0) - t - t)
    } else {
        depth.simd_ge(zero).select(one, zero)
    }
}

/// Place in the axes of the shape.
#[inline(always)]
fn own<S: Simd>(simd: S, breeze: &Breeze, p: V3<S>) -> V3<S> {
    let rotation = Mat3::from_quat(breeze.to_own.rotation);
    V3 {
        x: V3::splat(simd, rotation.row(0)).dot(p),
        y: V3::splat(simd, rotation.row(1)).dot(p),
        z: V3::splat(simd, rotation.row(2)).dot(p),
    } + V3::splat(simd, breeze.to_own.translation.into())
}

#[cfg(test)]
mod tests {
    use bevy_math::Quat;

    use super::*;
    use crate::{
        kernels::lanes::levels,
        topology::test_meshes::random,
        wind::{self, ClothTurbulence},
    };

    #[test]
    fn a_sine_is_one_to_a_thousandth() {
        for k in -500..500 {
            let turns = 0.01 * k as f32 + 0.003;
            let exact = (std::f32::consts::TAU * turns).sin();
            let error = (wind::sine(turns) - exact).abs();
            assert!(error < 1.2e-3, "{error} at {turns} turns");
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits_however_it_is_cut() {
        let point = |i| Vec3::new(random(i, 1), random(i, 2), random(i, 3)) * 4.0 - 2.0;
        let position: Points = (0..101).map(point).collect();
        let shapes = [
            WindRegion::Everywhere,
            WindRegion::Cuboid {
                half_size: Vec3::new(1.0, 0.7, 1.5),
            },
            WindRegion::Sphere { radius: 1.2 },
        ];
        let turbulence = ClothTurbulence {
            speed: 2.0,
            ..ClothTurbulence::default()
        };
        for shape in shapes {
            for falloff in [0.0, 0.4] {
                let breeze = Breeze {
                    velocity: Vec3::new(1.0, -2.0, 3.0),
                    waves: Some(turbulence.waves(1.5, bevy_math::DVec3::X)),
                    shape,
                    falloff,
                    to_own: Isometry3d::new(Vec3::X * 0.3, Quat::from_rotation_y(0.4)),
                };
                let run = |level: Level, cuts: &[usize]| {
                    let mut out = position.clone();
                    for ends in cuts.windows(2) {
                        let points = SharedPoints::new(&mut out);
                        add(level, &breeze, 0.01, &position, points, ends[0]..ends[1]);
                    }
                    out
                };
                let expected = run(levels()[0], &[0, 101]);
                for level in levels() {
                    assert_eq!(run(level, &[0, 101]), expected);
                    assert_eq!(run(level, &[0, 33, 40, 101]), expected);
                }
            }
        }
    }
}
