//! Each form keeps cloth out.

use bevy_math::{Quat, Vec3};
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Form, Kind, World, lying};

/// A box as triangles, counter-clockwise from outside.
fn crate_mesh(half: Vec3) -> Form {
    let corner = |k: u32| {
        let side = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half * Vec3::new(side(0), side(1), side(2))
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    Form::Mesh((0..8).map(corner).collect(), triangles.collect())
}

fn forms() -> Vec<(&'static str, Form)> {
    let half = Vec3::new(0.3, 0.2, 0.25);
    let corners = [-1.0, 1.0]
        .into_iter()
        .flat_map(|x| [-1.0, 1.0].map(|z| Vec3::new(0.35 * x, -0.2, 0.35 * z)))
        .chain([Vec3::new(0.05, 0.25, 0.0), Vec3::new(-0.2, 0.2, 0.1)]);
    vec![
        ("ball", Form::Ball(0.3)),
        ("box", Form::Box(2.0 * half)),
        ("round box", Form::RoundBox(1.6 * half, 0.05)),
        (
            "capsule",
            Form::Capsule(0.2, Vec3::new(-0.3, 0.0, 0.1), Vec3::new(0.3, 0.1, -0.1)),
        ),
        ("cylinder", Form::Cylinder(0.3, 0.4)),
        ("cone", Form::Cone(0.4, 0.4)),
        ("hull", Form::Hull(corners.collect())),
        ("mesh", crate_mesh(half)),
        (
            "terrain",
            Form::Terrain(|x, z| 0.1 * (3.0 * x).sin() * (4.0 * z).cos(), 24, 4.0),
        ),
        (
            "compound",
            Form::Compound(vec![
                (Vec3::X * 0.25, Quat::IDENTITY, Form::Ball(0.25)),
                (
                    Vec3::NEG_X * 0.25,
                    Quat::from_rotation_y(0.5),
                    Form::Box(Vec3::splat(0.35)),
                ),
            ]),
        ),
        (
            "half-space",
            Form::HalfSpace(Vec3::new(0.1, 1.0, 0.0).normalize()),
        ),
    ]
}

#[test]
fn no_particle_is_inside_after_cloth_has_settled() {
    for (name, form) in forms() {
        let mut world = World::earth();
        let pins = ClothPins::default();
        let sheet = world.sheet(1.2, 32, ClothMaterial::cotton(), pins, lying(0.45));
        let body = world.body(&Body::fixed(form, Vec3::ZERO));
        world.body(&Body::fixed(Form::HalfSpace(Vec3::Y), Vec3::Y * -0.5));
        world.seconds(3.0);
        let depth = world.depth(sheet, body);
        let lowest = world.points(sheet).iter().fold(f32::MAX, |y, p| y.min(p.y));
        println!("{name}: {depth:.4} m deep, lowest {lowest:.3} m");
        assert_eq!(world.complaint(sheet), None, "{name}");
        assert!(depth < 1e-3, "{name}: {depth} m deep");
        // It reached the body, and nothing fell through the floor.
        assert!(depth > -0.02, "{name}: {depth} m deep");
        assert!(lowest > -0.501, "{name}: lowest {lowest} m");
    }
}

#[test]
fn a_moving_box_takes_cloth_along() {
    let mut world = World::earth();
    let pins = ClothPins::default();
    let sheet = world.sheet(1.0, 24, ClothMaterial::cotton(), pins, lying(0.3));
    let table = world.body(&Body {
        kind: Kind::Kinematic,
        ..Body::new(Form::Box(Vec3::new(0.6, 0.4, 0.6)), 1.0, Vec3::ZERO)
    });
    world.seconds(2.0);
    let mean = |world: &World| {
        let points = world.points(sheet);
        points.iter().sum::<Vec3>() / points.len() as f32
    };
    let before = mean(&world);
    crate::engine::set_velocity(world.app.world_mut(), table, Vec3::X * 1.0);
    for _ in 0..120 {
        world.steps(1);
        assert!(
            world.depth(sheet, table) < 2e-3,
            "{}",
            world.depth(sheet, table)
        );
    }
    let moved = (mean(&world) - before).x;
    let distance = world.motion(table).position.x;
    println!("moved {moved:.3} m with a box that went {distance:.3} m");
    assert!((distance - 2.0).abs() < 0.05, "{distance}");
    assert!(
        (0.9 * distance..1.1 * distance).contains(&moved),
        "{moved} of {distance} m"
    );
    assert_eq!(world.complaint(sheet), None);
}
