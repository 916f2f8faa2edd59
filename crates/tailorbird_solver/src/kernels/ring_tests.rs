//! Tests of rings.

use crate::properties::*;
use bevy_math::Vec3;

use super::{
    lanes::{Shared, SharedPoints, levels},
    lines::{Give, LEAST_COMPLIANCE},
    mesh::{Mesh, solve_chains},
};
use crate::{
    numbers::unit_of,
    points::Points,
    shape::ClothShape,
    topology::{Topology, fabric::Fabric},
};

/// A tube of so many rings, 1 m apart, of so many edges each and a radius of 1 m.
fn tube(around: u32, rings: u32) -> Topology {
    let vertices = (0..around * rings).map(|i| {
        let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
        Vec3::new(angle.cos(), (i / around) as f32, angle.sin())
    });
    let at = |c: u32, r: u32| r * around + c % around;
    let triangles = (0..(rings - 1) * around).flat_map(|i| {
        let (c, r) = (i % around, i / around);
        let [a, b, d, e] = [at(c, r), at(c, r + 1), at(c + 1, r), at(c + 1, r + 1)];
        [a, b, d, d, b, e]
    });
    let vertices: Vec<Vec3> = vertices.collect();
    let cloth = ClothShape::mesh(vertices, triangles.collect::<Vec<u32>>());
    Topology::build(&cloth, Vec3::ONE).expect("valid")
}

fn fabric(topology: &Topology) -> &Fabric {
    topology.fabric().expect("no grid")
}

/// Solves the rings alone, so many times.
fn solve(fabric: &Fabric, position: &mut Points, inv_mass: &mut [f32], give: Give, times: usize) {
    let chains = &fabric.chains;
    let rings = (chains.passes.iter())
        .filter(|pass| {
            let mut batches = chains.batches[pass.batches.clone()].iter();
            batches.all(|batch| batch.closing.is_some())
        })
        .collect::<Vec<_>>();
    assert_eq!(rings.len(), 1, "all rings in one pass");
    for _ in 0..times {
        let mesh = Mesh {
            fabric,
            position: SharedPoints::new(position),
            inv_mass: Shared::new(inv_mass),
            normal: None,
            pressed: None,
            rest_length: &chains.rest_length,
            give,
        };
        let level = levels()[0];
        solve_chains(level, mesh, 0.0, rings[0].batches.clone());
    }
}

/// Shortest and longest edge around, relative to their length at rest.
fn around(fabric: &Fabric, position: &Points) -> [f32; 2] {
    let edges = fabric.chains.edges().filter(|(ends, _)| {
        let [a, b] = ends.map(|i| position.get(i as usize));
        (a.y - b.y).abs() < 0.5
    });
    let parts = edges.map(|(ends, length)| {
        let [a, b] = ends.map(|i| position.get(i as usize));
        a.distance(b) / length
    });
    parts.fold([f32::INFINITY, 0.0], |[low, high], part| {
        [low.min(part), high.max(part)]
    })
}

fn widened(topology: &Topology, times: f32) -> Points {
    let wider = Vec3::new(times, 1.0, times);
    topology.rest_positions.iter().map(|p| *p * wider).collect()
}

/// A ring solved as a chain that is cut somewhere would be longer there.
#[test]
fn a_ring_that_is_too_wide_shrinks_evenly() {
    for (n, times) in [(5, 1.1), (24, 1.1), (24, 0.9), (200, 1.05)] {
        let topology = tube(n, 3);
        let fabric = fabric(&topology);
        let mut position = widened(&topology, times);
        let mut inv_mass = vec![1.0; position.len()];
        let mut strain = (times - 1.0_f32).abs();
        for _ in 0..3 {
            solve(fabric, &mut position, &mut inv_mass, Give::default(), 1);
            let [low, high] = around(fabric, &position);
            assert!(high - low < 2e-4, "{n} × {times}: {low} to {high}");
            // Newton's: the square is left, and what the least compliance leaves, which is the more the less a ring is curved.
            let curved = 4.0 * (std::f32::consts::PI / n as f32).sin().powi(2);
            let left = 2.0 * LEAST_COMPLIANCE / (curved + 2.0 * LEAST_COMPLIANCE);
            let most = strain * strain + left * strain + 1e-4;
            let is = (high - 1.0).abs().max((low - 1.0).abs());
            assert!(is <= most, "{n} × {times}: {low} to {high}, {most}");
            strain = is;
        }
    }
}

/// A ring that is held at one particle, and so at both ends of its chain, keeps that particle in place.
#[test]
fn a_ring_that_is_held_stays_there() {
    let topology = tube(24, 3);
    let fabric = fabric(&topology);
    for held in 0..topology.particles() {
        let mut position = widened(&topology, 1.1);
        let start = position.get(held);
        let mut inv_mass = vec![1.0; position.len()];
        inv_mass[held] = 0.0;
        solve(fabric, &mut position, &mut inv_mass, Give::default(), 20);
        assert_eq!(position.get(held), start);
        let [low, high] = around(fabric, &position);
        assert!(low > 0.99 && high < 1.02, "{held}: {low} to {high}");
    }
}

/// Tension beyond the stable limit of a substep is shared all around as well.
#[test]
fn a_ring_that_is_far_too_wide_shrinks_without_a_seam() {
    let topology = tube(64, 3);
    let fabric = fabric(&topology);
    let mut position = widened(&topology, 2.0);
    let mut inv_mass = vec![1.0; position.len()];
    let mut before = 2.0;
    for _ in 0..10 {
        solve(fabric, &mut position, &mut inv_mass, Give::default(), 1);
        let [low, high] = around(fabric, &position);
        assert!(high < before + 1e-3, "{low} to {high}, {before}");
        assert!(high - low < 1e-3, "{low} to {high}");
        before = high;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Forces of the edges alone conserve momentum and angular momentum, whatever is asked for, and however the edges lie.
    #[test]
    fn rings_keep_their_momentum(
        n in 3_u32..40,
        seed in 0_u32..1000,
        jitter in 0.0_f32..0.5,
        times in 0.5_f32..2.0,
        soft in 0.0_f32..0.1,
    ) {
        let topology = tube(n, 4);
        let fabric = fabric(&topology);
        let random = |i: usize, k: u32| unit_of(4 * i as u32 + k + 1000 * seed);
        let start: Points = widened(&topology, times)
            .iter()
            .enumerate()
            .map(|(i, p)| p + jitter * Vec3::new(random(i, 0), random(i, 1), random(i, 2)))
            .collect();
        let mut position = start.clone();
        let mut inv_mass: Vec<f32> = (0..start.len()).map(|i| 1.5 + random(i, 3)).collect();
        let give = Give { compliance: soft.max(LEAST_COMPLIANCE), pull: 20.0, push: 1.3 };
        solve(fabric, &mut position, &mut inv_mass, give, 2);
        let mut momentum = Vec3::ZERO;
        let mut most = 1.0_f32;
        for (i, w) in inv_mass.iter().enumerate() {
            let moved = position.get(i) - start.get(i);
            prop_assert!(moved.is_finite());
            momentum += moved / w;
            most = most.max(moved.length());
        }
        let n = inv_mass.len() as f32;
        prop_assert!(momentum.length() < 2e-6 * n * most, "{momentum}, {most}");
    }
}
