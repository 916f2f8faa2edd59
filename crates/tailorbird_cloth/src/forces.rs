//! Forces from outside.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::particles::{Input, Particles, State};

use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothStatus, ErrorSource},
    frame::ClothFrame,
    particles::ClothParticles,
    step::ClothStep,
};

/// Forces that a game puts on a cloth. They act during the next step and are forgotten after it, so what lasts is
/// added in each step (in `FixedUpdate`, say).
///
/// Everything is in world axes. Pinned particles do not feel them.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct ClothForces {
    forces: Vec<(u32, Vec3)>,
    accelerations: Vec<(u32, Vec3)>,
    impulses: Vec<Impulse>,
}

#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
struct Impulse {
    point: Vec3,
    impulse: Vec3,
    radius: f32,
}

impl Impulse {
    fn error(&self) -> Option<ClothErrorKind> {
        ClothErrorKind::vector("ClothForces.impulse", self.impulse)
            .or_else(|| ClothErrorKind::vector("ClothForces.impulse point", self.point))
            .or_else(|| {
                ClothErrorKind::number(
                    "ClothForces.impulse radius",
                    self.radius,
                    |r| r >= 0.0,
                    "at least 0 [m]",
                )
            })
    }
}

impl ClothForces {
    /// Pushes a particle with a force \[N\] for one step.
    pub fn add_force(&mut self, particle: u32, force: Vec3) {
        self.forces.push((particle, force));
    }

    /// Accelerates a particle [m/s²] for one step, whatever its mass.
    pub fn add_acceleration(&mut self, particle: u32, acceleration: Vec3) {
        self.accelerations.push((particle, acceleration));
    }

    /// Gives an impulse [N s] at a point of the world \[m\]: shared among the free particles within `radius` \[m\] of it,
    /// most to the nearest; all to the nearest one where none is as near.
    pub fn add_impulse_at_point(&mut self, impulse: Vec3, point: Vec3, radius: f32) {
        self.impulses.push(Impulse {
            point,
            impulse,
            radius,
        });
    }

    /// Returns whether no force acts.
    pub fn is_empty(&self) -> bool {
        self.forces.is_empty() && self.accelerations.is_empty() && self.impulses.is_empty()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.forces.clear();
        self.accelerations.clear();
        self.impulses.clear();
    }
}

/// Turns the forces into accelerations for this step, and forgets them.
pub fn apply_forces(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            Entity,
            &mut ClothForces,
            &mut ClothParticles,
            &ClothFrame,
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (entity, mut forces, mut particles, frame, mut status) in &mut cloths {
        if particles.is_empty() {
            continue;
        }
        particles.0.input.acceleration.clear();
        if forces.is_empty() {
            ClothStatus::update(&mut status, entity, &commands, ErrorSource::Forces, None);
            continue;
        }
        particles.0.state.effort.driven = f32::INFINITY;
        let mut errors = Vec::new();
        let mut check = |field: &str, particle: u32, vector: Vec3, len: usize| {
            let error = ClothErrorKind::vector(field, vector).or_else(|| {
                (particle as usize >= len).then(|| ClothErrorKind::ParticleOutOfRange {
                    field: field.into(),
                    value: particle,
                    particles: len,
                })
            });
            let ok = error.is_none();
            errors.extend(error);
            ok
        };
        let len = particles.len();
        for &(particle, force) in &forces.forces {
            if check("ClothForces.force", particle, force, len) {
                let i = particles.order.stored(particle) as usize;
                let acceleration = frame.vector_to_frame(force) * particles.0.input.inv_mass[i];
                particles.0.accelerations().add(i, acceleration);
            }
        }
        for &(particle, acceleration) in &forces.accelerations {
            if check("ClothForces.acceleration", particle, acceleration, len) {
                let i = particles.order.stored(particle) as usize;
                particles
                    .0
                    .accelerations()
                    .add(i, frame.vector_to_frame(acceleration));
            }
        }
        for impulse in &forces.impulses {
            if let Some(error) = impulse.error() {
                errors.push(error);
                continue;
            }
            let local = Impulse {
                point: frame.to_frame(impulse.point),
                impulse: frame.vector_to_frame(impulse.impulse),
                radius: impulse.radius,
            };
            particles.add_impulse(local, step.seconds());
        }
        forces.bypass_change_detection().clear();
        ClothStatus::update(&mut status, entity, &commands, ErrorSource::Forces, errors);
    }
}

impl ClothParticles {
    /// Spreads an impulse over the free particles around a point, as an acceleration that lasts `seconds`.
    fn add_impulse(
        &mut self,
        Impulse {
            point,
            impulse,
            radius,
        }: Impulse,
        seconds: f32,
    ) {
        let distance_squared = |position: Vec3| position.distance_squared(point);
        let weight =
            |position: Vec3| (1.0 - distance_squared(position) / (radius * radius)).max(0.0);
        self.0.accelerations();
        let Particles {
            state: State { position, .. },
            input:
                Input {
                    acceleration,
                    inv_mass,
                    ..
                },
            ..
        } = &mut self.0;
        let free = || (0..inv_mass.len()).filter(|&i| inv_mass[i] > 0.0);
        let total: f32 = free().map(|i| weight(position.get(i))).sum();
        if radius > 0.0 && total > 0.0 {
            for i in free() {
                let share = weight(position.get(i)) / total;
                acceleration.add(i, impulse * (share * inv_mass[i] / seconds));
            }
        } else if let Some(nearest) = free().min_by(|&a, &b| {
            distance_squared(position.get(a)).total_cmp(&distance_squared(position.get(b)))
        }) {
            acceleration.add(nearest, impulse * (inv_mass[nearest] / seconds));
        }
    }
}
