//! Turbulence: eddies of many sizes that the wind carries along.

use std::f32::consts::PI;

use bevy_math::{DVec3, Vec3};
use bevy_reflect::prelude::*;

/// How air swirls: a velocity without divergence, with the spectrum of real turbulence (Kolmogorov's k^(−5/3)) from eddies of
/// [`scale`](Self::scale) to those of a sixteenth of it, carried along by the wind while they change.
///
/// It depends on the place, simulated time and the seed alone, and is smooth in both.
///
/// It is a sum of plane waves across their own direction (kinematic simulation: Kraichnan 1970, Fung et al. 1992).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct Turbulence {
    /// Root mean square of the speed that it adds [m/s]; 0 is none.
    pub speed: f32,
    /// Size of the largest eddies \[m\].
    pub scale: f32,
    /// Which of all possible ones.
    pub seed: u32,
}

impl Default for Turbulence {
    fn default() -> Self {
        Self {
            speed: 0.0,
            scale: 2.0,
            seed: 0,
        }
    }
}

/// How many waves turbulence is made of.
pub const WAVES: usize = 16;

/// The ratio of the largest eddies to the smallest.
const SIZES: f32 = 16.0;

/// A plane wave: velocity = amplitude · sin(2π (turns · p + phase)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Across `turns` [m/s].
    pub amplitude: Vec3,
    /// Its direction, times waves per length [1/m].
    pub turns: Vec3,
    /// At the origin, in turns: 0 to 1.
    pub phase: f32,
}

impl Turbulence {
    /// Whether there is any.
    pub fn is_some(&self) -> bool {
        self.speed > 0.0
    }

    /// Its waves at a time \[s\], when the wind has carried them so far \[m\].
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
            // An eddy turns over in about the time in which its own speed goes along it.
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

/// A sine of so many turns, to 0.1 % of its amplitude: two parabolas, and their squares to round them.
///
/// The same bits everywhere, which `sin` of the system does not give; and without divergence whatever its error, as each wave
/// is across its own direction.
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

    /// 0 to 1.
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Every direction alike.
    fn direction(&mut self) -> Vec3 {
        let up = 2.0 * self.unit() - 1.0;
        let around = (1.0 - up * up).max(0.0).sqrt();
        let angle = self.unit() * 2.0 * PI;
        Vec3::new(around * angle.cos(), up, around * angle.sin())
    }
}
