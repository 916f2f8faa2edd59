//! Holds the particles that are pinned.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use tailorbird_solver::{
    held::{Held, HeldBy, HolderKind},
    topology::order::Given,
};

use super::ClothPins;
use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    material::ClothMaterial,
    particles::ClothParticles,
    topology::ClothTopology,
};

/// Turns changed pins into the list of held particles, and sets masses.
///
/// A pin that is wrong is reported and left out; the others hold.
pub fn apply_pins(
    mut cloths: Query<
        (
            Entity,
            Ref<ClothPins>,
            Ref<ClothTopology>,
            Ref<ClothMaterial>,
            &mut ClothParticles,
            &mut ClothStatus,
        ),
        With<Cloth>,
    >,
    commands: ParallelCommands,
) {
    for (entity, pins, topology, material, mut particles, mut status) in &mut cloths {
        if !(pins.is_changed() || topology.is_changed() || material.is_changed())
            || particles.is_empty()
        {
            continue;
        }
        let mut errors = Vec::new();
        let mut held = Vec::new();
        for pin in &pins.pins {
            if let Some(error) = pin
                .target
                .and_then(|t| ClothErrorKind::vector("ClothPins.target", t))
            {
                errors.push(error);
                continue;
            }
            match pin.selection.particles(&topology) {
                Ok(selected) => {
                    held.extend(selected.into_iter().map(|i| (Given(i), pin.target)));
                }
                Err(error) => errors.push(error),
            }
        }
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Pins,
            errors,
        );
        particles.set_pins(&held);
        let errors = material.errors();
        if errors.is_empty() {
            particles
                .0
                .set_masses(topology.areas(), material.areal_density);
        } else {
            particles.0.update_inv_masses();
        }
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ClothErrorSource::Material,
            errors,
        );
    }
}

impl ClothParticles {
    /// Replaces the pins. A particle that was pinned before without a target of its own stays where it was held.
    fn set_pins(&mut self, pins: &[(Given, Option<Vec3>)]) {
        let before = self.0.input.held.of(HolderKind::Pin);
        let place = |particle: Given| {
            let at = before.binary_search_by_key(&particle, |pin| self.order.given(pin.particle));
            match at.map(|at| before[at].by) {
                Ok(HeldBy::Pin(place)) => place,
                _ => self.position(particle.index()),
            }
        };
        let mut held: Vec<Held> = pins
            .iter()
            .map(|&(particle, target)| Held {
                particle: self.order.stored(particle),
                by: HeldBy::Pin(target.unwrap_or_else(|| place(particle))),
            })
            .collect();
        // Stable, so that the last of several pins of a particle can be kept.
        held.sort_by_key(|pin| self.order.given(pin.particle));
        held.reverse();
        held.dedup_by_key(|pin| pin.particle);
        held.reverse();
        self.0.input.held.replace(HolderKind::Pin, held);
    }
}
