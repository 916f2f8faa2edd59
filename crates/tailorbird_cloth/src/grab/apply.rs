//! Takes hold of what is in a hand.

use std::collections::VecDeque;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use tailorbird_solver::{
    held::{Held, HeldBy, HolderKind},
    particles::Pulled,
    topology::order::{Given, Stored},
};

use super::ClothGrab;
use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    frame::ClothFrame,
    particles::ClothParticles,
    topology::ClothTopology,
};

/// Part of the hand's motion that a particle at this distance takes: (1 − d²/r²)², 1 at the hand, 0 with no kink at the rim.
fn falloff(distance: f32, radius: f32) -> f32 {
    let q = (1.0 - (distance / radius).powi(2)).max(0.0);
    q * q
}

/// Turns grabs into targets for this step.
pub fn apply_grab(
    mut cloths: Query<
        (
            Entity,
            &mut ClothGrab,
            &ClothTopology,
            &ClothFrame,
            &mut ClothParticles,
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (entity, mut grab, topology, frame, mut particles, mut status) in &mut cloths {
        let before = particles.grabbed();
        let order = particles.order.clone();
        let error = match &mut grab.bypass_change_detection().held {
            None => {
                particles.0.input.held.replace(HolderKind::Hand, []);
                particles.0.input.pulled.clear();
                None
            }
            Some(hand) if particles.is_empty() || !hand.target.is_finite() => {
                ClothErrorKind::vector("ClothGrab.target", hand.target)
            }
            Some(hand) if hand.particle as usize >= particles.len() => {
                Some(ClothErrorKind::ParticleOutOfRange {
                    field: "ClothGrab".into(),
                    value: hand.particle,
                    particles: particles.len(),
                })
            }
            Some(hand) => {
                if hand.revision != topology.revision {
                    hand.patch = None;
                    hand.revision = topology.revision;
                }
                let patch = hand
                    .patch
                    .get_or_insert_with(|| patch(hand.particle, hand.radius, topology, &particles));
                particles.0.input.pulled.clear();
                let is_held = particles.is_held(hand.particle as usize);
                let in_hand = (!is_held).then(|| Held {
                    particle: order.stored(Given(hand.particle)),
                    // Where the frame will be when the hand is reached.
                    by: HeldBy::Hand(frame.to_frame_at_end(hand.target)),
                });
                particles.0.input.held.replace(HolderKind::Hand, in_hand);
                if !is_held {
                    particles.0.input.pulled.extend(patch.iter().map(
                        |&(particle, weight, offset)| Pulled {
                            particle: order.stored(Given(particle)),
                            offset,
                            weight,
                        },
                    ));
                }
                None
            }
        };
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Grab,
            error,
        );
        if particles.grabbed() != before {
            particles.0.update_inv_masses();
        }
    }
}

/// The particles within `radius` \[m\] of one along the edges at rest, direct neighbours at least, without itself.
fn patch(
    center: u32,
    radius: f32,
    topology: &ClothTopology,
    particles: &ClothParticles,
) -> Vec<(u32, f32, Vec3)> {
    let order = &particles.order;
    let rest = |i: Stored| topology.rest_positions[i.index()];
    let center = order.stored(Given(center));
    let ring = topology
        .neighbors(center)
        .iter()
        .map(|&n| rest(n).distance(rest(center)))
        .fold(0.0, f32::max);
    // Beyond the first ring, so that the weight there is not 0.
    let radius = radius.max(1.5 * ring);
    let held_at = particles.0.state.position.get(center.index());
    let mut seen = vec![center];
    let mut queue = VecDeque::from([center]);
    let mut patch = Vec::new();
    while let Some(from) = queue.pop_front() {
        for &particle in topology.neighbors(from).iter() {
            let weight = falloff(rest(particle).distance(rest(center)), radius);
            if weight > 0.0 && !seen.contains(&particle) {
                seen.push(particle);
                queue.push_back(particle);
                let offset = particles.0.state.position.get(particle.index()) - held_at;
                patch.push((order.given(particle).0, weight, offset));
            }
        }
    }
    patch
}
