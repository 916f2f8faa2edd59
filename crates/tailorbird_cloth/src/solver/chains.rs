//! The chain solver: what it does to a cloth in a substep. The page beside the kernels, `kernels/README.md`, explains it.

use fearless_simd::Level;

use super::kernels::{
    lanes::{Reading, Shared, SharedPoints},
    lattice::{self, Shear, Sheet},
    line::LineStiffness,
    mesh,
    tether::{self, Tether},
    viscosity::{self, RigidMotion},
};
use crate::{
    crew::Crew,
    material::ClothMaterial,
    particles::ClothParticles,
    tethers::ClothTethers,
    topology::{Topology, lattice::Lattice},
};

/// How much longer than at rest a tether is [-]: what is left to the chains.
const SLACK: f32 = 1.001;

/// The same where the ways to the pins run over a curved surface and are less certain.
const CURVED_SLACK: f32 = 1.005;

/// How many times the strain of a sheet that hangs by its own weight a tether of a fabric that stretches allows [-].
const STRETCH_ROOM: f32 = 20.0;

/// One pass over the constraints.
pub(crate) struct Pass<'a> {
    pub level: Level,
    pub crew: Crew<'a>,
    pub topology: &'a Topology,
    pub material: &'a ClothMaterial,
    /// Length of the substep \[s\].
    pub seconds: f32,
    /// Strength of gravity [m/s²].
    pub gravity: f32,
    /// Which direction comes first alternates with it.
    pub number: u32,
}

impl Pass<'_> {
    /// α̃ = α/h² [1/kg].
    pub(super) fn alpha_tilde(&self, compliance: f32) -> f32 {
        super::alpha_tilde(compliance, self.seconds)
    }

    /// The lines at distance `across` from each other, whose particles are `along` apart \[m\].
    fn line(&self, compliance: f32, along: f32, across: f32) -> LineStiffness {
        let bend = self.material.bend_compliance * along * along * along / across;
        LineStiffness {
            rest_length: along,
            stretch: self.alpha_tilde(compliance * along / across),
            // What is curved at rest has hinges.
            bend: if self.topology.flat {
                self.alpha_tilde(bend)
            } else {
                f32::INFINITY
            },
        }
    }

    /// How much longer than at rest tethers are [-].
    fn slack(&self) -> f32 {
        let material = self.material;
        let size = match (&self.topology.lattice, &self.topology.fabric) {
            (Some(lattice), _) => {
                lattice.rows.max(lattice.columns) as f32 * lattice.spacing.max_element()
            }
            (None, Some(fabric)) => fabric.size(),
            (None, None) => 0.0,
        };
        let slack = if self.topology.flat {
            SLACK
        } else {
            CURVED_SLACK
        };
        let weight = material.areal_density * self.gravity.max(1.0) * size;
        let compliance = material.warp_compliance.max(material.weft_compliance);
        let room = STRETCH_ROOM * compliance * weight;
        // Not finite or negative: the material is reported elsewhere.
        slack + if room > 0.0 { room.min(1e6) } else { 0.0 }
    }

    pub(super) fn is_odd(&self) -> bool {
        self.number % 2 == 1
    }

    /// Tethers, bending, shear, then whole lines: rows and columns, and the other way round in every second pass.
    pub fn solve(&self, tethers: &ClothTethers, particles: &mut ClothParticles) {
        let topology = self.topology;
        if particles.len() != topology.particles() || particles.is_empty() {
            return;
        }
        let anchors = tethers.anchors(&particles.position);
        let slack = self.slack();
        let tethers = anchors.map(|anchor| {
            anchor.map(|(anchor, lengths)| Tether {
                anchor,
                lengths: Reading(lengths),
            })
        });
        // A hand does not pull the cloth further from its pins than it reaches.
        if let Some(held) = particles.grabbed {
            let i = held.particle as usize;
            let from = particles.position.get(i);
            let reached = tethers.iter().flatten().fold(from, |p, tether| {
                let reach = tether.lengths.0.get(i).map_or(f32::MAX, |l| l * slack);
                tether.anchor + (p - tether.anchor).clamp_length_max(reach)
            });
            particles.position.set(i, reached);
        }
        let all = particles.len();
        let line = sheet(particles, [all, 1]);
        self.crew.share(0..all, |range| {
            tether::solve(self.level, line, &tethers, slack, range);
        });
        self.bend(topology, particles);
        if let Some(lattice) = &topology.lattice {
            self.solve_lattice(lattice, particles);
        } else if let Some(fabric) = &topology.fabric {
            self.solve_fabric(fabric, particles);
        }
    }

    fn solve_lattice(&self, lattice: &Lattice, particles: &mut ClothParticles) {
        let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
        let (level, odd) = (self.level, self.is_odd());
        let sheet = sheet(particles, [columns, rows]);
        let [dx, dy] = lattice.spacing.to_array();
        let shear = Shear {
            rest_length: dx.hypot(dy),
            alpha_tilde: self.alpha_tilde(self.material.shear_compliance),
            rising_first: odd,
        };
        // Parts begin at even distances from the first.
        for first in [0, 1] {
            self.crew.share(first..rows, |rows| {
                lattice::solve_shear(level, sheet, shear, rows);
            });
        }

        let weft = self.line(self.material.weft_compliance, dx, dy);
        let warp = self.line(self.material.warp_compliance, dy, dx);
        let solve_columns = || {
            self.crew.share(0..columns, |columns| {
                lattice::solve_columns(level, sheet, warp, columns);
            });
        };
        if odd {
            solve_columns();
        }
        self.crew.share(0..rows, |rows| {
            lattice::solve_rows(level, sheet, weft, rows);
        });
        if !odd {
            solve_columns();
        }
    }
}

/// The particles as columns and rows.
fn sheet(particles: &mut ClothParticles, [columns, rows]: [usize; 2]) -> Sheet<'_> {
    let ClothParticles {
        position,
        inv_mass,
        contacts,
        ..
    } = particles;
    Sheet {
        columns,
        rows,
        position: SharedPoints::new(position),
        inv_mass: Shared::new(inv_mass),
        normal: contacts
            .any
            .then(|| SharedPoints::new(&mut contacts.normal)),
    }
}

/// Internal viscosity, before the particles move. The substep before took `seconds_before` \[s\].
pub(crate) fn damp(
    level: Level,
    topology: &Topology,
    material: &ClothMaterial,
    seconds_before: f32,
    particles: &mut ClothParticles,
) {
    let sound = material.viscosity > 0.0 && seconds_before > 0.0;
    if !sound || particles.len() != topology.particles() {
        return;
    }
    let density = particles.areal_density;
    let ClothParticles {
        position,
        previous_position,
        lost_displacement,
        mass,
        inv_mass,
        ..
    } = particles;
    let motion = RigidMotion::fit(mass, position, previous_position);
    if let Some(lattice) = &topology.lattice {
        let area = lattice.spacing.x * lattice.spacing.y;
        // ν = c L²/(4 h) on a square grid.
        let c = (4.0 * material.viscosity * seconds_before / area).min(viscosity::LARGEST);
        let conductance = 0.25 * c * density * area;
        let sheet = Sheet {
            columns: lattice.columns as usize,
            rows: lattice.rows as usize,
            position: SharedPoints::new(position),
            inv_mass: Shared::new(inv_mass),
            normal: None,
        };
        let previous = SharedPoints::new(previous_position);
        let lost = SharedPoints::new(lost_displacement);
        viscosity::damp(level, sheet, previous, lost, motion, conductance);
    } else if let Some(fabric) = &topology.fabric {
        let viscosity = material.viscosity * seconds_before;
        mesh::exchange(
            fabric,
            position,
            previous_position,
            lost_displacement,
            inv_mass,
            motion,
            viscosity,
            density,
        );
    }
}
