//! Moving air.

use std::f32::consts::TAU;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tracing::error;

use crate::{
    cloth::Cloth,
    crew::Crew,
    error::ClothErrorKind,
    particles::ClothParticles,
    solver::kernels::{
        aerodynamics::{self, Air, AirSheet},
        lanes::SharedPoints,
    },
    stages::{ClothStages, ClothStagesItem, for_each_awake},
    step::ClothStep,
};

/// The air around all cloths. Still air slows cloths as well: insert [`Wind::vacuum`] to have none.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct Wind {
    /// Mean velocity of the air [m/s].
    pub velocity: Vec3,
    /// How it varies.
    pub gusts: Gusts,
    /// How it pushes.
    pub model: WindModel,
    /// Density of the air [kg/m³]: 1.225 at sea level and 15 °C.
    pub air_density: f32,
}

/// How the wind varies in time. The same at every run: it depends on simulated time alone.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct Gusts {
    /// Largest change of the wind's speed, as a fraction of its mean [-]; 0 is a steady wind.
    pub strength: f32,
    /// Time between gusts \[s\].
    pub period: f32,
}

/// How the wind pushes on a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
pub enum WindModel {
    /// Drag and lift of a flat plate in the air that flows past it, `½ ρ A |u|² …`, with the coefficients of
    /// [`ClothMaterial`](crate::material::ClothMaterial). Takes the motion of the cloth into account: it cannot get faster than the wind.
    #[default]
    Aerodynamic,
    /// The classic force along the wind, `ŵ |w · n| A` with `n` the unit normal and 1 N s/m³, whatever the cloth's own
    /// motion: a pressure in proportion to the wind's speed. It can push a cloth beyond the wind's speed.
    Classic,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            gusts: Gusts::default(),
            model: WindModel::Aerodynamic,
            air_density: 1.225,
        }
    }
}

impl Default for Gusts {
    fn default() -> Self {
        Self {
            strength: 0.0,
            period: 3.0,
        }
    }
}

impl Wind {
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

    /// The velocity of the air at a time \[s\], in world axes [m/s].
    ///
    /// A gust is a sum of sines whose periods have no common multiple. It changes the speed by at most
    /// [`Gusts::strength`] and swings the direction by at most half of that (in radians), about the axis that is
    /// most upright.
    pub fn velocity_at(&self, seconds: f64) -> Vec3 {
        let Gusts { strength, period } = self.gusts;
        if strength <= 0.0 || period.is_nan() || period <= 0.0 || self.velocity == Vec3::ZERO {
            return self.velocity;
        }
        let wave = |ratio: f64, phase: f64| {
            let cycles = seconds * ratio / f64::from(period) + phase;
            (cycles.fract() as f32 * TAU).sin()
        };
        let speed = 0.5 * wave(1.0, 0.0) + 0.3 * wave(2.713, 0.3) + 0.2 * wave(5.141, 0.7);
        let swing = 0.6 * wave(0.618, 0.1) + 0.4 * wave(1.902, 0.6);
        let aside = self.velocity.cross(Vec3::Y);
        let aside = if aside.length_squared() > 1e-6 * self.velocity.length_squared() {
            aside.normalize()
        } else {
            Vec3::X
        };
        let (sin, cos) = (0.5 * strength * swing).sin_cos();
        let turned = self.velocity * cos + aside * (self.velocity.length() * sin);
        turned * (1.0 + strength * speed).max(0.0)
    }

    /// What is wrong with this wind.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let not_negative = |v: f32| v >= 0.0 && v.is_finite();
        [
            ClothErrorKind::vector("Wind.velocity", self.velocity),
            ClothErrorKind::number(
                "Wind.gusts.strength",
                self.gusts.strength,
                not_negative,
                "at least 0 and finite [-]",
            ),
            ClothErrorKind::number(
                "Wind.gusts.period",
                self.gusts.period,
                |v| v > 0.0 && v.is_finite(),
                "above 0 and finite [s]",
            ),
            ClothErrorKind::number(
                "Wind.air_density",
                self.air_density,
                not_negative,
                "at least 0 and finite [kg/m³]",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// The wind in force during this step. Written by [`prepare_wind`] alone.
#[derive(Resource, Clone, Debug, Default)]
pub struct BlowingWind {
    /// The last valid one.
    valid: Wind,
    /// In world axes [m/s].
    velocity: Vec3,
}

/// Reads how the wind blows in this step.
///
/// An invalid wind is logged once, and the last valid one blows on.
pub fn prepare_wind(step: Res<ClothStep>, wind: Res<Wind>, mut blowing: ResMut<BlowingWind>) {
    if wind.is_changed() {
        let errors = wind.errors();
        for kind in &errors {
            error!("{kind}; the last valid wind blows on");
        }
        if errors.is_empty() {
            blowing.valid.clone_from(&wind);
        }
    }
    blowing.velocity = blowing.valid.velocity_at(step.elapsed());
}

/// Adds the acceleration by the wind, once per step.
pub fn apply_wind(
    step: Res<ClothStep>,
    wind: Res<BlowingWind>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        wind.blow(&step, Crew::ALONE, &mut cloth);
    });
}

impl BlowingWind {
    /// What tells this wind from another: velocity, model and density of the air.
    pub(crate) fn kind(&self) -> (Vec3, WindModel, f32) {
        (self.velocity, self.valid.model, self.valid.air_density)
    }

    /// What [`apply_wind`] does to one cloth.
    pub(crate) fn blow(&self, step: &ClothStep, crew: Crew, cloth: &mut ClothStagesItem) {
        let (velocity, model, density) = self.kind();
        let nothing = match model {
            WindModel::Aerodynamic => density == 0.0,
            WindModel::Classic => velocity == Vec3::ZERO,
        };
        let (topology, material) = (cloth.topology, cloth.material);
        if nothing || cloth.particles.is_empty() || !material.errors().is_empty() {
            return;
        }
        let wind = cloth.frame.vector_to_frame(velocity);
        cloth.particles.accelerations();
        let ClothParticles {
            position,
            previous_position,
            acceleration,
            inv_mass,
            substep_seconds,
            ..
        } = &mut *cloth.particles;
        let air = Air {
            wind,
            density,
            areal_density: material.areal_density,
            drag: material.drag,
            lift: material.lift,
            seconds: step.seconds(),
        };
        let per_second = if *substep_seconds > 0.0 {
            substep_seconds.recip()
        } else {
            0.0
        };
        // The cells of a mesh are cut in its own way.
        if let (Some(lattice), Some(_)) = (&topology.lattice, topology.grid) {
            let sheet = AirSheet {
                lattice,
                position,
                previous: previous_position,
                inv_mass,
                acceleration: SharedPoints::new(acceleration),
            };
            let level = step.level();
            crew.share(0..lattice.rows as usize, |rows| match model {
                WindModel::Classic => aerodynamics::classic_on_sheet(level, sheet, wind, rows),
                WindModel::Aerodynamic => {
                    aerodynamics::drag_and_lift_on_sheet(level, sheet, air, per_second, rows);
                }
            });
            return;
        }
        let triangles = &topology.triangles;
        match model {
            WindModel::Classic => {
                aerodynamics::classic(triangles, wind, position, inv_mass, acceleration);
            }
            WindModel::Aerodynamic => {
                aerodynamics::drag_and_lift(
                    triangles,
                    &topology.triangle_areas,
                    air,
                    position,
                    previous_position,
                    per_second,
                    inv_mass,
                    acceleration,
                );
            }
        }
    }
}
