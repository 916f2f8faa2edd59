//! Tethers from every particle to up to four pins, or other particles that are held.

use std::sync::{Arc, OnceLock};

use bevy_math::Vec3;
use bevy_tasks::AsyncComputeTaskPool;

use crate::{
    kernels::{
        lanes::Reading,
        tether::{Straight, Tether},
    },
    memory::heap,
    points::Points,
    topology::{
        Topology,
        geodesic::{Geodesics, tether_anchors},
        lattice::Lattice,
        order::Stored,
    },
};

/// Distances of each particle from up to four of the pins along the sheet at rest: no particle gets further away. In storage order.
#[derive(Clone, Debug, Default)]
pub struct Tethers {
    fields: Fields,
    pins: Vec<Stored>,
    revision: u64,
    coming: Option<Coming>,
    /// For how long what is beyond them comes back slowly, as some are new \[s\].
    fresh: f32,
}

/// Ways that are measured while the cloth goes on.
#[derive(Clone, Debug)]
struct Coming {
    /// The step that begins with them.
    due: u64,
    anchors: Vec<u32>,
    fields: Arc<OnceLock<Fields>>,
}

/// Largest additional length of tethers where pins are further apart than the sheet between them is long [-].
const ROOM_BEYOND: f32 = 0.02;

type Fields = [Option<Field>; Tethers::MOST];

/// Ways from new pins are fresh for so long \[s\].
const FRESH: f32 = 0.5;

/// Largest number of distances between pins and particles that is measured within a step.
const WAYS_PER_STEP: usize = 4000;

/// The ways from one pin.
#[derive(Clone, Debug)]
struct Field {
    pin: u32,
    ways: Ways,
}

#[derive(Clone, Debug)]
enum Ways {
    /// Along a sheet that is flat at rest.
    Straight(Lattice, Straight),
    /// One for each particle \[m\].
    Lengths(Vec<f32>),
}

impl Ways {
    /// Distance to a particle \[m\].
    fn length(&self, particle: u32) -> Option<f32> {
        match self {
            Self::Straight(lattice, straight) => {
                let (column, row) = (particle % lattice.columns, particle / lattice.columns);
                (row < lattice.rows).then(|| straight.length(column, row))
            }
            Self::Lengths(lengths) => lengths.get(particle as usize).copied(),
        }
    }
}

/// All tethers of a cloth, for the kernels.
pub enum Anchors<'a> {
    /// Of a sheet that is flat at rest.
    Straight([Option<Tether<Straight>>; Tethers::MOST]),
    /// Of any other cloth.
    Lengths([Option<Tether<Reading<'a>>>; Tethers::MOST]),
}

impl Tethers {
    /// Number of pins that particles are tethered to. Of more pins those are chosen that lie furthest apart.
    pub const MOST: usize = 4;

    /// The pins that particles are tethered to.
    pub fn pins(&self) -> impl Iterator<Item = u32> + '_ {
        self.fields.iter().flatten().map(|field| field.pin)
    }

    /// Distance of a particle from each of [`Self::pins`] \[m\]; none if there is no such particle.
    pub fn lengths(&self, particle: u32) -> impl Iterator<Item = f32> + '_ {
        self.fields
            .iter()
            .flatten()
            .filter_map(move |field| field.ways.length(particle))
    }

    /// Returns whether some of the pins are new: particles may be farther from them than their tethers allow.
    pub fn is_fresh(&self) -> bool {
        self.fresh > 0.0
    }

    /// Memory of the distances on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let fields = self.fields.iter().flatten();
        let ways = fields.map(|field| match &field.ways {
            Ways::Straight(..) => 0,
            Ways::Lengths(lengths) => heap(lengths),
        });
        heap(&self.pins) + ways.sum::<usize>()
    }

    /// Largest ratio of the distance between two pins to the length of the sheet between them, at least 1 [-].
    fn longer(&self, field: &Field, position: &Points) -> f32 {
        let at = position.get(field.pin as usize);
        let others = self.fields.iter().flatten();
        let far = others.filter_map(|other| {
            let way = field.ways.length(other.pin).filter(|way| *way > 0.0)?;
            Some(at.distance(position.get(other.pin as usize)) / way)
        });
        let most = far.fold(1.0, f32::max);
        most * (1.0 + (most - 1.0).min(ROOM_BEYOND))
    }

    /// Positions of the pins now and at the start of the substep, and the distances from each.
    pub fn anchors(&self, position: &Points, previous: &Points) -> Anchors<'_> {
        let fields = self.fields.each_ref().map(Option::as_ref);
        let at = |field: &Field| position.get(field.pin as usize);
        let before = |field: &Field| previous.get(field.pin as usize);
        if let Some(Some(Field {
            ways: Ways::Straight(lattice, _),
            ..
        })) = fields.first()
        {
            let usable = (lattice.columns * lattice.rows) as usize == position.len();
            return Anchors::Straight(fields.map(|field| match &field?.ways {
                Ways::Straight(_, ways) if usable => Some(Tether {
                    anchor: at(field?),
                    anchor_before: before(field?),
                    longer: self.longer(field?, position),
                    ways: *ways,
                }),
                _ => None,
            }));
        }
        Anchors::Lengths(fields.map(|field| match &field?.ways {
            Ways::Lengths(lengths) if lengths.len() == position.len() => Some(Tether {
                anchor: at(field?),
                anchor_before: before(field?),
                longer: self.longer(field?, position),
                ways: Reading(lengths),
            }),
            _ => None,
        }))
    }

    /// The point nearest to `p` that a particle gets to, its tethers being `slack` times as long as at rest \[m\].
    pub fn reached(&self, particle: Stored, p: Vec3, position: &Points, slack: f32) -> Vec3 {
        self.fields.iter().flatten().fold(p, |p, field| {
            let anchor = position.get(field.pin as usize);
            let reach = field
                .ways
                .length(particle.0)
                .map_or(f32::MAX, |l| l * slack);
            anchor + (p - anchor).clamp_length_max(reach)
        })
    }

    /// Measures the ways to the pins anew where the pins changed, at the start of the step number `step`, which lasts so long \[s\].
    ///
    /// A sheet of columns and rows that is flat at rest has no holes, so that the way is the straight line. On other meshes it has to be
    /// found: that of a large one beside the steps, and used from a step on that depends on the size of the mesh alone. Until then its
    /// particles are tethered to those of the pins before that still hold. What is farther from a new pin than it gets comes back at a
    /// rate, not at once.
    pub fn build(
        &mut self,
        topology: &Arc<Topology>,
        pins: impl Iterator<Item = Stored> + Clone,
        (step, seconds): (u64, f32),
    ) {
        let known = self.revision == topology.revision;
        if self.is_fresh() {
            self.fresh -= seconds;
        }
        if known && pins.clone().eq(self.pins.iter().copied()) {
            if self.coming.as_ref().is_some_and(|c| step >= c.due)
                && let Some(coming) = self.coming.take()
            {
                let measured = coming.fields.get().cloned();
                self.fields = measured.unwrap_or_else(|| fields(topology, &coming.anchors));
                self.fresh = FRESH;
            }
            return;
        }
        self.revision = topology.revision;
        self.pins = pins.collect();
        self.coming = None;
        let mut pins: Vec<u32> = self.pins.iter().map(|pin| pin.0).collect();
        // So that a sheet does the same however its particles were given.
        pins.sort_unstable();
        let rest = &topology.rest_positions;
        let anchors = tether_anchors(&pins, rest, Self::MOST);
        let ways = if is_straight(topology) {
            0
        } else {
            anchors.len() * rest.len()
        };
        // A cloth that is made or changed shape is not moving yet.
        if !known || ways < WAYS_PER_STEP {
            self.fields = fields(topology, &anchors);
            self.fresh = if known { FRESH } else { 0.0 };
            return;
        }
        for field in &mut self.fields {
            field.take_if(|field| pins.binary_search(&field.pin).is_err());
        }
        let coming = Coming {
            due: step + (ways / WAYS_PER_STEP) as u64,
            anchors,
            fields: Arc::default(),
        };
        // Without a pool they are measured when they are due.
        if let Some(pool) = AsyncComputeTaskPool::try_get() {
            let (topology, wanted) = (topology.clone(), coming.clone());
            let measure = async move {
                // Nobody waits for ways that changed again meanwhile.
                if Arc::strong_count(&wanted.fields) > 1 {
                    let fields = fields(&topology, &wanted.anchors);
                    wanted.fields.get_or_init(|| fields);
                }
            };
            pool.spawn(measure).detach();
        }
        self.coming = Some(coming);
    }
}

/// Returns whether shortest paths along the sheet are straight lines.
fn is_straight(topology: &Topology) -> bool {
    topology.flat && topology.lattice().is_some()
}

/// The ways from these particles.
fn fields(topology: &Topology, anchors: &[u32]) -> Fields {
    let ways = (!is_straight(topology) && !anchors.is_empty())
        .then(|| Geodesics::new(&topology.rest_positions, &topology.triangles));
    let mut anchors = anchors.iter().copied();
    [(); Tethers::MOST].map(|()| {
        let pin = anchors.next()?;
        let ways = match (topology.lattice(), &ways) {
            (_, Some(ways)) => Ways::Lengths(ways.distances(&[pin])),
            (Some(lattice), None) => Ways::Straight(
                *lattice,
                Straight {
                    column: pin % lattice.columns,
                    row: pin / lattice.columns,
                    spacing: lattice.spacing,
                },
            ),
            (None, None) => return None,
        };
        Some(Field { pin, ways })
    })
}
