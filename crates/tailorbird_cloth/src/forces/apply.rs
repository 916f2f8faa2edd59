//! Hands the forces on to the particles.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use tailorbird_solver::{
    particles::{Input, Particles, State},
    topology::order::Given,
};

use super::{ClothForces, Impulse};
use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    frame::ClothFrame,
    particles::ClothParticles,
    step::ClothStep,
};

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
            ClothStatus::update(
                &mut status,
                entity,
                &commands,
                ClothErrorSource::Forces,
                None,
            );
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
                let i = particles.order.stored(Given(particle)).index();
                let acceleration = frame.vector_to_frame(force) * particles.0.input.inv_mass[i];
                particles.0.accelerations().add(i, acceleration);
            }
        }
        for &(particle, acceleration) in &forces.accelerations {
            if check("ClothForces.acceleration", particle, acceleration, len) {
                let i = particles.order.stored(Given(particle)).index();
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
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Forces,
            errors,
        );
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
