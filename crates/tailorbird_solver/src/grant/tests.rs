//! Tests of grants.

use crate::properties::*;
use bevy_math::{UVec2, Vec2, Vec3};

use super::*;
use crate::{
    effort::Effort,
    shape::ClothShape,
    topology::{Topology, fabric::Fabric, test_meshes::delaunay},
};

const SECONDS: f32 = 1.0 / 60.0;

fn mesh(seed: u64) -> Topology {
    let (positions, triangles) = delaunay(12, seed);
    let cloth = ClothShape::mesh(positions, triangles.concat());
    Topology::build(&cloth, Vec3::ONE).expect("valid")
}

fn fabric(topology: &Topology) -> &Fabric {
    topology.fabric().expect("no grid")
}

fn moved(topology: &Topology, to: impl Fn(Vec3) -> Vec3) -> Points {
    topology.rest_positions.iter().map(|p| to(*p)).collect()
}

/// Excess of the edges' lengths over their granted lengths, as a part of those at rest: least and greatest [-].
fn beyond(grant: &Grant, fabric: &Fabric, position: &Points) -> [f32; 2] {
    let chains = &fabric.chains;
    let lengths = grant.chains(chains);
    let beyond = chains.slots().map(|(slot, ends)| {
        let [a, b] = ends.map(|i| position.get(i as usize));
        (a.distance(b) - lengths[slot]) / chains.rest_length[slot]
    });
    beyond.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Every edge then is about as long as granted, however it lies.
    #[test]
    fn what_is_stretched_evenly_is_granted_that(seed in 0_u64..100, u in 0.0_f32..0.3, v in 0.0_f32..0.3) {
        let topology = mesh(seed);
        let fabric = fabric(&topology);
        let position = moved(&topology, |p| p * Vec3::new(1.0 + u, 1.0 + v, 1.0));
        let mut grant = Grant::default();
        for _ in 0..60 {
            grant.renew(&topology.layout, &position, SECONDS, Effort::asking(true));
        }
        let [low, high] = beyond(&grant, fabric, &position);
        let most = u.max(v);
        let room = BORNE + 0.05 * most + taken_back(most) / GROWTH;
        prop_assert!(high < room + 0.01 && low > -0.05 * most - 1e-4, "{low} to {high}, {room}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The same for the rows, columns and diagonals of a sheet.
    #[test]
    fn what_a_sheet_is_stretched_by_it_is_granted(
        columns in 2_u32..20,
        rows in 2_u32..20,
        u in 0.0_f32..0.3,
        v in 0.0_f32..0.3,
    ) {
        let cloth = ClothShape::grid(Vec2::new(1.0, 2.0), UVec2::new(columns, rows));
        let topology = Topology::build(&cloth, Vec3::ONE).expect("valid");
        let lattice = *topology.lattice().expect("a grid");
        let position = moved(&topology, |p| p * Vec3::new(1.0 + v, 1.0 + u, 1.0));
        let mut grant = Grant::default();
        for _ in 0..60 {
            grant.renew(&topology.layout, &position, SECONDS, Effort::asking(true));
        }
        let n = topology.particles();
        let granted = |strain: f32| (strain - BORNE - taken_back(strain) / GROWTH).max(0.0);
        let [dx, dy] = lattice.spacing.to_array();
        let Some(lengths) = grant.sheet(n) else {
            prop_assert!(granted(u.max(v)) < 0.01, "{u}, {v}");
            return Ok(());
        };
        for [a, b] in lattice.edges() {
            let (length, rest, strain) = if b == a + 1 {
                (lengths.rows.get(a as usize), dx, v)
            } else {
                (lengths.columns.get(a as usize), dy, u)
            };
            let is = length / rest - 1.0;
            prop_assert!((is - granted(strain)).abs() < 0.01 + 0.05 * strain, "{is} of {strain}");
        }
        let diagonal = lengths.diagonals.get(0);
        let expected = (dx * (1.0 + granted(v))).hypot(dy * (1.0 + granted(u)));
        prop_assert!((diagonal - expected).abs() < 0.02 * expected, "{diagonal}, {expected}");
    }
}

#[test]
fn what_is_granted_is_taken_back_at_its_rate() {
    let topology = mesh(3);
    let fabric = fabric(&topology);
    let position = moved(&topology, |p| p * Vec3::new(1.2, 1.0, 1.0));
    let mut grant = Grant::default();
    for _ in 0..60 {
        grant.renew(&topology.layout, &position, SECONDS, Effort::asking(true));
    }
    let start = grant.largest();
    assert!((0.15..0.25).contains(&start), "{start}");
    let mut steps = 0;
    while grant.largest() > 0.5 * start {
        grant.renew(&topology.layout, &position, SECONDS, Effort::asking(false));
        steps += 1;
    }
    let half = steps as f32 * SECONDS;
    let [fastest, slowest] = [start, 0.5 * start].map(|g| 0.5 * start / (UNUSED * taken_back(g)));
    assert!((fastest..slowest + SECONDS).contains(&half), "{half} s");
    for _ in 0..300 {
        grant.renew(&topology.layout, &position, SECONDS, Effort::asking(false));
    }
    assert!(grant.is_empty());
    assert_eq!(grant.chains(&fabric.chains), &fabric.chains.rest_length[..]);
}

/// Runs a trial for so many steps on a cloth whose `strain` is a function of its grant; returns the last [granted, strain].
fn tried(
    trial: &mut Trial,
    steps: usize,
    mut granted: f32,
    strain: impl Fn(f32) -> f32,
) -> [f32; 2] {
    for _ in 0..steps {
        let is = strain(granted);
        if trial.grows(true, [granted, is]) {
            granted += 0.5 * (is - granted).max(0.0);
        }
        granted -= taken_back(granted) * SECONDS;
        granted = granted.max(0.0);
    }
    [granted, strain(granted)]
}

#[test]
fn a_demand_stays_granted_and_a_load_does_not() {
    let mut trial = Trial::None;
    let [granted, _] = tried(&mut trial, 300, 0.2, |_| 0.2);
    assert!(granted > 0.18, "{granted} of a demand of 0.2");
    assert!(matches!(trial, Trial::Demand { .. }), "{trial:?}");
    let mut trial = Trial::None;
    let [granted, _] = tried(&mut trial, 300, 0.2, |granted| granted + 0.05);
    assert_eq!(granted, 0.0);
    assert!(matches!(trial, Trial::Load), "{trial:?}");
    assert!(trial.grows(false, [0.0, 0.05]), "what is asked for changes");
}

#[test]
fn a_demand_with_a_load_on_it_stays_granted() {
    let mut trial = Trial::None;
    let [granted, _] = tried(&mut trial, 600, 0.3, |granted| granted.max(0.15) + 0.01);
    assert!((0.1..0.2).contains(&granted), "{granted}");
}

#[test]
fn what_is_not_finite_is_not_granted() {
    let topology = mesh(5);
    let fabric = fabric(&topology);
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        let mut position = moved(&topology, |p| p * 1.1);
        position.set(7, Vec3::splat(bad));
        let mut grant = Grant::default();
        for _ in 0..10 {
            grant.renew(&topology.layout, &position, SECONDS, Effort::asking(true));
        }
        let finite = |lengths: &[f32]| lengths.iter().all(|l| (0.0..1.0).contains(l));
        assert!(finite(grant.chains(&fabric.chains)), "{bad}");
        assert!(finite(grant.springs(&fabric.shear)), "{bad}");
        assert!(grant.largest() <= MOST, "{bad}");
    }
}
