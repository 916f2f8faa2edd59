//! Times of the kernels.

use bevy_math::{DVec3, Isometry3d, UVec2, Vec2, Vec3};
use fearless_simd::Level;

use tailorbird_solver::{
    instruction_set::ClothInstructionSet,
    kernels::{
        aerodynamics::{Air, AirSheet, drag_and_lift_on_sheet},
        breeze::{self, Breeze},
        contact::{Out, Phase, Touching},
        distance,
        edges::LineStiffness,
        half_space::{self, MovingHalfSpace},
        lanes::{Shared, SharedPoints},
        lattice::{self, Sheet},
        limit::{self, Backstop, Limits},
        lines::Give,
        normals,
        rigid_motion::RigidMotion,
        shear::{self, Shear},
        sphere::{self, MovingSphere},
        tether::{self, Straight, Tether},
        verlet::Verlet,
        viscosity::{Beside, SheetMotion},
    },
    numbers::Numbers,
    points::Points,
    shape::ClothShape,
    topology::{Topology, lattice::Lattice},
    wall_clock::WallClock,
    wind::{ClothTurbulence, WindRegion},
};

/// The time of one kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelTime {
    /// Name of the kernel.
    pub name: &'static str,
    /// Time for each particle \[ns\]: the best of several.
    pub ns_per_particle: f64,
    /// Constraints for each particle; 0 for a kernel without.
    pub constraints_per_particle: f64,
}

impl KernelTime {
    /// Time for each constraint \[ns\]; none where there is none.
    pub fn ns_per_constraint(&self) -> Option<f64> {
        let any = self.constraints_per_particle > 0.0;
        any.then(|| self.ns_per_particle / self.constraints_per_particle)
    }
}

/// Between neighbours \[m\].
const SPACING: f32 = 0.01;

/// Of each particle \[kg\].
const MASS: f32 = 1.5e-5;

/// Length of a substep \[s\].
const SECONDS: f32 = 1e-3;

/// Particles that a sample goes over, at least.
const VISITS: usize = 200_000;

/// Samples of which the best counts.
const SAMPLES: usize = 20;

/// Measures the kernels, on one thread, on a wavy sheet of `size` × `size` particles (at least 2 × 2), with the best
/// instructions of the machine that belong to `instruction_set`. The plain relaxation of the classic solver, `distance`, is
/// scalar with any.
///
/// It takes about a tenth of a second for each million particles and kernel.
pub fn measure(size: u32, instruction_set: ClothInstructionSet) -> Vec<KernelTime> {
    let level = instruction_set.level();
    let side = size.max(2);
    let mut times = Times {
        particles: (side * side) as usize,
        all: Vec::new(),
    };
    of_constraints(&mut times, level, side);
    of_particles(&mut times, level, side);
    of_relaxation(&mut times, side);
    times.all
}

/// Measured times.
struct Times {
    particles: usize,
    all: Vec<KernelTime>,
}

impl Times {
    /// Measures a kernel that holds this many constraints.
    fn add(&mut self, name: &'static str, constraints: usize, mut kernel: impl FnMut()) {
        let particles = self.particles;
        let passes = VISITS.div_ceil(particles);
        let sample = |_| {
            let start = WallClock::start();
            for _ in 0..passes {
                kernel();
            }
            start.elapsed().as_secs_f64() * 1e9 / (passes * particles) as f64
        };
        self.all.push(KernelTime {
            name,
            ns_per_particle: (0..SAMPLES).map(sample).fold(f64::MAX, f64::min),
            constraints_per_particle: constraints as f64 / particles as f64,
        });
    }
}

/// A sheet near rest, with waves, so that no tether of it is taut.
fn wavy(side: u32) -> Points {
    let at = |i: u32| {
        let (x, y) = ((i % side) as f32, (i / side) as f32);
        Vec3::new(0.998 * x, -0.998 * y, 0.4 * (0.16 * (x + y)).sin()) * SPACING
    };
    (0..side * side).map(at).collect()
}

/// The kernels of the chain solver that hold constraints.
fn of_constraints(times: &mut Times, level: Level, side: u32) {
    let n = side as usize;
    let mut position = wavy(side);
    let corner = position.get(n - 1);
    let mut inv_mass = Numbers::from(vec![1.0 / MASS; n * n]);
    let sheet = Sheet {
        columns: n,
        rows: n,
        position: SharedPoints::new(&mut position),
        inv_mass: Shared::new(&mut inv_mass),
        normal: None,
        pressed: None,
        give: Give::default(),
        lengths: None,
    };
    let line = LineStiffness {
        rest_length: SPACING,
        stretch: 0.0,
        bend: 1e6,
        mass: MASS,
    };
    let shear = Shear {
        rest_length: SPACING.hypot(SPACING),
        alpha_tilde: 1e3,
        rising_first: false,
    };
    // Edges and triples.
    let of_lines = n * (n - 1) + n * (n - 2);
    times.add("columns", of_lines, || {
        lattice::solve_columns(level, sheet, line, 0..n);
    });
    times.add("rows", of_lines, || {
        lattice::solve_rows(level, sheet, line, 0..n);
    });
    times.add("shear", 2 * (n - 1) * (n - 1), || {
        shear::solve(level, sheet, shear, 0..n);
    });
    let tether = |anchor, column| {
        let distances = Straight {
            column,
            row: 0,
            spacing: Vec2::splat(SPACING),
        };
        Some(Tether {
            anchor,
            anchor_before: anchor,
            longer: 1.0,
            distances,
        })
    };
    let tethers = [tether(Vec3::ZERO, 0), tether(corner, side - 1)];
    times.add("tethers", 2 * n * n, || {
        tether::solve_straight(level, sheet, &tethers, (1.001, None), 0..n);
    });
}

/// The kernels that move particles, keep them out of colliders, or look at them.
fn of_particles(times: &mut Times, level: Level, side: u32) {
    let n = side as usize;
    let mut position = wavy(side);
    let (mut previous, mut lost) = (position.clone(), Points::zeroed(n * n));
    let mut inv_mass = Numbers::from(vec![1.0 / MASS; n * n]);
    // Without gravity, so that the sheet stays where it is.
    let verlet = Verlet {
        seconds: SECONDS,
        seconds_before: SECONDS,
        damping: 0.1,
        gravity: Vec3::ZERO,
    };
    times.add("rigid motion", 0, || {
        std::hint::black_box(RigidMotion::fit(&inv_mass, &position, &previous));
    });
    times.add("inertia", 0, || {
        verlet.step(
            level,
            &mut position,
            &mut previous,
            &mut lost,
            None,
            &inv_mass,
            0..inv_mass.len(),
        );
    });
    let particles = Touching {
        position: SharedPoints::new(&mut position),
        previous: SharedPoints::new(&mut previous),
        inv_mass: Shared::new(&mut inv_mass),
        contacts: None,
        phase: Phase::Final,
        out: Out {
            most: f32::INFINITY,
            overlaps: &std::sync::atomic::AtomicBool::new(false),
        },
    };
    let motion = SheetMotion {
        sheet: Sheet {
            columns: n,
            rows: n,
            position: particles.position,
            inv_mass: particles.inv_mass,
            normal: None,
            pressed: None,
            give: Give::default(),
            lengths: None,
        },
        previous: particles.previous,
        lost: SharedPoints::new(&mut lost),
        acceleration: None,
        conductance: 0.01 * MASS,
        rigid: RigidMotion::default(),
        verlet,
    };
    times.add("viscosity and inertia", 0, || {
        motion.sweep(level, 0..n, Beside::default());
    });
    let below = Vec3::NEG_Z * (1.0 + SPACING);
    let ball = MovingSphere {
        from: below,
        to: below,
        rotation: Vec3::ZERO,
        radius: 1.0,
        friction: 0.5,
    };
    times.add("sphere", n * n, || {
        std::hint::black_box(sphere::collide_all(level, &ball, particles, 0..n * n));
    });
    let ground = MovingHalfSpace {
        from: below,
        to: below,
        normal: Vec3::Z,
        margin: 0.0,
        friction: 0.5,
    };
    times.add("half-space", n * n, || {
        std::hint::black_box(half_space::collide_all(level, &ground, particles, 0..n * n));
    });
    let lattice = Lattice {
        columns: side,
        rows: side,
        spacing: Vec2::splat(SPACING),
    };
    let mut found = Points::zeroed(n * n);
    times.add("normals", 0, || {
        let found = SharedPoints::new(&mut found);
        normals::smooth_lattice(level, &lattice, &position, found, 0..n);
    });
    let turbulence = ClothTurbulence {
        speed: 1.0,
        ..ClothTurbulence::default()
    };
    let breeze = Breeze {
        velocity: Vec3::X,
        waves: Some(turbulence.waves(0.0, DVec3::ZERO)),
        shape: WindRegion::Everywhere,
        falloff: 0.0,
        to_own: Isometry3d::IDENTITY,
    };
    times.add("turbulence", 0, || {
        let found = SharedPoints::new(&mut found);
        breeze::add(level, &breeze, SECONDS, &position, found, 0..n * n);
    });
    let air = Air {
        wind: Vec3::new(3.0, -1.0, 7.0),
        density: 1.225,
        areal_density: 0.15,
        drag: 1.2,
        lift: 0.7,
        seconds: SECONDS,
    };
    times.add("drag and lift", 0, || {
        let air_sheet = AirSheet {
            lattice: &lattice,
            position: &position,
            previous: &previous,
            inv_mass: &inv_mass,
            acceleration: SharedPoints::new(&mut found),
        };
        drag_and_lift_on_sheet(level, air_sheet, air, 1.0 / SECONDS, 0..n);
    });
    let targets = position.clone();
    let normals: Points = (0..n * n).map(|_| Vec3::Z).collect();
    let (most, distance, radius) = (vec![0.1; n * n], vec![0.05; n * n], vec![1.0; n * n]);
    let limits = Limits {
        targets: [&targets, &targets],
        fractions: (0.25, 0.5),
        max_distance: &most,
        backstop: Some(Backstop {
            normals: [&normals, &normals],
            distance: &distance,
            radius: &radius,
        }),
    };
    times.add("limits", n * n, || {
        let (position, previous) = (
            SharedPoints::new(&mut position),
            SharedPoints::new(&mut previous),
        );
        let inv_mass = Shared::new(&mut inv_mass);
        limit::hold(level, limits, position, previous, inv_mass, 0..n * n);
    });
}

/// The classic solver, on all constraints of such a sheet.
fn of_relaxation(times: &mut Times, side: u32) {
    let size = Vec2::splat((side - 1) as f32 * SPACING);
    let cloth = ClothShape::grid(size, UVec2::splat(side));
    let Ok(topology) = Topology::build(&cloth, Vec3::ONE) else {
        return;
    };
    let mut position = wavy(side);
    let inv_mass = vec![1.0 / MASS; position.len()];
    let all = topology.constraints();
    times.add("distance", all.len(), || {
        for batch in &all.batches {
            let range = batch.range.clone();
            distance::solve_rigid(
                &all.ends[range.clone()],
                &all.rest_lengths[range],
                &inv_mass,
                &mut position,
            );
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kernel_takes_time() {
        for instruction_set in [ClothInstructionSet::Scalar, ClothInstructionSet::Auto] {
            let times = measure(20, instruction_set);
            assert_eq!(times.len(), 14);
            for time in times {
                assert!(time.ns_per_particle > 0.0, "{time:?}");
                let constraints = time.ns_per_constraint();
                assert_eq!(constraints.is_some(), time.constraints_per_particle > 0.0);
            }
        }
    }
}
