//! Tethers from every particle to up to four pins.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

use crate::{
    cloth::Cloth,
    memory::heap,
    particles::ClothParticles,
    points::Points,
    solver::ClothSolver,
    topology::{
        ClothTopology,
        geodesic::{Geodesics, tether_anchors},
    },
};

/// How far each particle gets from up to four of the pins: the way along the sheet at rest. In storage order. Written by
/// [`build_tethers`] alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothTethers {
    #[reflect(ignore)]
    fields: [Option<Field>; ClothTethers::MOST],
    #[reflect(ignore)]
    pins: Vec<u32>,
    revision: u64,
}

/// The ways from one pin.
#[derive(Clone, Debug)]
struct Field {
    pin: u32,
    /// One for each particle \[m\].
    lengths: Vec<f32>,
}

impl ClothTethers {
    /// How many pins particles are tethered to. Of more pins those are chosen that lie furthest apart.
    pub const MOST: usize = 4;

    /// The pins that particles are tethered to.
    pub fn pins(&self) -> impl Iterator<Item = u32> + '_ {
        self.fields.iter().flatten().map(|field| field.pin)
    }

    /// How far a particle gets from each of [`Self::pins`] \[m\]; none where there is no such particle.
    pub fn lengths(&self, particle: u32) -> impl Iterator<Item = f32> + '_ {
        self.fields
            .iter()
            .flatten()
            .filter_map(move |field| field.lengths.get(particle as usize).copied())
    }

    /// What the ways take on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let fields = self.fields.iter().flatten();
        heap(&self.pins) + fields.map(|field| heap(&field.lengths)).sum::<usize>()
    }

    /// Where the pins are, and the ways from each.
    pub(crate) fn anchors(&self, position: &Points) -> [Option<(Vec3, &[f32])>; Self::MOST] {
        self.fields.each_ref().map(|field| {
            let Field { pin, lengths } = field.as_ref()?;
            let usable = lengths.len() == position.len();
            usable.then(|| (position.get(*pin as usize), lengths.as_slice()))
        })
    }
}

/// Measures the ways to the pins anew where the pins changed.
///
/// A sheet of columns and rows that is flat at rest has no holes, so that the way is the straight line.
pub fn build_tethers(
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothSolver,
            &ClothParticles,
            &mut ClothTethers,
        ),
        With<Cloth>,
    >,
) {
    for (topology, solver, particles, mut tethers) in &mut cloths {
        let wanted = *solver == ClothSolver::Chains;
        let pins = || {
            let pins = particles.pins.iter().map(|pin| pin.particle);
            pins.filter(|_| wanted)
        };
        if tethers.revision == topology.revision && pins().eq(tethers.pins.iter().copied()) {
            continue;
        }
        tethers.revision = topology.revision;
        tethers.pins = pins().collect();
        let rest = &topology.rest_positions;
        let straight = topology.flat && topology.lattice.is_some();
        let ways = (!straight && !tethers.pins.is_empty())
            .then(|| Geodesics::new(rest, &topology.triangles));
        let mut pins = tethers.pins.clone();
        // So that a sheet does the same however its particles were given.
        pins.sort_unstable();
        let mut anchors = tether_anchors(&pins, rest, ClothTethers::MOST).into_iter();
        tethers.fields = [(); ClothTethers::MOST].map(|()| {
            let pin = anchors.next()?;
            let from = *rest.get(pin as usize)?;
            let lengths = ways.as_ref().map_or_else(
                || rest.iter().map(|p| p.distance(from)).collect(),
                |ways| ways.distances(&[pin]),
            );
            Some(Field { pin, lengths })
        });
    }
}
