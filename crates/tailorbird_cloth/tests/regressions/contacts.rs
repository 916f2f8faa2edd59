//! Bugs of contacts.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet, external, rigid};

/// Wide things with their top about 0.1 m above their origin.
fn tables() -> Vec<(&'static str, ClothCollider, Quat)> {
    let up = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let half = Vec3::new(0.6, 0.6, 0.1);
    let corner = |k: u32| {
        let sign = |bit: u32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(0), sign(1), sign(2))
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    let hull = ClothCollider::convex_hull(&corners).expect("a box");
    let ClothColliderShape::ConvexHull(points) = &hull.shape else {
        panic!("a hull");
    };
    let mesh = ClothCollider::trimesh(points.points(), points.triangles()).expect("a box");
    let bumps = (0..121).map(|k: u8| 0.1 + 0.02 * (2.0 * f32::from(k)).sin());
    let bumps = ClothCollider::height_field(bumps.collect(), 11, Vec2::splat(1.6)).expect("bumps");
    let side = ClothColliderShape::Cuboid {
        size: Vec3::new(0.58, 1.2, 0.2),
    };
    let sides = [-0.3, 0.3].map(|x| (Isometry3d::from_translation(Vec3::X * x), side.clone()));
    let compound = ClothCollider::compound(sides).expect("two");
    vec![
        ("sphere", ClothCollider::sphere(0.4), Quat::IDENTITY),
        ("capsule", ClothCollider::capsule(0.3, 1.0), Quat::IDENTITY),
        (
            "tapered",
            ClothCollider::tapered_capsule(0.3, 0.2, 0.6),
            Quat::IDENTITY,
        ),
        (
            "cuboid",
            ClothCollider::cuboid(1.2, 1.2, 0.2),
            Quat::IDENTITY,
        ),
        (
            "small cuboid",
            ClothCollider::cuboid(0.5, 0.5, 0.2),
            Quat::IDENTITY,
        ),
        ("cylinder", ClothCollider::cylinder(0.4, 0.2), up),
        ("half-space", ClothCollider::half_space(), up),
        ("hull", hull, Quat::IDENTITY),
        ("mesh", mesh, Quat::IDENTITY),
        ("height field", bumps, up),
        ("compound", compound, Quat::IDENTITY),
    ]
}

#[test]
fn velocity_growing_without_end_on_a_resting_contact() {
    for (name, collider, rotation) in tables() {
        let mut scene = Scene {
            size: Vec2::splat(0.8),
            resolution: UVec2::splat(14),
            ..Scene::default()
        };
        scene.material.friction = 1.0;
        let mut sheet = Sheet::new(&scene);
        let place = Transform::from_xyz(0.0, 0.0, -0.5).with_rotation(rotation);
        let collider = collider.with_friction(2.0);
        sheet.sim.app.world_mut().spawn((collider, place));
        sheet.steps(600);
        let lowest = sheet.particles().positions().map(|p| p.z);
        let lowest = lowest.fold(0.0, f32::min);
        assert!(lowest > -1.2, "{name}: it fell off, to {lowest}");
        let peaks = [0, 1, 2, 3].map(|_| {
            let speeds = (0..300).map(|_| {
                sheet.step();
                sheet.speed()
            });
            speeds.fold(0.0, f64::max)
        });
        println!("{name}: {peaks:.5?} m/s");
        assert!(peaks[0] < 2e-5, "{name}: {peaks:?}");
        assert!(peaks[3] <= 1.5 * peaks[0].max(1e-5), "{name}: {peaks:?}");
    }
}

/// A particle of next to no mass is struck by a heavy body, moved by the game or by itself.
#[test]
fn very_low_mass_per_particle_exploding() {
    const SPEED: f32 = 2.0;
    for areal_density in [1e-7, 1e-4, 0.15] {
        for is_body in [false, true] {
            let mut scene = Scene {
                resolution: UVec2::splat(21),
                gravity: Vec3::ZERO,
                ..Scene::default()
            };
            scene.material.areal_density = areal_density;
            let mut sheet = Sheet::new(&scene);
            let ball = sheet.sim.spawn(());
            if !is_body {
                let ball = (ClothCollider::sphere(0.3), Transform::default());
                sheet.sim.app.world_mut().spawn(ball);
            }
            let place = |step: u8| Vec3::Z * (SPEED * f32::from(step) / 60.0 - 0.5);
            let mut touched = false;
            for step in 0..60 {
                if is_body {
                    let [start, end] = [step, step + 1].map(place);
                    push_ball(&mut sheet, ball, 0.3, [start, end], 1.0 / 50.0);
                } else {
                    let mut balls = sheet
                        .sim
                        .app
                        .world_mut()
                        .query_filtered::<&mut Transform, With<ClothCollider>>();
                    for mut at in balls.iter_mut(sheet.sim.app.world_mut()) {
                        at.translation = place(step + 1);
                    }
                }
                sheet.step();
                assert_eq!(sheet.complaint(), None);
                let particles = sheet.particles();
                let speeds = (0..particles.len()).map(|i| particles.velocity(i).length());
                let fastest = speeds.fold(0.0, f32::max);
                touched |= fastest > 0.5 * SPEED;
                // The rim of the sheet whips around, drawn in by a middle that goes ahead.
                assert!(
                    fastest < 4.0 * SPEED,
                    "{areal_density} kg/m², a body: {is_body}, step {step}: {fastest} m/s"
                );
            }
            assert!(touched, "{areal_density} kg/m²: the ball did not meet it");
        }
    }
}

fn push_ball(
    sheet: &mut Sheet,
    entity: Entity,
    radius: f32,
    [start, end]: [Vec3; 2],
    inv_mass: f32,
) {
    let inv_inertia = inv_mass / (0.4 * radius * radius);
    let mut colliders = sheet.sim.resource_mut::<ClothExternalColliders>();
    colliders.push(external(
        entity,
        ClothColliderShape::Sphere { radius },
        [
            Isometry3d::from_translation(start),
            Isometry3d::from_translation(end),
        ],
        Some(ClothColliderBody {
            body: entity,
            inv_mass: Vec3::splat(inv_mass),
            inv_inertia: Mat3::IDENTITY * inv_inertia,
            center_of_mass: end,
            linear_velocity: (end - start) * 60.0,
            angular_velocity: Vec3::ZERO,
        }),
    ));
}

/// Positions of tiles or balls of a square of 2 m.
fn places(side: u32) -> impl Iterator<Item = Vec3> {
    let at = move |k: u32| 2.0 * (k as f32 + 0.5) / side as f32 - 1.0;
    (0..side * side).map(move |k| Vec3::new(at(k % side), at(k / side), 0.0))
}

/// Thousands of contacts with hundreds of things, all at once: not one is left out.
#[test]
fn a_fixed_contact_buffer_overflowing_silently() {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::splat(64),
        ..Scene::default()
    });
    for place in places(20) {
        let tile = ClothCollider::cuboid(0.099, 0.099, 0.1);
        let at = Transform::from_translation(place - Vec3::Z * 0.1);
        sheet.sim.app.world_mut().spawn((tile, at));
    }
    sheet.steps(60);
    let surface = -0.05 + rigid().thickness;
    for (i, p) in sheet.particles().positions().enumerate() {
        assert!((p.z - surface).abs() < 1e-5, "particle {i} at {p}");
    }
}

/// Every body gets its part of the weight, and no more than the weight comes together, however many particles there are.
#[test]
fn a_force_given_per_body_applied_per_vertex() {
    for side in [40, 80] {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(side),
            ..Scene::default()
        });
        let balls: Vec<(Entity, Vec3)> = places(16)
            .map(|place| {
                let entity = sheet.sim.spawn(());
                (entity, place - Vec3::Z * 0.1)
            })
            .collect();
        let mut carried = vec![0.0f32; balls.len()];
        for step in 0..180 {
            for (entity, place) in &balls {
                push_ball(&mut sheet, *entity, 0.06, [*place; 2], 1e-6);
            }
            sheet.step();
            if step >= 120 {
                let reactions = sheet.sim.resource::<ClothReactions>();
                for ((entity, _), carried) in balls.iter().zip(&mut carried) {
                    *carried -= reactions.get(*entity).map_or(0.0, |r| r.impulse.z);
                }
            }
        }
        // In one second.
        let weight = sheet.mass() as f32 * G;
        let sum = carried.iter().sum::<f32>();
        assert!((sum / weight - 1.0).abs() < 5e-4, "{sum} N of {weight} N");
        let nothing = carried.iter().filter(|carried| **carried <= 0.0).count();
        // A sheet that hardly stretches, and is stiff, need not lie on all of them.
        let count = balls.len();
        assert!(
            nothing <= count / 50,
            "{nothing} of {count} balls carry nothing"
        );
    }
}

/// The order in which colliders are stored does not matter.
#[test]
fn results_depending_on_hashmap_order() {
    let run = |mixed: bool| {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(20),
            ..Scene::default()
        });
        for (k, (_, collider, rotation)) in tables().into_iter().enumerate() {
            let at = Vec3::new((k % 4) as f32 - 1.5, (k / 4) as f32 - 1.0, -1.5) * 0.4;
            let at = Transform::from_translation(at)
                .with_rotation(rotation)
                .with_scale(Vec3::splat(0.4));
            let mut entity = sheet.sim.app.world_mut().spawn((collider, at));
            if mixed && k % 3 == 1 {
                // Stored elsewhere from now on, and met in another order.
                entity.insert(ClothLayers::ALL);
            }
        }
        sheet.steps(90);
        assert_eq!(sheet.complaint(), None);
        sheet.hash()
    };
    let first = run(false);
    assert_eq!(first, run(false));
    assert_eq!(first, run(true));
}
