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
    measured: AllDistances,
    pins: Vec<Stored>,
    revision: u64,
    coming: Option<Coming>,
    /// For how long what is beyond them comes back slowly, as some are new \[s\].
    fresh: f32,
}

/// Distances that are measured while the cloth goes on.
#[derive(Clone, Debug)]
struct Coming {
    /// The step that begins with them.
    due: u64,
    anchors: Vec<u32>,
    measured: Arc<OnceLock<AllDistances>>,
}

/// Largest additional length of tethers where pins are further apart than the sheet between them is long [-].
const ROOM_BEYOND: f32 = 0.02;

type AllDistances = [Option<PinDistances>; Tethers::MOST];

/// Time for which distances from new pins are fresh \[s\].
const FRESH: f32 = 0.5;

/// Largest number of distances between pins and particles that is measured within a step.
const DISTANCES_PER_STEP: usize = 4000;

/// Distances of all particles from one pin.
#[derive(Clone, Debug)]
struct PinDistances {
    pin: u32,
    lengths: PathLengths,
}

#[derive(Clone, Debug)]
enum PathLengths {
    /// Along a sheet that is flat at rest.
    Straight(Lattice, Straight),
    /// One for each particle \[m\].
    Lengths(Vec<f32>),
}

impl PathLengths {
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
        self.measured.iter().flatten().map(|from| from.pin)
    }

    /// Distance of a particle from each of [`Self::pins`] \[m\]; none if there is no such particle.
    pub fn lengths(&self, particle: u32) -> impl Iterator<Item = f32> + '_ {
        self.measured
            .iter()
            .flatten()
            .filter_map(move |from| from.lengths.length(particle))
    }

    /// Returns whether some of the pins are new: particles may be farther from them than their tethers allow.
    pub fn is_fresh(&self) -> bool {
        self.fresh > 0.0
    }

    /// Memory of the distances on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let measured = self.measured.iter().flatten();
        let bytes = measured.map(|from| match &from.lengths {
            PathLengths::Straight(..) => 0,
            PathLengths::Lengths(lengths) => heap(lengths),
        });
        heap(&self.pins) + bytes.sum::<usize>()
    }

    /// Largest ratio of the distance between two pins to the length of the sheet between them, at least 1 [-].
    fn longer(&self, from: &PinDistances, position: &Points) -> f32 {
        let at = position.get(from.pin as usize);
        let others = self.measured.iter().flatten();
        let far = others.filter_map(|other| {
            let length = from.lengths.length(other.pin).filter(|l| *l > 0.0)?;
            Some(at.distance(position.get(other.pin as usize)) / length)
        });
        let most = far.fold(1.0, f32::max);
        most * (1.0 + (most - 1.0).min(ROOM_BEYOND))
    }

    /// Positions of the pins now and at the start of the substep, and the distances from each.
    pub fn anchors(&self, position: &Points, previous: &Points) -> Anchors<'_> {
        let measured = self.measured.each_ref().map(Option::as_ref);
        let at = |from: &PinDistances| position.get(from.pin as usize);
        let before = |from: &PinDistances| previous.get(from.pin as usize);
        if let Some(Some(PinDistances {
            lengths: PathLengths::Straight(lattice, _),
            ..
        })) = measured.first()
        {
            let usable = (lattice.columns * lattice.rows) as usize == position.len();
            return Anchors::Straight(measured.map(|from| match &from?.lengths {
                PathLengths::Straight(_, straight) if usable => Some(Tether {
                    anchor: at(from?),
                    anchor_before: before(from?),
                    longer: self.longer(from?, position),
                    distances: *straight,
                }),
                _ => None,
            }));
        }
        Anchors::Lengths(measured.map(|from| match &from?.lengths {
            PathLengths::Lengths(lengths) if lengths.len() == position.len() => Some(Tether {
                anchor: at(from?),
                anchor_before: before(from?),
                longer: self.longer(from?, position),
                distances: Reading(lengths),
            }),
            _ => None,
        }))
    }

    /// The point nearest to `p` that a particle gets to, its tethers being `slack` times as long as at rest \[m\].
    pub fn reached(&self, particle: Stored, p: Vec3, position: &Points, slack: f32) -> Vec3 {
        self.measured.iter().flatten().fold(p, |p, from| {
            let anchor = position.get(from.pin as usize);
            let reach = from
                .lengths
                .length(particle.0)
                .map_or(f32::MAX, |l| l * slack);
            anchor + (p - anchor).clamp_length_max(reach)
        })
    }

    /// Measures the distances from the pins anew where the pins changed, at the start of the step number `step`, which lasts so long \[s\].
    ///
    /// A sheet of columns and rows that is flat at rest has no holes, so that the shortest path is the straight line. On other meshes it has to be
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
                let measured = coming.measured.get().cloned();
                self.measured = measured.unwrap_or_else(|| measure(topology, &coming.anchors));
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
        let count = if is_straight(topology) {
            0
        } else {
            anchors.len() * rest.len()
        };
        // A cloth that is made or changed shape is not moving yet.
        if !known || count < DISTANCES_PER_STEP {
            self.measured = measure(topology, &anchors);
            self.fresh = if known { FRESH } else { 0.0 };
            return;
        }
        for from in &mut self.measured {
            from.take_if(|from| pins.binary_search(&from.pin).is_err());
        }
        let coming = Coming {
            due: step + (count / DISTANCES_PER_STEP) as u64,
            anchors,
            measured: Arc::default(),
        };
        // Without a pool they are measured when they are due.
        if let Some(pool) = AsyncComputeTaskPool::try_get() {
            let (topology, wanted) = (topology.clone(), coming.clone());
            let work = async move {
                // Nobody waits for distances that changed again meanwhile.
                if Arc::strong_count(&wanted.measured) > 1 {
                    let measured = measure(&topology, &wanted.anchors);
                    wanted.measured.get_or_init(|| measured);
                }
            };
            pool.spawn(work).detach();
        }
        self.coming = Some(coming);
    }
}

/// Returns whether shortest paths along the sheet are straight lines.
fn is_straight(topology: &Topology) -> bool {
    topology.flat && topology.lattice().is_some()
}

/// Measures the distances from these particles.
fn measure(topology: &Topology, anchors: &[u32]) -> AllDistances {
    let geodesics = (!is_straight(topology) && !anchors.is_empty())
        .then(|| Geodesics::new(&topology.rest_positions, &topology.triangles));
    let mut anchors = anchors.iter().copied();
    [(); Tethers::MOST].map(|()| {
        let pin = anchors.next()?;
        let lengths = match (topology.lattice(), &geodesics) {
            (_, Some(geodesics)) => PathLengths::Lengths(geodesics.distances(&[pin])),
            (Some(lattice), None) => PathLengths::Straight(
                *lattice,
                Straight {
                    column: pin % lattice.columns,
                    row: pin / lattice.columns,
                    spacing: lattice.spacing,
                },
            ),
            (None, None) => return None,
        };
        Some(PinDistances { pin, lengths })
    })
}
