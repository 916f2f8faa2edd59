//! Moving air: one [`ClothWind`] in the whole world, and [`ClothWindZone`]s that add to it. Each has gusts, which vary in time, and
//! turbulence, which varies in space as well. Both depend on simulated time alone, so that they are the same at any frame rate.
//!
//! ![A curtain before a fan that turns to and fro](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/fan.gif)
//!
//! [`ClothWindState::velocity_at`] tells where the air goes, for what else is to move with it.
//!
//! Air that is the same everywhere in a cloth costs least. Turbulence is summed up for each particle once in a step (`bench -- kernels`:
//! `turbulence`), and so are zones whose border a cloth crosses.

use std::f32::consts::TAU;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

use crate::error::ClothErrorKind;

mod blowing;
mod zone;

pub use blowing::{ClothWindState, apply_wind, prepare_wind};
pub use tailorbird_solver::wind::ClothTurbulence;
pub use zone::{ClothWindShape, ClothWindZone};

/// The air around all cloths. Still air slows cloths as well: insert [`ClothWind::vacuum`] to have none.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothWind {
    /// Mean velocity of the air [m/s].
    pub velocity: Vec3,
    /// Variation in time.
    pub gusts: ClothGusts,
    /// Turbulence.
    pub turbulence: ClothTurbulence,
    /// Model of its push.
    pub model: ClothWindModel,
    /// Density of the air [kg/m³]: 1.225 at sea level and 15 °C.
    pub air_density: f32,
}

/// Variation of the wind in time. The same at every run: it depends on simulated time alone.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothGusts {
    /// Largest change of the wind's speed, as a fraction of its mean [-]; 0 is a steady wind.
    pub strength: f32,
    /// Time between gusts \[s\].
    pub period: f32,
}

/// Model of the wind's push on a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothWindModel {
    /// Drag and lift of a flat plate in the air that flows past it, `½ ρ A |u|² …`, with the coefficients of
    /// [`ClothMaterial`](crate::material::ClothMaterial). Takes the motion of the cloth into account: it cannot get faster than the wind.
    #[default]
    Aerodynamic,
    /// The classic force along the wind, `ŵ |w · n| A` with `n` the unit normal and 1 N s/m³, whatever the cloth's own
    /// motion: a pressure in proportion to the wind's speed. It can push a cloth beyond the wind's speed. Taken for the wind in
    /// the middle of the cloth.
    Classic,
}

impl Default for ClothWind {
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            gusts: ClothGusts::default(),
            turbulence: ClothTurbulence::default(),
            model: ClothWindModel::Aerodynamic,
            air_density: 1.225,
        }
    }
}

impl Default for ClothGusts {
    fn default() -> Self {
        Self {
            strength: 0.0,
            period: 3.0,
        }
    }
}

impl ClothWind {
    /// A steady wind [m/s].
    pub fn steady(velocity: Vec3) -> Self {
        Self {
            velocity,
            ..Self::default()
        }
    }

    /// No air.
    pub fn vacuum() -> Self {
        Self {
            air_density: 0.0,
            ..Self::default()
        }
    }

    /// The mean velocity of the air at a time \[s\], without turbulence, in world axes [m/s]: see [`ClothGusts::vary`].
    pub fn velocity_at(&self, seconds: f64) -> Vec3 {
        self.gusts.vary(self.velocity, seconds)
    }

    /// Errors of this wind.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let density = self.air_density;
        let checks = [
            ClothErrorKind::vector("ClothWind.velocity", self.velocity),
            ClothErrorKind::not_negative("ClothWind.air_density", density, "kg/m³"),
        ];
        let varies = variation_errors("ClothWind", &self.gusts, &self.turbulence);
        checks.into_iter().chain(varies).flatten().collect()
    }
}

impl ClothGusts {
    /// Mean velocity [m/s] after so many seconds of variation in time.
    ///
    /// A gust is a sum of sines whose periods have no common multiple. It changes the speed by at most
    /// [`strength`](Self::strength) and swings the direction by at most half of that (in radians), about the axis that is
    /// most upright.
    pub fn vary(&self, velocity: Vec3, seconds: f64) -> Vec3 {
        let Self { strength, period } = *self;
        if strength <= 0.0 || period.is_nan() || period <= 0.0 || velocity == Vec3::ZERO {
            return velocity;
        }
        let wave = |ratio: f64, phase: f64| {
            let cycles = seconds * ratio / f64::from(period) + phase;
            (cycles.fract() as f32 * TAU).sin()
        };
        let speed = 0.5 * wave(1.0, 0.0) + 0.3 * wave(2.713, 0.3) + 0.2 * wave(5.141, 0.7);
        let swing = 0.6 * wave(0.618, 0.1) + 0.4 * wave(1.902, 0.6);
        let aside = velocity.cross(Vec3::Y);
        let aside = if aside.length_squared() > 1e-6 * velocity.length_squared() {
            aside.normalize()
        } else {
            Vec3::X
        };
        let (sin, cos) = (0.5 * strength * swing).sin_cos();
        let turned = velocity * cos + aside * (velocity.length() * sin);
        turned * (1.0 + strength * speed).max(0.0)
    }
}

/// Errors of the gusts and the turbulence of a wind.
fn variation_errors(
    of: &str,
    gusts: &ClothGusts,
    turbulence: &ClothTurbulence,
) -> [Option<ClothErrorKind>; 4] {
    let (positive, not_negative) = (ClothErrorKind::positive, ClothErrorKind::not_negative);
    [
        not_negative(format_args!("{of}.gusts.strength"), gusts.strength, "-"),
        positive(format_args!("{of}.gusts.period"), gusts.period, "s"),
        not_negative(
            format_args!("{of}.turbulence.speed"),
            turbulence.speed,
            "m/s",
        ),
        positive(format_args!("{of}.turbulence.scale"), turbulence.scale, "m"),
    ]
}
