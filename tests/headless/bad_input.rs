//! Bad input is a typed error, once, that names entity, field, value and what is allowed. Other cloths go on as if nothing
//! had happened, and the right value clears it.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

fn good() -> impl Bundle {
    (
        square(6),
        ClothPins::corners([ClothCorner::TopLeft]),
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(lying()),
    )
}

fn good_collider() -> impl Bundle {
    (
        ClothCollider::sphere(0.3),
        Transform::from_xyz(0.2, 0.6, 0.0),
    )
}

// The number of substeps is given: the automatic one is that of the cloth that needs most, so that cloths would not be alone.

/// The bits of a good cloth that is alone with a good sphere, after a second.
fn alone() -> u64 {
    let mut sim = Sim::new().with_passes(8, 1);
    sim.spawn(good_collider());
    let cloth = sim.spawn(good());
    sim.steps(60);
    sim.hash(cloth)
}

/// Spawns something wrong beside a good cloth, for half a second; then mends it, for another half.
fn check<B: Bundle>(
    bad: B,
    is_it: impl Fn(&ClothErrorKind) -> bool,
    says: &[&str],
    mend: impl FnOnce(&mut Sim, Entity),
) {
    let mut sim = Sim::new().with_passes(8, 1);
    sim.record::<ClothError>();
    sim.spawn(good_collider());
    let cloth = sim.spawn(good());
    let bad = sim.spawn(bad);
    sim.steps(30);

    let errors = sim.errors(bad);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(is_it(&errors[0]), "{:?}", errors[0]);
    let message = errors[0].to_string();
    for part in says.iter().chain(&["must"]) {
        assert!(message.contains(part), "{message:?} lacks {part:?}");
    }
    let events = sim.recorded::<ClothError>();
    assert_eq!(events.len(), 1, "{events:?}");
    assert_eq!(events[0].entity, bad);
    assert!(events[0].to_string().contains(&bad.to_string()));

    mend(&mut sim, bad);
    sim.steps(30);
    assert_eq!(sim.errors(bad), [], "after mending");
    assert_eq!(sim.recorded::<ClothError>().len(), 1);
    assert!(sim.errors(cloth).is_empty());
    assert_eq!(sim.hash(cloth), alone(), "the other cloth moved otherwise");
    if sim.app.world().get::<Cloth>(bad).is_some() {
        assert!(!sim.particles(bad).is_empty() && sim.all_finite(bad));
    }
}

/// Far from the good cloth and its sphere.
fn far() -> Transform {
    Transform::from_xyz(50.0, 0.0, 0.0)
}

fn mend_cloth(sim: &mut Sim, entity: Entity) {
    sim.edit::<Cloth>(entity, |cloth| *cloth = square(5));
}

#[test]
fn sizes() {
    for size in [
        Vec2::ZERO,
        Vec2::new(1.0, 0.0),
        Vec2::new(-1.0, 1.0),
        Vec2::new(f32::NAN, 1.0),
        Vec2::new(1.0, f32::INFINITY),
    ] {
        let cloth = Cloth::grid(size, UVec2::splat(5));
        assert!(Cloth::try_grid(size, UVec2::splat(5)).is_err());
        check(
            (cloth, far()),
            |kind| matches!(kind, ClothErrorKind::Shape(ClothShapeError::Size { .. })),
            &["Cloth grid size", &size.x.to_string(), "positive"],
            mend_cloth,
        );
    }
}

#[test]
fn resolutions() {
    for resolution in [
        UVec2::ZERO,
        UVec2::new(1, 5),
        UVec2::new(5, 1),
        UVec2::splat(100_000),
        UVec2::splat(u32::MAX),
    ] {
        assert!(Cloth::try_grid(Vec2::ONE, resolution).is_err());
        check(
            (Cloth::grid(Vec2::ONE, resolution), far()),
            |kind| matches!(kind, ClothErrorKind::Shape(ClothShapeError::Resolution { value }) if *value == resolution),
            &["resolution", &resolution.x.to_string(), "2 × 2"],
            mend_cloth,
        );
    }
}

#[test]
fn origins() {
    check(
        (square(5).with_origin(Vec2::new(f32::NAN, 0.0)), far()),
        |kind| matches!(kind, ClothErrorKind::Shape(ClothShapeError::Origin { .. })),
        &["origin", "NaN", "finite"],
        mend_cloth,
    );
}

/// Two triangles.
fn quad() -> (Vec<Vec3>, Vec<u32>) {
    let positions = [(0.0, 0.0), (0.0, -1.0), (1.0, -1.0), (1.0, 0.0)];
    (
        positions.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        vec![0, 1, 2, 0, 2, 3],
    )
}

#[test]
fn positions_of_a_mesh() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (mut positions, indices) = quad();
        positions[2].y = value;
        check(
            (Cloth::mesh(positions, indices), far()),
            |kind| {
                matches!(
                    kind,
                    ClothErrorKind::Shape(ClothShapeError::NonFinitePosition { vertex: 2, .. })
                )
            },
            &["positions[2]", &value.to_string(), "finite"],
            mend_cloth,
        );
    }
}

#[test]
fn indices_of_a_mesh() {
    let (positions, indices) = quad();
    let with = |indices: Vec<u32>| (Cloth::mesh(positions.clone(), indices), far());
    check(
        with(vec![0, 1, 2, 0, 2, 4]),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::IndexOutOfRange {
                    at: 5,
                    value: 4,
                    vertices: 4
                })
            )
        },
        &["indices[5]", "4", "below"],
        mend_cloth,
    );
    check(
        with(indices[..5].to_vec()),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::IndexCount { value: 5 })
            )
        },
        &["5", "multiple of 3"],
        mend_cloth,
    );
    check(
        with(Vec::new()),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::NoTriangles { vertices: 4, .. })
            )
        },
        &["triangle", "4"],
        mend_cloth,
    );
    check(
        with(vec![0, 0, 1, 2, 2, 2]),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::NoTriangles { .. })
            )
        },
        &["triangle"],
        mend_cloth,
    );
}

#[test]
fn weld_distances() {
    for distance in [-1.0, f32::NAN, f32::INFINITY] {
        let (positions, indices) = quad();
        let shape = ClothShape::Mesh {
            positions,
            indices,
            uvs: Vec::new(),
            weld_distance: distance,
        };
        check(
            (Cloth { shape }, far()),
            |kind| {
                matches!(
                    kind,
                    ClothErrorKind::Shape(ClothShapeError::WeldDistance { .. })
                )
            },
            &["weld_distance", &distance.to_string(), "at least 0"],
            mend_cloth,
        );
    }
}

#[test]
fn texture_coordinates_that_are_too_few() {
    let (positions, indices) = quad();
    let shape = ClothShape::Mesh {
        positions,
        indices,
        uvs: vec![Vec2::ZERO; 3],
        weld_distance: 0.0,
    };
    check(
        (Cloth { shape }, far()),
        |kind| matches!(kind, ClothErrorKind::Shape(ClothShapeError::UvCount { .. })),
        &["uvs", "3", "none or one for each of 4 vertices"],
        mend_cloth,
    );
}

#[test]
fn broken_triangles_are_dropped_and_the_rest_simulates() {
    let (positions, mut indices) = quad();
    indices.extend([1, 1, 2]);
    check(
        (Cloth::mesh(positions.clone(), indices.clone()), far()),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::DegenerateTriangles { count: 1, first: 2 })
            )
        },
        &["1", "2", "dropped"],
        |sim, entity| {
            assert_eq!(sim.particles(entity).len(), 4);
            assert!(sim.at(entity, 0).y < -0.5, "does not fall");
            mend_cloth(sim, entity);
        },
    );
    indices.truncate(6);
    indices.extend([2, 0, 1]);
    check(
        (Cloth::mesh(positions, indices), far()),
        |kind| {
            matches!(
                kind,
                ClothErrorKind::Shape(ClothShapeError::DuplicateTriangles { count: 1, first: 2 })
            )
        },
        &["1", "2", "dropped"],
        |sim, entity| {
            assert!((sim.mass(entity) - 0.15).abs() < 1e-6);
            assert!(sim.at(entity, 0).y < -0.5, "does not fall");
            mend_cloth(sim, entity);
        },
    );
}

/// The fields of a material.
const MATERIAL: [(&str, fn(&mut ClothMaterial) -> &mut f32); 11] = [
    ("areal_density", |m| &mut m.areal_density),
    ("warp_compliance", |m| &mut m.warp_compliance),
    ("weft_compliance", |m| &mut m.weft_compliance),
    ("shear_compliance", |m| &mut m.shear_compliance),
    ("bend_compliance", |m| &mut m.bend_compliance),
    ("viscosity", |m| &mut m.viscosity),
    ("damping", |m| &mut m.damping),
    ("friction", |m| &mut m.friction),
    ("thickness", |m| &mut m.thickness),
    ("drag", |m| &mut m.drag),
    ("lift", |m| &mut m.lift),
];

#[test]
fn a_material_that_becomes_wrong_never_gets_into_the_state() {
    for (field, spoil) in MATERIAL {
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let mut sim = Sim::new();
            sim.record::<ClothReset>();
            sim.app.insert_resource(ClothWind::steady(Vec3::Z * 3.0));
            sim.spawn(good_collider());
            sim.spawn((
                ClothCollider::half_space(),
                Transform::from_xyz(0.0, 0.2, 0.0),
            ));
            let cloth = sim.spawn(good());
            sim.steps(20);
            sim.edit::<ClothMaterial>(cloth, |m| *spoil(m) = value);
            sim.steps(30);
            assert!(sim.all_finite(cloth), "{field} {value}");
            assert_eq!(sim.recorded::<ClothReset>(), [], "{field} {value}");
        }
    }
}

#[test]
fn materials() {
    for (field, spoil) in MATERIAL {
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let mut material = ClothMaterial::cotton();
            *spoil(&mut material) = value;
            check(
                (square(5), material, far()),
                |kind| matches!(kind, ClothErrorKind::Value { .. }),
                &[field, &value.to_string(), "0", "["],
                |sim, entity| {
                    assert!(sim.all_finite(entity), "{field} {value}");
                    sim.edit::<ClothMaterial>(entity, |m| *m = ClothMaterial::cotton());
                },
            );
        }
    }
}

#[test]
fn a_material_that_becomes_wrong_leaves_the_masses() {
    for value in [0.0, -1.0, f32::NAN] {
        let mut sim = Sim::new();
        let cloth = sim.spawn((square(5), ClothPins::corners(ClothCorner::TOP)));
        sim.steps(5);
        sim.edit::<ClothMaterial>(cloth, |m| m.areal_density = value);
        sim.steps(5);
        // A pin that is taken away in the meantime lets go all the same.
        sim.edit::<ClothPins>(cloth, |pins| *pins = ClothPins::particles([0]));
        let there = sim.at(cloth, 0);
        sim.steps(20);
        assert!((sim.mass(cloth) - 0.15).abs() < 1e-6);
        assert_eq!(sim.at(cloth, 0), there);
        assert!(sim.at(cloth, 4).y < 0.45, "the released corner falls");
    }
}

#[test]
fn pins() {
    let cases = [
        (
            ClothPins::particles([25]),
            "25",
            "below the number of particles",
        ),
        (
            ClothPins::default().with(ClothPin::at(0, Vec3::NAN)),
            "NaN",
            "finite",
        ),
        (ClothPins::within(Vec3::ZERO, -1.0), "-1", "at least 0"),
        (ClothPins::within(Vec3::NAN, 1.0), "NaN", "finite"),
    ];
    for (pins, value, allowed) in cases {
        check(
            (square(5), pins, far()),
            |_| true,
            &["ClothPins", value, allowed],
            |sim, entity| {
                sim.edit::<ClothPins>(entity, |pins| *pins = ClothPins::particles([3]));
            },
        );
    }
    let (positions, indices) = quad();
    check(
        (
            Cloth::mesh(positions, indices),
            ClothPins::corners([ClothCorner::TopLeft]),
            far(),
        ),
        |kind| matches!(kind, ClothErrorKind::NotAGrid { .. }),
        &["ClothPins", "TopLeft", "mesh"],
        |sim, entity| sim.edit::<ClothPins>(entity, |pins| pins.pins.clear()),
    );
}

/// Transforms with one number that is not finite.
fn broken_transforms() -> Vec<Transform> {
    let mut list = Vec::new();
    for bad in [f32::NAN, f32::INFINITY] {
        list.push(Transform::from_xyz(50.0, bad, 0.0));
        list.push(Transform::from_scale(Vec3::new(1.0, 1.0, bad)));
        list.push(Transform::from_rotation(Quat::from_xyzw(
            0.0, bad, 0.0, 1.0,
        )));
    }
    list
}

#[test]
fn transforms_of_a_cloth() {
    for transform in broken_transforms() {
        check(
            (square(5), transform),
            |kind| matches!(kind, ClothErrorKind::Transform { .. }),
            &["Transform", "finite"],
            |sim, entity| sim.edit::<Transform>(entity, |t| *t = far()),
        );
    }
}

#[test]
fn transforms_of_a_sphere() {
    for transform in broken_transforms() {
        check(
            (ClothCollider::sphere(0.3), transform),
            |kind| matches!(kind, ClothErrorKind::Transform { .. }),
            &["Transform", "finite"],
            |sim, entity| sim.edit::<Transform>(entity, |t| *t = far()),
        );
    }
}

#[test]
fn a_transform_that_becomes_wrong_leaves_the_cloth_where_it_was() {
    let mut sim = Sim::new();
    let cloth = sim.spawn((square(5), ClothPins::corners(ClothCorner::TOP)));
    sim.steps(30);
    let pinned = sim.at(cloth, 0);
    for bad in broken_transforms() {
        sim.edit::<Transform>(cloth, |t| *t = bad);
        sim.steps(5);
        assert_eq!(sim.errors(cloth).len(), 1);
        assert_eq!(sim.at(cloth, 0), pinned);
        assert!(sim.all_finite(cloth));
    }
    sim.edit::<Transform>(cloth, |t| *t = Transform::default());
    sim.steps(5);
    assert!(sim.errors(cloth).is_empty());
    assert_eq!(sim.at(cloth, 0), pinned);
    assert!(longest_edge(&sim, cloth) < 1.1);
}

#[test]
fn scales_of_zero() {
    for scale in [
        Vec3::ZERO,
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(1.0, 1.0, 0.0),
    ] {
        check(
            (square(5), far().with_scale(scale)),
            |kind| matches!(kind, ClothErrorKind::Scale { .. }),
            &["scale", "0", "not zero"],
            |sim, entity| sim.edit::<Transform>(entity, |t| t.scale = Vec3::ONE),
        );
        check(
            (ClothCollider::sphere(0.3), far().with_scale(scale)),
            |kind| matches!(kind, ClothErrorKind::Scale { .. }),
            &["scale", "0", "not zero"],
            |sim, entity| sim.edit::<Transform>(entity, |t| t.scale = Vec3::ONE),
        );
    }
}

#[test]
fn radii_and_frictions_of_a_sphere() {
    let mend = |sim: &mut Sim, entity| {
        sim.edit::<ClothCollider>(entity, |c| *c = ClothCollider::sphere(0.1));
    };
    for radius in [0.0, -0.5, f32::NAN, f32::INFINITY] {
        // In the middle of the good cloth, which must not feel it.
        check(
            (
                ClothCollider::sphere(radius),
                Transform::from_xyz(0.0, 1.0, 0.0),
            ),
            |kind| matches!(kind, ClothErrorKind::Value { .. }),
            &["ClothCollider radius", &radius.to_string(), "above 0"],
            |sim, entity| {
                sim.edit::<Transform>(entity, |t| *t = far());
                mend(sim, entity);
            },
        );
    }
    for friction in [-0.1, f32::NAN, f32::INFINITY] {
        check(
            (ClothCollider::sphere(0.1).with_friction(friction), far()),
            |kind| matches!(kind, ClothErrorKind::Value { .. }),
            &["friction", &friction.to_string(), "at least 0"],
            mend,
        );
    }
}

#[test]
fn a_state_that_becomes_infinite_is_reset_and_says_so() {
    let mut sim = Sim::new().with_passes(8, 1);
    sim.record::<ClothReset>();
    sim.record::<ClothError>();
    sim.spawn(good_collider());
    let other = sim.spawn(good());
    let cloth = sim.spawn((square(5), ClothPins::corners(ClothCorner::TOP), far()));
    sim.steps(30);
    let before = sim.positions(cloth);
    sim.edit::<ClothForces>(cloth, |forces| {
        for _ in 0..10 {
            forces.add_force(12, Vec3::Y * 1e38);
        }
    });
    sim.steps(1);
    assert!(sim.all_finite(cloth));
    assert_eq!(sim.positions(cloth), before);
    let resets = sim.recorded::<ClothReset>();
    assert_eq!(resets.len(), 1);
    assert_eq!(resets[0].entity, cloth);
    assert_eq!(sim.recorded::<ClothError>().len(), 1);
    assert!(matches!(
        sim.recorded::<ClothError>()[0].kind,
        ClothErrorKind::NonFiniteState { .. }
    ));
    sim.steps(29);
    assert_eq!(sim.recorded::<ClothReset>().len(), 1);
    assert!(sim.all_finite(cloth) && longest_edge(&sim, cloth) < 1.1);
    assert_eq!(sim.hash(other), alone());
}

#[test]
fn constructors_tell_at_once() {
    assert_eq!(
        Cloth::try_grid(Vec2::ONE, UVec2::ONE),
        Err(ClothShapeError::Resolution { value: UVec2::ONE })
    );
    let (positions, indices) = quad();
    assert!(Cloth::try_mesh(positions.clone(), indices).is_ok());
    assert_eq!(
        Cloth::try_mesh(positions, [0, 1, 9]),
        Err(ClothShapeError::IndexOutOfRange {
            at: 2,
            value: 9,
            vertices: 4
        })
    );
}
