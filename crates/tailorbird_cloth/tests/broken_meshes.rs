//! Whatever the triangles, a cloth of them is refused with a typed error or simulated: never a panic, never a number that is not
//! finite, and never a hang.

#![cfg(test)]

use bevy_math::{Quat, Vec3};
use bevy_transform::prelude::Transform;
use proptest::prelude::*;
use tailorbird_cloth::{prelude::*, topology::Topology};
use tailorbird_test::Sim;

/// Vertices and three of them for each triangle.
type Triangles = (Vec<Vec3>, Vec<u32>);

fn windy() -> Sim {
    let mut sim = Sim::new();
    sim.app
        .insert_resource(ClothWind::steady(Vec3::new(3.0, 0.0, 4.0)));
    sim
}

/// Some steps in wind over a ball and the ground, with one particle held and one pulled; with both solvers.
fn survives((positions, indices): Triangles) -> Result<(), TestCaseError> {
    let count = positions.len();
    for solver in [ClothSolver::default(), ClothSolver::GaussSeidel] {
        let mut sim = windy();
        sim.spawn((ClothCollider::sphere(0.4), Transform::default()));
        sim.spawn((
            ClothCollider::half_space(),
            Transform::from_xyz(0.0, -1.0, 0.0),
        ));
        let cloth = Cloth::mesh(positions.clone(), indices.clone());
        let particles = cloth.rest_positions().len();
        let entity = sim.spawn((cloth, solver, ClothPins::particles([0])));
        for step in 0..6 {
            if step == 3 && particles > 1 {
                // The cloth is thrown about.
                let place =
                    Transform::from_xyz(40.0, 3.0, -7.0).with_rotation(Quat::from_rotation_z(2.0));
                sim.move_to(entity, place);
            }
            sim.steps(1);
        }
        let status = sim.get::<ClothStatus>(entity);
        let state = sim.particles(entity);
        let refused = status.errors().any(|error| {
            matches!(
                error,
                ClothErrorKind::Shape(ClothShapeError::NoTriangles { .. })
            )
        });
        prop_assert_eq!(state.is_empty(), refused, "{:?}", status);
        prop_assert_eq!(refused, particles == 0);
        prop_assert!(state.len() <= count);
        prop_assert!(
            !status
                .errors()
                .any(|error| matches!(error, ClothErrorKind::NonFiniteState { .. })),
            "{:?}",
            status
        );
        prop_assert!(state.positions().all(Vec3::is_finite));
        let normals = sim.get::<ClothNormals>(entity);
        prop_assert!((0..normals.len()).all(|i| normals.normal(i).is_normalized()));
    }
    Ok(())
}

/// Triangles between any vertices.
fn soup() -> impl Strategy<Value = Triangles> {
    let place = prop::array::uniform3(-1.0f32..1.0);
    let places = prop::collection::vec(place, 1..200);
    let corners = prop::collection::vec(0usize..usize::MAX, 3..900);
    (places, corners).prop_map(|(places, corners)| {
        let count = places.len();
        let corners = &corners[..corners.len() / 3 * 3];
        (
            places.into_iter().map(Vec3::from).collect(),
            corners.iter().map(|i| (i % count) as u32).collect(),
        )
    })
}

/// Triangles around one vertex, or around one edge.
fn fan(count: u32, around_edge: bool) -> Triangles {
    let mut positions = vec![Vec3::ZERO, Vec3::Z];
    positions.extend((0..=count).map(|i| {
        let angle = 6.0 * i as f32 / count as f32;
        Vec3::new(angle.cos(), angle.sin(), 0.2)
    }));
    let indices = (2..count + 2).flat_map(|i| {
        if around_edge {
            [0, 1, i]
        } else {
            [0, i, i + 1]
        }
    });
    (positions, indices.collect())
}

/// A ring of `n` quads with half twists: with an odd number of them a Möbius strip.
fn twisted(n: u32, half_twists: u32) -> Triangles {
    use std::f32::consts::{PI, TAU};
    let positions = (0..2 * n).map(|i| {
        let around = (i / 2) as f32 / n as f32;
        let (twist, side) = (PI * half_twists as f32 * around, i as f32 % 2.0 - 0.5);
        let radial = 1.0 + 0.3 * side * twist.cos();
        let (sin, cos) = (TAU * around).sin_cos();
        Vec3::new(radial * cos, 0.3 * side * twist.sin(), radial * sin)
    });
    let indices = (0..n).flat_map(|i| {
        let [a, b] = [2 * i, 2 * i + 1];
        let last = i + 1 == n;
        let [c, d] = match (last, last && half_twists % 2 == 1) {
            (_, true) => [1, 0],
            (true, _) => [0, 1],
            _ => [a + 2, b + 2],
        };
        [a, b, c, c, b, d]
    });
    (positions.collect(), indices.collect())
}

/// A closed surface: `rings` × `sides` quads around a ball, with poles of many triangles.
fn ball(rings: u32, sides: u32) -> Triangles {
    use std::f32::consts::{PI, TAU};
    let positions = (0..=rings).flat_map(|ring| {
        (0..sides).map(move |side| {
            let (height, around) = (
                PI * ring as f32 / rings as f32,
                TAU * side as f32 / sides as f32,
            );
            Vec3::new(
                height.sin() * around.cos(),
                height.cos(),
                height.sin() * around.sin(),
            )
        })
    });
    let indices = (0..rings * sides).flat_map(|i| {
        let next = i / sides * sides + (i + 1) % sides;
        [i, next, next + sides, i, next + sides, i + sides]
    });
    (positions.collect(), indices.collect())
}

/// One of the above, of 1 to 10,000 triangles, larger or smaller, stretched, moved, some of its indices exchanged.
fn mesh() -> impl Strategy<Value = Triangles> {
    let kind = prop_oneof![
        3 => soup(),
        1 => (1u32..10_000, any::<bool>()).prop_map(|(n, edge)| fan(n, edge)),
        2 => (1u32..400, 0u32..4).prop_map(|(n, twists)| twisted(n, twists)),
        1 => (1u32..70, 1u32..70).prop_map(|(rings, sides)| ball(rings, sides)),
    ];
    let scale = prop::array::uniform3(-4.0f32..4.0);
    let exchanged = prop::collection::vec(any::<[prop::sample::Index; 2]>(), 0..6);
    (kind, scale, -3i32..4, exchanged).prop_map(
        |((mut positions, mut indices), scale, power, exchanged)| {
            let scale = Vec3::from(scale).map(|s| 10f32.powf(s.min(0.0))) * 10f32.powi(power);
            for p in &mut positions {
                *p = *p * scale + scale.max_element() * Vec3::new(1.0, -2.0, 0.5);
            }
            for [from, to] in exchanged {
                let vertex = to.index(positions.len());
                *from.get_mut(&mut indices) = vertex as u32;
            }
            (positions, indices)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mesh_is_refused_or_simulated(mesh in mesh()) {
        survives(mesh)?;
    }
}

#[test]
fn ten_thousand_triangles_around_one_vertex_or_edge_neither_hang_nor_explode() {
    for around_edge in [false, true] {
        survives(fan(10_000, around_edge)).expect("simulated");
    }
}

#[test]
fn a_mesh_without_edges_or_with_equal_corners_neither_hangs_nor_asserts() {
    let place = Vec3::new(0.1, 0.2, 0.3);
    let refused = |positions: Vec<Vec3>, indices: Vec<u32>| {
        let built = Topology::build(&Cloth::mesh(positions, indices).shape, Vec3::ONE);
        assert!(
            matches!(built, Err(ClothShapeError::NoTriangles { .. })),
            "{built:?}"
        );
    };
    refused(vec![], vec![]);
    refused(vec![place; 3], vec![]);
    refused(vec![place; 3], vec![0, 1, 2]);
    refused(
        vec![place, 2.0 * place, 3.0 * place],
        vec![0, 1, 1, 2, 2, 2, 0, 1, 2],
    );
    survives((vec![place; 3], vec![0, 1, 2])).expect("refused");
    // One good triangle among those.
    let corners = vec![place, Vec3::X, Vec3::Y];
    survives((corners, vec![0, 0, 0, 0, 1, 2, 1, 1, 2])).expect("simulated");
}

#[test]
fn a_moebius_strip_is_reported_and_keeps_its_lengths() {
    let (positions, indices) = twisted(120, 1);
    let mut sim = windy();
    sim.app.insert_resource(ClothWind::vacuum());
    let entity = sim.spawn((
        Cloth::mesh(positions, indices),
        ClothPins::particles([0, 1]),
    ));
    sim.steps(120);
    let topology = sim.get::<ClothTopology>(entity);
    let report = &topology.report;
    assert_eq!((report.one_sided.count, report.turned.count), (1, 0));
    assert_eq!((report.islands.len(), report.non_manifold.count), (1, 0));
    assert_eq!(report.one_sided.first, 0);
    let particles = sim.particles(entity);
    let longest = particles.stretch(topology).max;
    assert!(longest < 0.02, "{longest}");
}

#[test]
fn very_light_particles_do_not_explode() {
    for (size, areal_density) in [(1e-3, 1e-4), (1e-4, 1e-3), (1.0, 1e-6)] {
        let n = 24u32;
        let at = |i: u32| Vec3::new((i % n) as f32, (i / n) as f32 * 0.8, 0.0) * size;
        let positions: Vec<Vec3> = (0..n * n).map(|i| at(i) + at(i * i % 7) * 0.04).collect();
        let indices: Vec<u32> = (0..n * (n - 1))
            .filter(|i| i % n + 1 < n)
            .flat_map(|i| [i, i + 1, i + n + 1, i, i + n + 1, i + n])
            .collect();
        let mut cloth = Cloth::mesh(positions, indices);
        if let ClothShape::Mesh { weld_distance, .. } = &mut cloth.shape {
            *weld_distance = 1e-7;
        }
        for solver in [ClothSolver::default()] {
            let mut sim = windy();
            let material = ClothMaterial {
                areal_density,
                ..ClothMaterial::cotton()
            };
            let entity = sim.spawn((cloth.clone(), material, solver, ClothPins::particles(0..n)));
            for _ in 0..120 {
                sim.steps(1);
                let particles = sim.particles(entity);
                // From the far end of the row that is held, and a column more.
                let stretch = 1.1;
                let reach = stretch * 1.85 * n as f32 * size;
                for p in particles.positions() {
                    assert!(
                        p.is_finite() && p.length() < reach,
                        "{solver:?} {size} {areal_density}: {p}"
                    );
                }
            }
            assert!(sim.get::<ClothStatus>(entity).is_ok());
        }
    }
}

#[test]
fn results_depend_on_no_hash() {
    let (positions, indices) = twisted(200, 1);
    let cloth = Cloth::mesh(positions, indices);
    let first = Topology::build(&cloth.shape, Vec3::ONE).expect("valid");
    for _ in 0..3 {
        let again = Topology::build(&cloth.shape, Vec3::ONE).expect("valid");
        assert_eq!(again.rest_positions, first.rest_positions);
        assert!(again.triangles().iter().eq(first.triangles().iter()));
        assert_eq!(again.hinges.particles, first.hinges.particles);
        assert_eq!(again.constraints().ends, first.constraints().ends);
        assert_eq!(again.report, first.report);
    }
}
