//! The air during a step: what blows, and what it does to cloths.

use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Isometry3d, Vec3};
use tailorbird_solver::{
    fingerprint,
    kernels::{
        aerodynamics::{self, Air, AirSheet},
        breeze::{self, Breeze},
        lanes::SharedPoints,
    },
    particles::Particles,
    points::Points,
    wind::{WAVES, Wave, WindRegion, sine, strength},
    workers::Workers,
};
use tracing::error;

use super::{ClothTurbulence, ClothWind, ClothWindModel, ClothWindZone, zone::is_whole_in};
use crate::{
    bounds::ClothBounds,
    error::{ClothErrorSource, ClothStatusOf},
    frame::{ClothFrame, split},
    sampling::ClothSampledPoses,
    stages::{ClothStagesItem, StagedCloths},
    step::ClothStep,
};

/// The air in this step: the [`ClothWind`] and all [`ClothWindZone`]s. Written by [`prepare_wind`] alone.
#[derive(Resource, Clone, Debug, Default)]
pub struct ClothWindState {
    /// The last valid one.
    valid: ClothWind,
    /// First the wind, then the zones in the order of their entities.
    sources: Vec<Source>,
}

/// A wind or a zone that blows in this step.
#[derive(Clone, Debug)]
struct Source {
    /// The zone's.
    entity: Option<Entity>,
    shape: WindRegion,
    falloff: f32,
    /// Pose in the world.
    at: Isometry3d,
    /// Velocity in world axes [m/s].
    velocity: Vec3,
    turbulence: ClothTurbulence,
    /// Waves of its turbulence, in its own axes; amplitudes are 0 without any.
    waves: [Wave; WAVES],
    /// Displacement of its eddies, in its own axes \[m\].
    drift: DVec3,
}

impl Source {
    fn new(entity: Option<Entity>) -> Self {
        Self {
            entity,
            shape: WindRegion::Everywhere,
            falloff: 0.0,
            at: Isometry3d::IDENTITY,
            velocity: Vec3::ZERO,
            turbulence: ClothTurbulence::default(),
            waves: [Wave::default(); WAVES],
            drift: DVec3::ZERO,
        }
    }

    fn swirl(&mut self, turbulence: ClothTurbulence, mean: Vec3, step: &ClothStep) {
        self.turbulence = turbulence;
        if turbulence.is_some() {
            self.waves = turbulence.waves(step.elapsed(), self.drift);
        }
        self.drift += mean.as_dvec3() * f64::from(step.seconds());
    }

    /// The velocity at a place in the world, in world axes [m/s].
    fn velocity_at(&self, point: Vec3) -> Vec3 {
        let local = self.at.inverse() * point;
        let strength = strength(self.shape.depth(local), self.falloff);
        if strength == 0.0 {
            return Vec3::ZERO;
        }
        let mut swirl = Vec3::ZERO;
        if self.turbulence.is_some() {
            for wave in &self.waves {
                swirl += wave.amplitude * sine(wave.turns.dot(local) + wave.phase);
            }
        }
        strength * (self.velocity + self.at.rotation * swirl)
    }

    /// Bits of all that a cloth feels of it.
    fn bits(&self) -> impl Iterator<Item = u32> {
        let size = match self.shape {
            WindRegion::Everywhere => Vec3::ZERO,
            WindRegion::Cuboid { half_size } => half_size,
            WindRegion::Sphere { radius } => Vec3::splat(-radius),
        };
        let ClothTurbulence { speed, scale, seed } = self.turbulence;
        let waves = self.waves.iter().filter(|_| self.turbulence.is_some());
        let vectors = [self.velocity, self.at.translation.into(), size];
        let numbers = (vectors.into_iter().flat_map(|v| v.to_array()))
            .chain(self.at.rotation.to_array())
            .chain([self.falloff, speed, scale])
            .chain(waves.map(|wave| wave.phase));
        numbers.map(f32::to_bits).chain([seed])
    }
}

/// Reads how the wind blows in this step.
///
/// An invalid wind is logged once, and the last valid one blows on. A zone that is wrong, or whose transform is not finite, is reported and does
/// not blow.
pub fn prepare_wind(
    step: Res<ClothStep>,
    wind: Res<ClothWind>,
    poses: ClothSampledPoses,
    mut blowing: ResMut<ClothWindState>,
    mut zones: Query<(Ref<ClothWindZone>, ClothStatusOf)>,
    commands: ParallelCommands,
) {
    if wind.is_changed() {
        let errors = wind.errors();
        for kind in &errors {
            error!("{kind}; the last valid wind blows on");
        }
        if errors.is_empty() {
            blowing.valid.clone_from(&wind);
        }
    }
    let ClothWindState { valid, sources } = &mut *blowing;
    if sources.is_empty() {
        sources.push(Source::new(None));
    }
    sources[0].velocity = valid.velocity_at(step.elapsed());
    sources[0].swirl(valid.turbulence, valid.velocity, &step);
    let mut blows = 1;
    for (zone, mut status) in &mut zones {
        let entity = status.entity;
        if zone.is_changed() {
            let errors = zone.errors();
            status.update(&commands, ClothErrorSource::ClothWind, errors);
        }
        let Ok(place) = poses.get(entity).map(|pose| split(&pose.end)) else {
            continue;
        };
        let error = place.as_ref().err().cloned();
        status.update(&commands, ClothErrorSource::Transform, error);
        let Ok((at, scale)) = place else { continue };
        if !status.list.is_ok_for(ClothErrorSource::ClothWind) {
            continue;
        }
        let known = sources[blows..]
            .iter()
            .position(|source| source.entity == Some(entity));
        let index = known.map_or(sources.len(), |k| blows + k);
        if known.is_none() {
            sources.push(Source::new(Some(entity)));
        }
        sources.swap(blows, index);
        let source = &mut sources[blows];
        let gusty = zone.gusts.vary(zone.velocity, step.elapsed());
        source.shape = zone.shape.region(scale);
        source.falloff = zone.falloff;
        source.at = at;
        source.velocity = at.rotation * gusty;
        source.swirl(zone.turbulence, zone.velocity, &step);
        blows += 1;
    }
    sources.truncate(blows);
    sources.sort_unstable_by_key(|source| source.entity);
}

/// Adds the acceleration by the wind, once per step.
pub fn apply_wind(mut cloths: StagedCloths, wind: Res<ClothWindState>) {
    cloths.for_each_awake(&|mut cloth, step, _| wind.blow(step, Workers::ALONE, &mut cloth));
}

/// The ball around a cloth's box: middle and radius in the world \[m\].
fn ball(frame: &ClothFrame, bounds: &ClothBounds) -> (Vec3, f32) {
    let middle = 0.5 * (bounds.min + bounds.max);
    (frame.to_world(middle), bounds.max.distance(middle))
}

impl ClothWindState {
    /// The velocity of the air at a place in the world, in world axes [m/s]: for whatever else the wind moves.
    pub fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.sources
            .iter()
            .map(|source| source.velocity_at(point))
            .sum()
    }

    /// The sources that reach a ball in the world, and whether they do so in the same way everywhere in it.
    fn reaching(&self, ball: (Vec3, f32)) -> impl Iterator<Item = (&Source, bool)> {
        self.sources.iter().filter_map(move |source| {
            let whole = is_whole_in(source.shape, source.falloff, source.at, ball)?;
            Some((source, whole))
        })
    }

    /// Number that tells the air around a cloth from another.
    pub(crate) fn kind(&self, frame: &ClothFrame, bounds: &ClothBounds) -> u64 {
        let air = [self.valid.model as u32, self.valid.air_density.to_bits()];
        let sources = self.reaching(ball(frame, bounds));
        let sources = sources.flat_map(|(source, _)| source.bits());
        fingerprint::of(air.into_iter().chain(sources))
    }

    /// Runs [`apply_wind`] for one cloth.
    pub(crate) fn blow(&self, step: &ClothStep, workers: Workers, cloth: &mut ClothStagesItem) {
        let (model, density) = (self.valid.model, self.valid.air_density);
        let (topology, material, frame) = (cloth.topology, cloth.material, &*cloth.frame);
        if cloth.particles.is_empty() || !material.errors().is_empty() {
            return;
        }
        if density == 0.0 && model == ClothWindModel::Aerodynamic {
            return;
        }
        let ball = ball(frame, &cloth.bounds);
        let mut velocity = Vec3::ZERO;
        let mut varies = false;
        for (source, whole) in self.reaching(ball) {
            cloth.particles.0.state.effort.driven +=
                source.velocity.length() + source.turbulence.speed;
            if whole && !source.turbulence.is_some() {
                velocity += source.velocity;
            } else {
                varies = true;
            }
        }
        if model == ClothWindModel::Classic {
            velocity = self.velocity_at(ball.0);
            varies = false;
            if velocity == Vec3::ZERO {
                return;
            }
        }
        let level = step.level();
        let wind = frame.vector_to_frame(velocity);
        cloth.particles.0.accelerations();
        let Particles {
            state,
            input,
            scratch,
            ..
        } = &mut cloth.particles.0;
        let (position, inv_mass) = (&state.position, &input.inv_mass);
        let acceleration = &mut input.acceleration;
        let mut per_second = if state.substep_seconds > 0.0 {
            state.substep_seconds.recip()
        } else {
            0.0
        };
        if varies {
            // Velocities are displacements since the substep before: that of the air is added to where a particle was.
            if per_second == 0.0 {
                per_second = step.seconds().recip();
            }
            let uneven = |(source, whole): &(&Source, bool)| !whole || source.turbulence.is_some();
            let breezes = self.reaching(ball).filter(uneven);
            let breezes = breezes.map(|(source, whole)| source.breeze(frame, whole));
            let previous = &state.previous_position;
            let with_air = &mut scratch.previous_with_air;
            if with_air.len() != previous.len() {
                *with_air = Points::zeroed(previous.len());
            }
            with_air.copy_from(previous);
            let out = SharedPoints::new(with_air);
            let seconds = per_second.recip();
            for breeze in breezes {
                workers.share(0..position.len(), |range| {
                    breeze::add(level, &breeze, seconds, position, out, range);
                });
            }
        }
        let previous = if varies {
            &scratch.previous_with_air
        } else {
            &state.previous_position
        };
        let air = Air {
            wind,
            density,
            areal_density: material.areal_density,
            drag: material.drag,
            lift: material.lift,
            seconds: step.seconds(),
        };
        // The cells of a mesh are cut in its own way.
        if let Some(lattice) = topology.grid_lattice() {
            let sheet = AirSheet {
                lattice,
                position,
                previous,
                inv_mass,
                acceleration: SharedPoints::new(acceleration),
            };
            workers.share(0..lattice.rows as usize, |rows| match model {
                ClothWindModel::Classic => aerodynamics::classic_on_sheet(level, sheet, wind, rows),
                ClothWindModel::Aerodynamic => {
                    aerodynamics::drag_and_lift_on_sheet(level, sheet, air, per_second, rows);
                }
            });
            return;
        }
        let triangles = &topology.triangles;
        match model {
            ClothWindModel::Classic => {
                aerodynamics::classic(triangles, wind, position, inv_mass, acceleration);
            }
            ClothWindModel::Aerodynamic => {
                aerodynamics::drag_and_lift(
                    triangles,
                    &topology.triangle_areas,
                    air,
                    position,
                    previous,
                    per_second,
                    inv_mass,
                    acceleration,
                );
            }
        }
    }
}

impl Source {
    /// Breeze in the axes of a cloth's frame; at full strength everywhere if it is `whole`.
    fn breeze(&self, frame: &ClothFrame, whole: bool) -> Breeze {
        let frame = frame.isometry();
        let to_own = self.at.inverse() * frame;
        let back = to_own.rotation.inverse();
        let origin = Vec3::from(to_own.translation).as_dvec3();
        let mut waves = self.waves;
        for wave in &mut waves {
            let phase = wave.turns.as_dvec3().dot(origin) + f64::from(wave.phase);
            *wave = Wave {
                amplitude: back * wave.amplitude,
                turns: back * wave.turns,
                phase: phase.rem_euclid(1.0) as f32,
            };
        }
        Breeze {
            velocity: frame.rotation.inverse() * self.velocity,
            waves: self.turbulence.is_some().then_some(waves),
            shape: if whole {
                WindRegion::Everywhere
            } else {
                self.shape
            },
            falloff: self.falloff,
            to_own,
        }
    }
}
