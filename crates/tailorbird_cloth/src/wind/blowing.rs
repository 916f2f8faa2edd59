//! The air during a step: what blows, and what it does to cloths.

use std::hash::{DefaultHasher, Hash, Hasher};

use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Isometry3d, Vec3};
use tailorbird_solver::{
    kernels::{
        aerodynamics::{self, Air, AirSheet},
        breeze::{self, Breeze},
        lanes::SharedPoints,
    },
    particles::{Input, Particles, Scratch, State},
    points::Points,
    wind::{WAVES, Wave, WindRegion, sine, strength},
    workers::Workers,
};
use tracing::error;

use super::{ClothTurbulence, ClothWind, ClothWindModel, ClothWindZone, zone::is_whole_in};
use crate::{
    bounds::ClothBounds,
    cloth::Cloth,
    error::{ClothErrorSource, ClothStatus},
    frame::{ClothFrame, split},
    sampling::ClothSampledPoses,
    stages::{ClothStages, ClothStagesItem, for_each_awake},
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

    fn hash(&self, hasher: &mut impl Hasher) {
        let numbers = |hasher: &mut _, list: &[f32]| {
            for number in list {
                number.to_bits().hash(hasher);
            }
        };
        numbers(hasher, &self.velocity.to_array());
        numbers(hasher, &Vec3::from(self.at.translation).to_array());
        numbers(hasher, &self.at.rotation.to_array());
        let size = match self.shape {
            WindRegion::Everywhere => Vec3::ZERO,
            WindRegion::Cuboid { half_size } => half_size,
            WindRegion::Sphere { radius } => Vec3::splat(-radius),
        };
        numbers(hasher, &size.to_array());
        let ClothTurbulence { speed, scale, seed } = self.turbulence;
        numbers(hasher, &[self.falloff, speed, scale]);
        seed.hash(hasher);
        if self.turbulence.is_some() {
            numbers(hasher, &self.waves.map(|wave| wave.phase));
        }
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
    mut zones: Query<(Entity, Ref<ClothWindZone>, &mut ClothStatus)>,
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
    for (entity, zone, mut status) in &mut zones {
        if zone.is_changed() {
            let errors = zone.errors();
            ClothStatus::update(
                &mut status,
                entity,
                &commands,
                ClothErrorSource::ClothWind,
                errors,
            );
        }
        let Ok(place) = poses.get(entity).map(|pose| split(&pose.end)) else {
            continue;
        };
        let error = place.as_ref().err().cloned();
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Transform,
            error,
        );
        let Ok((at, scale)) = place else { continue };
        if !status.is_ok_for(ClothErrorSource::ClothWind) {
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
pub fn apply_wind(
    step: Res<ClothStep>,
    wind: Res<ClothWindState>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        wind.blow(&step, Workers::ALONE, &mut cloth);
    });
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
        let mut hasher = DefaultHasher::new();
        self.valid.model.hash(&mut hasher);
        self.valid.air_density.to_bits().hash(&mut hasher);
        for (source, _) in self.reaching(ball(frame, bounds)) {
            source.hash(&mut hasher);
        }
        hasher.finish()
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
        let particles = &mut *cloth.particles;
        let mut per_second = if particles.0.state.substep_seconds > 0.0 {
            particles.0.state.substep_seconds.recip()
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
            let (position, previous) = (
                &particles.0.state.position,
                &particles.0.state.previous_position,
            );
            let with_air = &mut particles.0.scratch.previous_with_air;
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
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    ..
                },
            input:
                Input {
                    acceleration,
                    inv_mass,
                    ..
                },
            scratch: Scratch {
                previous_with_air, ..
            },
            ..
        } = &mut particles.0;
        let previous = if varies {
            &*previous_with_air
        } else {
            &*previous_position
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
