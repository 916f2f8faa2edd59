use crate::properties::*;
use bevy_math::UVec2;

use super::*;
use crate::{
    shape::ClothShape,
    topology::{Topology, report::Finding},
};

fn repaired(positions: &[Vec3], indices: &[u32]) -> Repaired {
    Repaired::new(positions, indices, ClothShape::WELD_DISTANCE, Vec3::ONE)
}

/// A square of two triangles.
const SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

#[test]
fn a_clean_mesh_stays_as_it_is() {
    let repaired = repaired(&SQUARE, &[0, 1, 2, 0, 2, 3]);
    assert!(repaired.report.is_clean());
    assert_eq!(repaired.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(repaired.report.border_edges, 4);
    assert_eq!(repaired.report.islands.len(), 1);
}

#[test]
fn a_vertex_of_no_triangle_has_no_particle() {
    let far = Vec3::splat(9.0);
    let [a, b, c, d] = SQUARE;
    let repaired = repaired(&[far, a, b, far, c, d], &[1, 2, 4, 1, 4, 5]);
    assert_eq!(repaired.positions, SQUARE);
    assert_eq!(repaired.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(
        repaired.report.isolated,
        Finding {
            count: 2,
            first: 0,
            at: far
        }
    );
    assert_eq!(repaired.report.particles, 4);
}

#[test]
fn the_vertex_of_a_sliver_stays_with_its_triangle() {
    let [a, b, c, d] = SQUARE;
    let middle = b.midpoint(c);
    let repaired = repaired(&[a, b, c, d, middle], &[0, 1, 2, 0, 2, 3, 2, 4, 1]);
    assert_eq!(repaired.report.degenerate.count, 1);
    assert_eq!(repaired.report.degenerate.first, 2);
    assert_eq!(repaired.report.degenerate.at, middle);
    assert_eq!(repaired.particle_of_vertex, [0, 1, 2, 3, 2]);
}

#[test]
fn copies_are_told_from_backs() {
    let indices = [0, 1, 2, 0, 2, 3, 2, 0, 1, 2, 1, 0];
    let repaired = repaired(&SQUARE, &indices);
    let copy = |source, back| TriangleCopy {
        source,
        triangle: 0,
        back,
    };
    assert_eq!(repaired.copies, [copy(2, false), copy(3, true)]);
    assert_eq!(
        (repaired.report.duplicate.first, repaired.report.backs.first),
        (2, 3)
    );
}

#[test]
fn double_sided_faces_with_vertices_of_their_own_are_one_layer() {
    let positions: Vec<Vec3> = SQUARE.into_iter().chain(SQUARE).collect();
    let repaired = repaired(&positions, &[0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6]);
    assert_eq!(repaired.triangles.len(), 2);
    assert_eq!(repaired.report.backs.count, 2);
    assert_eq!(repaired.report.non_manifold.count, 0);
    assert!(repaired.dropped().is_empty());
}

#[test]
fn a_triangle_that_faces_the_wrong_way_is_turned_with_its_copies() {
    let positions = [SQUARE.as_slice(), &[Vec3::new(0.5, 2.0, 0.0)]].concat();
    let repaired = repaired(&positions, &[0, 1, 2, 0, 3, 2, 3, 2, 4, 3, 2, 0]);
    assert_eq!(repaired.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 4]]);
    assert_eq!(repaired.turned, [1, 3]);
    assert!(!repaired.copies[0].back, "{:?}", repaired.copies);
    let report = repaired.report.to_string();
    assert!(
        report.contains("1 triangles turned around, the first at triangle 1"),
        "{report}"
    );
}

#[test]
fn a_fin_is_a_non_manifold_edge_and_a_loose_triangle_an_island() {
    let positions = [
        SQUARE.as_slice(),
        &[Vec3::new(0.5, 0.5, 1.0)],
        &[5.0, 6.0, 7.0].map(|x| Vec3::new(x, x * x, 0.0)),
    ]
    .concat();
    let repaired = repaired(&positions, &[0, 1, 2, 0, 2, 3, 0, 2, 4, 5, 6, 7]);
    let middle = Vec3::new(0.5, 0.5, 0.0);
    assert_eq!(
        repaired.report.non_manifold,
        Finding {
            count: 1,
            first: 0,
            at: middle
        }
    );
    let islands = &repaired.report.islands;
    assert_eq!(islands.len(), 2);
    assert_eq!(
        (islands[0].triangles, islands[1].triangles, islands[1].first),
        (3, 1, 3)
    );
}

#[test]
fn particles_have_the_same_numbers_at_every_scale() {
    let [a, b, c, d] = SQUARE;
    // A sliver at this scale, but a triangle at rest.
    let positions = [a, b, c, d, Vec3::new(2.0, 1.0, 0.0)];
    let indices = [0, 1, 2, 0, 2, 3, 2, 1, 4];
    let cloth = ClothShape::mesh(positions, indices);
    for scale in [Vec3::ONE, Vec3::new(1e-7, 1.0, 1.0), Vec3::splat(3.0)] {
        let repaired = Repaired::new(&positions, &indices, 1e-5, scale);
        assert_eq!(repaired.positions, cloth.rest_positions());
    }
}

#[test]
fn what_is_too_far_or_too_small_to_count_is_refused() {
    let mesh = |size: f32| {
        let shape = ClothShape::mesh(SQUARE.map(|p| p * size), [0, 1, 2, 0, 2, 3]);
        let ClothShape::Mesh {
            positions, indices, ..
        } = shape
        else {
            unreachable!("a mesh");
        };
        ClothShape::Mesh {
            positions,
            indices,
            uvs: Vec::new(),
            weld_distance: 0.0,
        }
    };
    let error = |size, scale| Topology::build(&mesh(size), Vec3::splat(scale)).err();
    assert!(matches!(
        error(1e7, 1.0),
        Some(ClothShapeError::PositionTooFar { vertex: 1, .. })
    ));
    assert!(matches!(
        error(1.0, 1e7),
        Some(ClothShapeError::PositionTooFar { .. })
    ));
    assert!(matches!(
        error(1e-7, 1.0),
        Some(ClothShapeError::NoTriangles { .. })
    ));
    assert_eq!(error(1e-3, 1.0), None);
    assert_eq!(error(1e5, 1.0), None);
}

#[test]
fn a_grid_with_a_loose_vertex_is_still_recognised() {
    let grid = ClothShape::grid(bevy_math::Vec2::ONE, UVec2::splat(5));
    let triangles = Topology::build(&grid, Vec3::ONE).expect("valid");
    let indices: Vec<u32> = triangles.triangles().iter().flatten().collect();
    let mut positions = grid.rest_positions();
    positions.push(Vec3::splat(2.0));
    let topology = Topology::build(&ClothShape::mesh(positions, indices), Vec3::ONE);
    assert!(topology.expect("valid").lattice().is_some());
}

proptest! {
    #[test]
    fn a_soup_is_repaired_so_that_nothing_is_left_to_repair(
        places in prop::collection::vec(0u32..125, 3..40),
        indices in prop::collection::vec(0usize..1000, 3..300),
    ) {
        let positions: Vec<Vec3> = places
            .iter()
            .map(|&i| Vec3::new((i % 5) as f32, (i / 5 % 5) as f32, (i / 25) as f32) * 0.1)
            .collect();
        let indices: Vec<u32> = indices[..indices.len() / 3 * 3]
            .iter()
            .map(|i| (i % positions.len()) as u32)
            .collect();
        let first = repaired(&positions, &indices);
        let report = &first.report;
        let left = report.degenerate.count + report.duplicate.count + report.backs.count;
        prop_assert_eq!(left + first.triangles.len(), report.triangles);
        prop_assert_eq!(report.particles, first.positions.len());
        prop_assert_eq!(
            report.islands.iter().map(|island| island.triangles).sum::<usize>(),
            first.triangles.len()
        );
        let in_use: std::collections::HashSet<u32> =
            first.triangles.iter().flatten().copied().collect();
        prop_assert_eq!(in_use.len(), first.positions.len());

        let again = repaired(&first.positions, first.triangles.as_flattened());
        prop_assert_eq!(&again.triangles, &first.triangles);
        prop_assert_eq!(&again.positions, &first.positions);
        let report = again.report;
        let found = [report.welded, report.isolated, report.degenerate, report.duplicate, report.backs, report.turned];
        prop_assert!(!found.iter().any(Finding::is_some), "{:?}", found);
    }
}

#[test]
fn any_vertex_of_a_particle_can_hold_it() {
    let weights = super::of_particles(3, &[0, 1, 1, 2, 0, 9], &[0.2, 0.0, 0.9, f32::NAN, 0.4, 1.0]);
    assert_eq!(weights, [0.4, 0.9, 0.0]);
}
