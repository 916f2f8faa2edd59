//! The chain solver: a pass over the constraints of a cloth. The page beside the kernels, `kernels/README.md`, explains it.

use fearless_simd::Level;

use crate::{
    coefficients::Coefficients,
    kernels::{
        edges::LineStiffness,
        lanes::{Shared, SharedPoints},
        lattice::{self, Sheet},
        lines::Give,
        mesh,
        rigid_motion::RigidMotion,
        shear::{self, Shear},
        spring::alpha_tilde,
        tether,
        verlet::Verlet,
        viscosity::{self, Beside, SheetMotion},
    },
    particles::{Input, Particles, Scratch, State},
    points::Points,
    substep::Substep,
    tethers::{Anchors, Tethers},
    topology::{
        Topology,
        lattice::Lattice,
        layout::{Layout, SheetLayout},
    },
    workers::Workers,
};

/// Factor of the lengths of tethers [-]: the rest is left to the chains.
const SLACK: f32 = 1.001;

/// The same factor for a curved surface, on which distances from pins are less certain.
const CURVED_SLACK: f32 = 1.005;

/// Strain that a tether of a stretching fabric allows, as a multiple of that of a sheet that hangs by its own weight [-].
const STRETCH_ROOM: f32 = 20.0;

/// One pass over the constraints.
pub struct Pass<'a> {
    pub level: Level,
    pub workers: Workers<'a>,
    pub topology: &'a Topology,
    pub material: &'a Coefficients,
    /// Length of the substep \[s\].
    pub seconds: f32,
    /// Strength of gravity [m/s²].
    pub gravity: f32,
    /// Number of the pass: the order of rows and columns alternates with it.
    pub number: u32,
}

impl<'a> Pass<'a> {
    /// Pass `k` of a substep.
    pub fn of(
        substep: &Substep<'a>,
        topology: &'a Topology,
        material: &'a Coefficients,
        k: u32,
    ) -> Self {
        Self {
            level: substep.level,
            workers: substep.workers,
            topology,
            material,
            seconds: substep.seconds,
            gravity: substep.gravity.length(),
            number: substep.index + k,
        }
    }
}

impl Pass<'_> {
    /// α̃ = α/h² [1/kg].
    pub fn alpha_tilde(&self, compliance: f32) -> f32 {
        alpha_tilde(compliance, self.seconds)
    }

    /// Stiffness of the lines at distance `across` from each other, whose particles are `along` apart \[m\], of a sheet of this areal
    /// density [kg/m²].
    fn line(&self, compliance: f32, along: f32, across: f32, density: f32) -> LineStiffness {
        let bend = self.material.bend_compliance * along * along * along / across;
        LineStiffness {
            rest_length: along,
            stretch: self.alpha_tilde(compliance * along / across),
            // A sheet that is curved at rest has hinges.
            bend: if self.topology.flat {
                self.alpha_tilde(bend)
            } else {
                f32::INFINITY
            },
            mass: density * along * across,
        }
    }

    /// Size of the cloth \[m\].
    pub fn size(&self) -> f32 {
        match &self.topology.layout {
            Layout::Sheet(SheetLayout { lattice, .. }) => {
                lattice.rows.max(lattice.columns) as f32 * lattice.spacing.max_element()
            }
            Layout::Mesh(fabric) => fabric.size(),
        }
    }

    /// Factor of the lengths of tethers [-].
    pub fn slack(&self) -> f32 {
        let material = self.material;
        let size = self.size();
        let slack = if self.topology.flat {
            SLACK
        } else {
            CURVED_SLACK
        };
        let weight = material.areal_density * self.gravity.max(1.0) * size;
        let compliance = material.warp_compliance.max(material.weft_compliance);
        let room = STRETCH_ROOM * compliance * weight;
        // Not for a stretch that is not finite or negative: the material is reported elsewhere.
        slack + if room > 0.0 { room.min(1e6) } else { 0.0 }
    }

    /// Particles as columns and rows, and their positions at the start of the substep.
    fn sheet<'a>(
        &self,
        particles: &'a mut Particles,
        [columns, rows]: [usize; 2],
    ) -> (Sheet<'a>, SharedPoints<'a>) {
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    effort,
                    grant,
                    ..
                },
            input: Input { inv_mass, .. },
            scratch: Scratch { contacts, .. },
            ..
        } = particles;
        let granted = grant.overall();
        let sheet = Sheet {
            columns,
            rows,
            position: SharedPoints::new(position),
            inv_mass: Shared::new(inv_mass),
            normal: contacts
                .any
                .then(|| SharedPoints::new(&mut contacts.normal)),
            pressed: (!contacts.pressed.is_empty()).then(|| Shared::new(&mut contacts.pressed)),
            give: self.give(*effort, granted, contacts.any),
            lengths: grant.sheet(columns * rows),
        };
        (sheet, SharedPoints::new(previous_position))
    }

    pub fn is_odd(&self) -> bool {
        self.number % 2 == 1
    }

    /// Solves tethers, bending, shear, then whole lines: rows and columns, and in every second pass columns first.
    pub fn solve(&self, tethers: &Tethers, particles: &mut Particles) {
        let topology = self.topology;
        if particles.len() != topology.particles() || particles.is_empty() {
            return;
        }
        let slack = self.slack() * (1.0 + particles.state.grant.largest());
        // A hand does not pull the cloth further from its pins than the tethers reach.
        if let Some((held, _)) = particles.input.held.in_hand() {
            let i = held.index();
            let position = &mut particles.state.position;
            let from = position.get(i);
            position.set(i, tethers.reached(held, from, position, slack));
        }
        let all = particles.len();
        let (level, workers) = (self.level, self.workers);
        for coupling in &mut particles.state.couplings {
            let place = particles.state.position.get(coupling.particle);
            coupling.held += coupling.normal.dot(place);
        }
        let fresh = tethers.is_fresh();
        match tethers.anchors(
            &particles.state.position,
            &particles.state.previous_position,
        ) {
            Anchors::Straight(tethers) => {
                if let Some(lattice) = topology.lattice() {
                    let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
                    let effort = particles.state.effort;
                    let (sheet, start) = self.sheet(particles, [columns, rows]);
                    let how = (slack, self.recovery(effort, fresh, start));
                    workers.share(0..rows, |rows| {
                        tether::solve_straight(level, sheet, &tethers, how, rows);
                    });
                }
            }
            Anchors::Lengths(tethers) => {
                let effort = particles.state.effort;
                let (sheet, start) = self.sheet(particles, [all, 1]);
                let how = (slack, self.recovery(effort, fresh, start));
                workers.share(0..all, |range| {
                    tether::solve(level, sheet, &tethers, how, range);
                });
            }
        }
        for coupling in &mut particles.state.couplings {
            let place = particles.state.position.get(coupling.particle);
            coupling.held -= coupling.normal.dot(place);
        }
        self.bend(&topology.hinges, particles);
        match &topology.layout {
            Layout::Sheet(sheet) => self.solve_lattice(&sheet.lattice, particles),
            Layout::Mesh(fabric) => self.solve_fabric(fabric, particles),
        }
    }

    fn solve_lattice(&self, lattice: &Lattice, particles: &mut Particles) {
        let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
        let (level, odd) = (self.level, self.is_odd());
        let density = particles.input.areal_density;
        let (sheet, _) = self.sheet(particles, [columns, rows]);
        let [dx, dy] = lattice.spacing.to_array();
        let shear = Shear {
            rest_length: dx.hypot(dy),
            alpha_tilde: self.alpha_tilde(self.material.shear_compliance),
            rising_first: odd,
        };
        self.workers.share(0..rows, |rows| {
            shear::solve(level, sheet, shear, rows);
        });
        let part = self.workers.part(rows);
        let seams = rows.div_ceil(part) - 1;
        self.workers.share_by(1, 0..seams, |seams| {
            for seam in seams {
                shear::solve_seam(level, sheet, shear, (seam + 1) * part - 1);
            }
        });

        let weft = self.line(self.material.weft_compliance, dx, dy, density);
        let warp = self.line(self.material.warp_compliance, dy, dx, density);
        let solve_columns = || {
            self.workers.share(0..columns, |columns| {
                lattice::solve_columns(level, sheet, warp, columns);
            });
        };
        if odd {
            solve_columns();
        }
        self.workers.share(0..rows, |rows| {
            lattice::solve_rows(level, sheet, weft, rows);
        });
        if !odd {
            solve_columns();
        }
    }
}

/// Internal viscosity, and inertia in the same sweep where there is one. Returns how many particles moved: the first ones.
pub fn integrate(
    substep: &Substep,
    topology: &Topology,
    material: &Coefficients,
    verlet: Verlet,
    particles: &mut Particles,
) -> usize {
    let seconds_before = particles.state.substep_seconds;
    let damped = material.viscosity > 0.0
        && seconds_before > 0.0
        && !particles.is_empty()
        && particles.len() == topology.particles();
    if !damped {
        return 0;
    }
    let density = particles.input.areal_density;
    let Particles {
        state:
            State {
                position,
                previous_position,
                lost_displacement,
                ..
            },
        input:
            Input {
                acceleration,
                mass,
                inv_mass,
                ..
            },
        scratch: Scratch {
            lambda: scratch, ..
        },
        ..
    } = particles;
    let rigid = RigidMotion::fit(mass, position, previous_position);
    match &topology.layout {
        Layout::Sheet(SheetLayout { lattice, .. }) => {
            let area = lattice.spacing.x * lattice.spacing.y;
            // ν = c L²/(4 h) on a square grid.
            let c = (4.0 * material.viscosity * seconds_before / area).min(viscosity::LARGEST);
            let motion = SheetMotion {
                sheet: bare(lattice, position, inv_mass),
                previous: SharedPoints::new(previous_position),
                lost: SharedPoints::new(lost_displacement),
                acceleration: (!acceleration.is_empty()).then_some(&*acceleration),
                conductance: 0.25 * c * density * area,
                rigid,
                verlet,
            };
            sweep(substep, motion, scratch);
            motion.sheet.columns * motion.sheet.rows
        }
        Layout::Mesh(fabric) => {
            let viscosity = material.viscosity * seconds_before;
            mesh::exchange(
                fabric,
                position,
                previous_position,
                lost_displacement,
                inv_mass,
                rigid,
                viscosity,
                density,
            );
            0
        }
    }
}

/// A sheet without contacts.
pub fn bare<'a>(lattice: &Lattice, position: &'a mut Points, inv_mass: &'a mut [f32]) -> Sheet<'a> {
    Sheet {
        columns: lattice.columns as usize,
        rows: lattice.rows as usize,
        position: SharedPoints::new(position),
        inv_mass: Shared::new(inv_mass),
        normal: None,
        pressed: None,
        give: Give::default(),
        lengths: None,
    }
}

/// Moves a sheet, in blocks of rows, one for each part of the workers.
fn sweep(substep: &Substep, motion: SheetMotion, scratch: &mut Vec<f32>) {
    let (level, workers) = (substep.level, substep.workers);
    let rows = motion.sheet.rows;
    let part = workers.part(rows);
    if part == rows {
        motion.sweep(level, 0..rows, Beside::default());
        return;
    }
    // Of each seam between blocks the row above and the row below.
    let len = motion.saved_len();
    scratch.resize(2 * len * (rows.div_ceil(part) - 1), 0.0);
    for (k, seam) in scratch.chunks_exact_mut(2 * len).enumerate() {
        let (above, below) = seam.split_at_mut(len);
        motion.save_row(level, (k + 1) * part - 1, above);
        motion.save_row(level, (k + 1) * part, below);
    }
    let seam = |k: usize| scratch.get(2 * len * k..2 * len * (k + 1));
    workers.share(0..rows, |rows| {
        let block = rows.start / part;
        let beside = Beside {
            above: block.checked_sub(1).and_then(seam).map(|s| &s[..len]),
            below: seam(block).map(|s| &s[len..]),
        };
        motion.sweep(level, rows, beside);
    });
}
