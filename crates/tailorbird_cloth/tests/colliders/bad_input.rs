//! Errors of colliders are told, with field, value and the allowed range.

use bevy_math::{Isometry3d, Mat3, UVec2, Vec2, Vec3};
use tailorbird_cloth::{collider::Compound, prelude::*};
use tailorbird_test::{Scene, Sheet, external};

#[test]
fn wrong_measures_are_told() {
    let nan = f32::NAN;
    for (collider, field) in [
        (ClothCollider::capsule(0.0, 1.0), "radius"),
        (ClothCollider::capsule(1.0, -1.0), "half_length"),
        (
            ClothCollider::tapered_capsule(nan, 1.0, 1.0),
            "bottom_radius",
        ),
        (ClothCollider::tapered_capsule(1.0, -2.0, 1.0), "top_radius"),
        (ClothCollider::cuboid(1.0, f32::INFINITY, 1.0), "size"),
        (ClothCollider::cylinder(1.0, 0.0), "half_height"),
        (ClothCollider::sphere(1.0).with_margin(-0.1), "margin"),
    ] {
        let [error] = &collider.errors()[..] else {
            panic!("{field}: {:?}", collider.errors());
        };
        let text = error.to_string();
        assert!(text.contains(field) && text.contains("must be"), "{text}");
    }
}

#[test]
fn wrong_data_makes_no_shape() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
    let is = |result: Result<ClothCollider, ClothErrorKind>, kind: &str| {
        let text = format!("{:?}", result.expect_err(kind));
        assert!(text.starts_with(kind), "{text}, not {kind}");
    };
    is(ClothCollider::convex_hull(&square), "FlatHull");
    is(ClothCollider::convex_hull(&[]), "FlatHull");
    is(ClothCollider::convex_hull(&[Vec3::NAN; 5]), "ColliderPoint");
    is(ClothCollider::trimesh(square, [[0, 1, 4]]), "ColliderIndex");
    is(ClothCollider::trimesh(square, []), "NoColliderTriangles");
    is(
        ClothCollider::trimesh(square, [[0, 0, 1]]),
        "NoColliderTriangles",
    );
    is(
        ClothCollider::trimesh([Vec3::INFINITY; 3], [[0, 1, 2]]),
        "ColliderPoint",
    );
    is(
        ClothCollider::height_field(vec![0.0; 5], 2, Vec2::ONE),
        "HeightField",
    );
    is(
        ClothCollider::height_field(vec![0.0; 4], 0, Vec2::ONE),
        "HeightField",
    );
    is(
        ClothCollider::height_field(vec![f32::NAN; 4], 2, Vec2::ONE),
        "Value",
    );
    is(
        ClothCollider::height_field(vec![0.0; 4], 2, Vec2::ZERO),
        "Value",
    );
    is(ClothCollider::compound([]), "EmptyCompound");
    let away = Isometry3d::from_translation(Vec3::NAN);
    is(
        ClothCollider::compound([(away, ClothColliderShape::HalfSpace)]),
        "Vector",
    );
    assert!(Compound::new([(Isometry3d::IDENTITY, ClothColliderShape::HalfSpace)]).is_ok());
}

#[test]
fn a_wrong_body_is_told_of_its_entity_and_left_out() {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::splat(5),
        ..Scene::default()
    });
    let entity = sheet.sim.spawn(());
    let right = ClothColliderBody {
        body: entity,
        inv_mass: Vec3::ONE,
        inv_inertia: Mat3::IDENTITY,
        center_of_mass: Vec3::ZERO,
        linear_velocity: Vec3::ZERO,
        angular_velocity: Vec3::ZERO,
    };
    let push = |sheet: &mut Sheet, body: ClothColliderBody, at: Vec3| {
        for _ in 0..2 {
            let at = Isometry3d::from_translation(at);
            let mut colliders = sheet.sim.resource_mut::<ClothExternalColliders>();
            colliders.push(external(
                entity,
                ClothColliderShape::Sphere { radius: 0.3 },
                [at, at],
                Some(body),
            ));
            sheet.steps(1);
        }
        let world = sheet.sim.app.world();
        assert!(world.resource::<ClothExternalColliders>().is_empty());
        let particles = world
            .get::<ClothParticles>(sheet.entity)
            .expect("particles");
        assert!(particles.points().iter().all(Vec3::is_finite));
        let status = world.get::<ClothStatus>(entity);
        status.map_or(String::new(), |s| {
            s.errors().map(ToString::to_string).collect()
        })
    };
    let nan = ClothColliderBody {
        inv_mass: Vec3::new(1.0, f32::NAN, 1.0),
        ..right
    };
    assert!(push(&mut sheet, nan, Vec3::ZERO).contains("inv_mass is [1, NaN, 1]"));
    let wrong = ClothColliderBody {
        inv_inertia: Mat3::IDENTITY * -1.0,
        ..right
    };
    assert!(push(&mut sheet, wrong, Vec3::ZERO).contains("inv_inertia"));
    assert!(push(&mut sheet, right, Vec3::NAN).contains("GlobalTransform"));
    assert_eq!(push(&mut sheet, right, Vec3::ZERO), "");
}
