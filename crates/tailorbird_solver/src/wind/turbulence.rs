//! Turbulence: eddies of many sizes that the wind carries along.

use std::f32::consts::PI;

use bevy_math::{DVec3, Vec3};
use bevy_reflect::prelude::*;

/// Swirling air: a velocity without divergence, with the spectrum of real turbulence (Kolmogorov's k^(−5/3)) from eddies of
/// [`scale`](Self::scale) to those of a sixteenth of it, carried along by the wind while they change.
///
/// It depends on the place, simulated time and the seed alone, and is smooth in the first two.
///
/// It is a sum of plane waves across their own direction (kinematic simulation: Kraichnan 1970, Fung et al. 1992).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothTurbulence {
    /// Root mean square of the speed that it adds [m/s]; 0 is none.
    pub speed: f32,
    /// Size of the largest eddies \[m\].
    pub scale: f32,
    /// Seed of its random waves.
    pub seed: u32,
}

impl Default for ClothTurbulence {
    fn default() -> Self {
        Self {
            speed: 0.0,
            scale: 2.0,
            seed: 0,
        }
    }
}

/// Number of waves that make up the turbulence.
pub const WAVES: usize = 16;

/// Ratio of the largest eddies to the smallest.
const SIZES: f32 = 16.0;

/// A plane wave: velocity = amplitude · sin(2π (turns · p + phase)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Amplitude, across `turns` [m/s].
    pub amplitude: Vec3,
    /// Direction, times waves per length [1/m].
    pub turns: Vec3,
    /// Phase at the origin, in turns: 0 to 1.
    pub phase: f32,
}

impl ClothTurbulence {
    /// Returns whether there is any.
    pub fn is_some(&self) -> bool {
        self.speed > 0.0
    }

    /// Waves at a time \[s\], after the wind has carried them by `drift` \[m\].
    pub fn waves(&self, seconds: f64, drift: DVec3) -> [Wave; WAVES] {
        let mut random = Random::new(self.seed);
        let mut waves = [Wave::default(); WAVES];
        let mut sum = 0.0;
        for (n, wave) in waves.iter_mut().enumerate() {
            let k = SIZES.powf(n as f32 / (WAVES - 1) as f32) / self.scale;
            let along = random.direction();
            let across = along.any_orthonormal_vector();
            let angle = random.unit() * 2.0 * PI;
            let across = across * angle.cos() + along.cross(across) * angle.sin();
            // With wave numbers in geometric sequence each stands for a band as wide as itself: u² ~ E(k) k ~ k^(−2/3).
            let size = (k * self.scale).powf(-1.0 / 3.0);
            sum += 0.5 * size * size;
            let start = random.unit();
            // An eddy turns over in about the time that its own speed takes to cross it.
            let rate = f64::from(0.5 * k * size * self.speed);
            let turns = along * k;
            let phase = f64::from(start) - turns.as_dvec3().dot(drift) - rate * seconds;
            *wave = Wave {
                amplitude: across * size,
                turns,
                phase: phase.rem_euclid(1.0) as f32,
            };
        }
        let all = self.speed / f32::sqrt(sum);
        for wave in &mut waves {
            wave.amplitude *= all;
        }
        waves
    }
}

/// Sine of so many turns, to 0.1 % of its amplitude: two parabolas, and their squares to round them.
///
/// It has the same bits everywhere, unlike `sin` of the system; and is without divergence whatever its error, as each wave is across its
/// own direction.
pub fn sine(turns: f32) -> f32 {
    let t = turns - (turns + 0.5).floor();
    let s = 8.0 * t - 16.0 * t * t.abs();
    s * (0.775 + 0.225 * s.abs())
}

/// Random numbers that depend on the seed alone (`SplitMix64`).
struct Random(u64);

impl Random {
    fn new(seed: u32) -> Self {
        Self(u64::from(seed))
    }

    /// Random number from 0 to 1.
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Random direction, all alike.
    fn direction(&mut self) -> Vec3 {
        let up = 2.0 * self.unit() - 1.0;
        let around = (1.0 - up * up).max(0.0).sqrt();
        let angle = self.unit() * 2.0 * PI;
        Vec3::new(around * angle.cos(), up, around * angle.sin())
    }
}
