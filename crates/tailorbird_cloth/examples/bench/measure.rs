//! Takes one measurement.

use std::{collections::HashSet, time::Duration};

use tailorbird_cloth::wall_clock::WallClock;

use bevy_math::Vec3;
use tailorbird_cloth::{prelude::*, tethers::ClothTethers, topology::Topology};

use super::{
    cli::Args,
    record::Record,
    scene::{Scene, Setup},
};

/// In the last quarter each tenth step is looked at.
const EVERY: u32 = 10;

/// Topologies that are built to time one.
const BUILDS: usize = 5;

/// Runs a setup. Stretch is averaged over the steps that are looked at, the largest is that of all.
pub fn measure(setup: &Setup, args: &Args) -> Record {
    let total = args.steps.unwrap_or(setup.scene.steps());
    let topology_ms = topology_ms(&setup.cloth());
    let mut app = setup.app(args);
    let mut times = Vec::with_capacity(total as usize);
    let mut looks = 0;
    let (mut mean, mut p99, mut max, mut compression) = (0.0, 0.0, 0.0_f64, 0.0);
    let mut cloths = app.world_mut().query::<(
        &ClothParticles,
        &ClothTopology,
        &ClothNormals,
        &ClothTethers,
    )>();
    for step in 1..=total {
        app.update();
        times.push(app.world().resource::<ClothStepTime>().total);
        if step > total - total / 4 && step.is_multiple_of(EVERY) {
            for (particles, topology, ..) in cloths.iter(app.world()) {
                let stretch = particles.stretch(topology);
                looks += 1;
                mean += f64::from(stretch.mean);
                p99 += f64::from(stretch.p99);
                max = max.max(f64::from(stretch.max));
                compression += compression_of(particles, topology);
            }
        }
    }
    let (mut particles, mut bytes) = (0, 0);
    let mut counted = HashSet::new();
    for (state, topology, normals, tethers) in cloths.iter(app.world()) {
        particles += state.len();
        bytes += state.memory_bytes() + normals.memory_bytes() + tethers.memory_bytes();
        // Equal shapes share one.
        if counted.insert(topology.revision) {
            bytes += topology.memory_bytes();
        }
    }
    let substeps = app.world().resource::<ClothStep>().substeps();
    let ms = median(times).as_secs_f64() * 1e3;
    let looks = f64::from(looks.max(1));
    Record {
        solver: match setup.solver {
            ClothSolver::Chains => "chains",
            ClothSolver::GaussSeidel => "gauss-seidel",
        },
        scene: setup.scene.name(),
        size: setup.size,
        passes: substeps * setup.iterations,
        ms,
        stretch_mean: mean / looks,
        stretch_p99: p99 / looks,
        stretch_max: max,
        substeps,
        automatic: setup.substeps.is_none(),
        iterations: setup.iterations,
        compression_mean: matches!(setup.scene, Scene::Drape | Scene::DrapePinned)
            .then_some(compression / looks),
        ns_per_particle_substep: ms * 1e6 / (particles as f64 * f64::from(substeps)),
        particles,
        bytes_per_particle: bytes as f64 / particles.max(1) as f64,
        topology_ms,
    }
}

/// Time to build the topology [ms].
fn topology_ms(cloth: &Cloth) -> f64 {
    let times = (0..BUILDS).map(|_| {
        let start = WallClock::start();
        std::hint::black_box(Topology::build(&cloth.shape, Vec3::ONE).is_ok());
        start.elapsed()
    });
    median(times.collect()).as_secs_f64() * 1e3
}

/// Mean of max(0, 1 − l/L) over the edges [-].
fn compression_of(particles: &ClothParticles, topology: &Topology) -> f64 {
    let edges = topology.stretch_edges();
    let count = edges.len().max(1);
    let sum: f64 = edges
        .into_iter()
        .map(|([a, b], rest)| {
            let [p, q] = [a, b].map(|i| particles.points().get(i as usize));
            let length = p.distance(q);
            f64::from((1.0 - length / rest).max(0.0))
        })
        .sum();
    sum / count as f64
}

/// The middle one, or the longer one of the middle two; zero where there is none.
pub fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
