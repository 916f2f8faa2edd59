use std::collections::HashSet;

use crate::properties::*;

use super::*;
use crate::topology::{
    mesh_edges::MeshEdges,
    test_meshes::{delaunay, grid, hash, random, shuffle},
};

struct Built {
    weave: Weave,
    chains: Chains,
    order: Vec<u32>,
}

fn build(positions: &[Vec3], triangles: &[[u32; 3]]) -> Built {
    let edges = MeshEdges::new(positions.len(), triangles);
    let weave = Weave::new(positions, triangles, &edges, None);
    let (chains, order) = Chains::build(positions, &weave);
    Built {
        weave,
        chains,
        order,
    }
}

/// The links of each chain of a batch.
fn lanes(chains: &Chains, batch: &ChainBatch) -> Vec<Vec<usize>> {
    let slots = |lane| (0..batch.length).map(move |k| batch.slots.start + k * LANES + lane);
    (0..LANES)
        .map(|lane| {
            slots(lane)
                .take_while(|slot| chains.particle[*slot] != NONE)
                .collect()
        })
        .collect()
}

/// Every edge along the threads is in one chain, with its length and scale; no particle is twice in a pass, but where a ring closes.
fn check(positions: &[Vec3], built: &mut Built) -> Result<(), TestCaseError> {
    let Built {
        weave,
        chains,
        order,
    } = built;
    let mut sorted = order.clone();
    sorted.sort_unstable();
    prop_assert_eq!(sorted, (0..positions.len() as u32).collect::<Vec<_>>());
    let stored: Vec<Vec3> = order.iter().map(|i| positions[*i as usize]).collect();
    weave.renumber(&inverse(order));

    let mut found = Vec::new();
    let mut next_batch = 0;
    let mut next_slot = 0;
    for pass in &chains.passes {
        prop_assert_eq!(pass.batches.start, next_batch);
        next_batch = pass.batches.end;
        let mut seen = HashSet::new();
        for batch in &chains.batches[pass.batches.clone()] {
            prop_assert_eq!(batch.slots.start, next_slot);
            prop_assert_eq!(batch.slots.len(), batch.length * LANES);
            next_slot = batch.slots.end;
            let lanes = lanes(chains, batch);
            prop_assert_eq!(lanes.iter().map(Vec::len).max(), Some(batch.length));
            let mut covered = 0;
            for (l, lane) in lanes.into_iter().enumerate() {
                covered += lane.len();
                prop_assert!(lane.len() != 1);
                let closing = batch.closing.map_or(OPEN, |closing| closing[l]);
                let mut once = &lane[..];
                if closing != OPEN {
                    prop_assert_eq!(closing as usize + 2, lane.len());
                    let [first, last] = [lane[0], lane[lane.len() - 1]];
                    prop_assert_eq!(chains.particle[first], chains.particle[last]);
                    once = &lane[1..];
                }
                for slot in once {
                    prop_assert!(seen.insert(chains.particle[*slot]), "twice in a pass");
                }
                for link in lane.windows(2) {
                    let [a, b] = [chains.particle[link[0]], chains.particle[link[1]]];
                    let ends = [a.min(b), a.max(b)];
                    let edge = weave.ends.binary_search(&ends);
                    let Ok(edge) = edge else {
                        return Err(TestCaseError::fail("no edge"));
                    };
                    prop_assert_eq!(weave.family[edge], pass.family);
                    prop_assert_eq!(weave.scale[edge], chains.scale[link[0]]);
                    let length = stored[a as usize].distance(stored[b as usize]);
                    prop_assert!((length - chains.rest_length[link[0]]).abs() < 1e-6);
                    found.push(edge);
                }
                if let Some(last) = lane.last() {
                    prop_assert_eq!((chains.rest_length[*last], chains.scale[*last]), (0.0, 0.0));
                }
            }
            let filled = chains.particle[batch.slots.clone()]
                .iter()
                .filter(|p| **p != NONE);
            prop_assert_eq!(filled.count(), covered);
        }
    }
    prop_assert_eq!(next_batch, chains.batches.len());
    prop_assert_eq!(next_slot, chains.particle.len());
    prop_assert_eq!(chains.rest_length.len(), next_slot);
    prop_assert_eq!(chains.scale.len(), next_slot);
    found.sort_unstable();
    let aligned: Vec<usize> = (0..weave.ends.len())
        .filter(|e| weave.family[*e] != EdgeFamily::Shear)
        .collect();
    prop_assert_eq!(found, aligned);
    Ok(())
}

proptest! {
    #[test]
    fn any_triangles_are_covered(
        corners in prop::collection::vec((0u32..30, 0u32..30, 0u32..30), 0..80),
        seed in 0u64..1000,
    ) {
        let positions: Vec<Vec3> = (0..30)
            .map(|i| Vec3::new(random(3 * i, seed), random(3 * i + 1, seed), 0.2 * random(3 * i + 2, seed)))
            .collect();
        let triangles: Vec<[u32; 3]> = corners
            .into_iter()
            .map(|(a, b, c)| [a, b, c])
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        check(&positions, &mut build(&positions, &triangles))?;
    }

    #[test]
    fn jittered_grids_are_covered(columns in 2usize..40, rows in 2usize..40, jitter in 0.0f32..0.8, seed in 0u64..1000) {
        let (mut positions, triangles) =
            grid(columns, rows, [1.0, 1.0], |c, r| hash(c + 1000 * r, seed).is_multiple_of(2));
        for (i, p) in positions.iter_mut().enumerate() {
            p.x += jitter * (random(2 * i, seed) - 0.5);
            p.y += jitter * (random(2 * i + 1, seed) - 0.5);
        }
        let (positions, triangles) = shuffle(&positions, &triangles, seed);
        check(&positions, &mut build(&positions, &triangles))?;
    }

    #[test]
    fn chains_of_a_shuffled_grid_are_its_rows_and_columns(
        columns in 2usize..40,
        rows in 2usize..40,
        seed in 0u64..1000,
    ) {
        let (positions, triangles) =
            grid(columns, rows, [1.0, 1.0], |c, r| hash(c + 1000 * r, seed).is_multiple_of(2));
        let (shuffled, triangles) = shuffle(&positions, &triangles, seed);
        let mut built = build(&shuffled, &triangles);
        check(&shuffled, &mut built)?;
        let Built { chains, order, .. } = &built;
        prop_assert_eq!(chains.passes.len(), 2);
        for pass in &chains.passes {
            let length = if pass.family == EdgeFamily::Warp { rows } else { columns };
            for batch in &chains.batches[pass.batches.clone()] {
                for lane in lanes(chains, batch) {
                    prop_assert!(lane.is_empty() || lane.len() == length);
                }
            }
        }
        // Storage runs along the lanes, and adjacent lanes are adjacent on the mesh.
        let first = &chains.batches[chains.passes[0].batches.clone()];
        let mut stored = 0;
        for batch in first {
            for slot in batch.slots.clone().filter(|slot| chains.particle[*slot] != NONE) {
                prop_assert_eq!(chains.particle[slot], stored);
                stored += 1;
                if slot % LANES > 0 {
                    let [a, b] = [slot - 1, slot].map(|s| shuffled[order[chains.particle[s] as usize] as usize]);
                    prop_assert!((a.distance(b) - 1.0).abs() < 1e-4);
                }
            }
        }
        prop_assert_eq!(stored as usize, positions.len());
    }
}

/// A tube whose rings are closed, along y.
fn tube(around: usize, along: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let positions = (0..around * along)
        .map(|i| {
            let angle = (i % around) as f32 / around as f32 * std::f32::consts::TAU;
            Vec3::new(angle.cos(), (i / around) as f32 * 0.3, angle.sin())
        })
        .collect();
    let at = |c: usize, r: usize| (r * around + c % around) as u32;
    let triangles = (0..(along - 1) * around)
        .flat_map(|i| {
            let (c, r) = (i % around, i / around);
            [
                [at(c, r), at(c, r + 1), at(c + 1, r)],
                [at(c + 1, r), at(c, r + 1), at(c + 1, r + 1)],
            ]
        })
        .collect();
    (positions, triangles)
}

#[test]
fn rings_are_closed_and_start_side_by_side() -> Result<(), TestCaseError> {
    let (positions, triangles) = tube(24, 12);
    let (positions, triangles) = shuffle(&positions, &triangles, 5);
    let mut built = build(&positions, &triangles);
    check(&positions, &mut built)?;
    let passes: Vec<(EdgeFamily, usize)> = built
        .chains
        .passes
        .iter()
        .map(|pass| (pass.family, built.chains.batches[pass.batches.start].length))
        .collect();
    assert_eq!(passes, [(EdgeFamily::Weft, 25), (EdgeFamily::Warp, 12)]);
    let closing = built.chains.batches[0].closing;
    assert!(closing.is_some_and(|all| all[..12] == [23; 12] && all[12..] == [OPEN; 4]));
    let starts = built.chains.particle[..12]
        .iter()
        .map(|p| positions[built.order[*p as usize] as usize]);
    let angles: Vec<f32> = starts.map(|p| p.z.atan2(p.x)).collect();
    for angle in &angles {
        assert!((angle - angles[0]).abs() < 1e-3, "{angles:?}");
    }
    Ok(())
}

#[test]
fn a_wheel_of_many_spokes_takes_many_passes() -> Result<(), TestCaseError> {
    let spokes = 400;
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..spokes).map(|i| {
        let angle = i as f32 / spokes as f32 * std::f32::consts::TAU;
        Vec3::new(angle.cos(), angle.sin(), 0.0)
    }));
    let triangles: Vec<[u32; 3]> = (0..spokes)
        .map(|i| [0, i + 1, (i + 1) % spokes + 1])
        .collect();
    check(&positions, &mut build(&positions, &triangles))
}

/// Equilateral triangles of side 1, their rows along x.
fn equilateral(columns: usize, rows: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, triangles) = grid(columns, rows, [1.0, 0.75f32.sqrt()], |_, r| r % 2 == 0);
    for (i, p) in positions.iter_mut().enumerate() {
        p.x += 0.5 * (i / columns % 2) as f32;
    }
    (positions, triangles)
}

#[test]
fn equilateral_triangles_hang_by_long_chains_and_can_shear() -> Result<(), TestCaseError> {
    let (positions, triangles) = equilateral(20, 20);
    let (positions, triangles) = shuffle(&positions, &triangles, 4);
    let mut built = build(&positions, &triangles);
    check(&positions, &mut built)?;
    let threads = |family| built.weave.family.iter().filter(|f| **f == family).count();
    assert_eq!(threads(EdgeFamily::Weft), 20 * 19);
    assert!(threads(EdgeFamily::Warp) > 19 * 19);
    assert!(threads(EdgeFamily::Shear) > 17 * 19);
    assert_eq!(built.chains.passes.len(), 2);
    Ok(())
}

#[test]
fn the_same_mesh_gives_the_same_chains() {
    let (positions, triangles) = delaunay(16, 1);
    let [a, b] = [0, 1].map(|_| build(&positions, &triangles));
    assert_eq!(a.chains, b.chains);
    assert_eq!(a.order, b.order);
}

#[test]
fn an_irregular_square_is_covered() -> Result<(), TestCaseError> {
    for seed in 0..4 {
        let (positions, triangles) = delaunay(20, seed);
        check(&positions, &mut build(&positions, &triangles))?;
    }
    Ok(())
}
