//! Maximum distance and backstop.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{DT, Path, Sim};

use crate::world::{rigid, square, vacuum};

fn rest(cloth: Entity, world: &Sim) -> Vec<Vec3> {
    world.get::<Cloth>(cloth).rest_positions()
}

#[test]
fn no_particle_gets_further_than_it_may() {
    let mut world = vacuum();
    let weights = (0..81).map(|i| (i / 9) as f32 / 8.0);
    let limits = ClothPerParticle::weighted(weights.clone(), 0.3);
    let cloth = world.spawn((square(9), ClothMotionConstraints::at_most(limits)));
    let rest = rest(cloth, &world);
    for _ in 0..200 {
        world.steps(1);
        for ((i, rest), weight) in rest.iter().enumerate().zip(weights.clone()) {
            let away = world.at(cloth, i).distance(*rest);
            assert!(away <= 0.3 * weight + 1e-5, "{i}: {away}");
        }
    }
    // The sheet turned edgewise sags as far as it may.
    assert!(world.at(cloth, 0) == rest[0]);
}

#[test]
fn held_rows_are_as_good_as_pins() {
    let simulate = |held: bool| {
        let mut world = vacuum();
        let cloth = world.spawn((
            square(12),
            Transform::from_rotation(Quat::from_rotation_x(-1.0)),
        ));
        if held {
            let limits = (0..144)
                .map(|i| if i < 12 { 0.0 } else { f32::INFINITY })
                .collect::<Vec<_>>();
            world.insert(cloth, ClothMotionConstraints::at_most(limits));
        } else {
            world.edit(cloth, |pins: &mut ClothPins| {
                *pins = ClothPins::edges([ClothEdge::Top]);
            });
        }
        world.steps(60);
        assert_eq!(
            world
                .get::<tailorbird_cloth::tethers::ClothTethers>(cloth)
                .pins()
                .count(),
            4
        );
        world.hash(cloth)
    };
    assert_eq!(simulate(true), simulate(false));
}

#[test]
fn a_backstop_holds_a_sheet_that_falls_on_it_and_lets_it_rest() {
    let mut world = vacuum();
    // Horizontal, normals up.
    let lying = Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let constraints = ClothMotionConstraints::default().with_backstop(0.1, 50.0);
    let cloth = world.spawn((square(9), lying, constraints));
    let mut before = f64::INFINITY;
    for step in 0..900 {
        world.steps(1);
        for p in world.positions(cloth) {
            assert!(p.y > -0.1 - 1e-5, "step {step}: {p}");
        }
        if step % 300 == 299 {
            let energy = world.particles(cloth).kinetic_energy();
            assert!(
                energy < 1e-9 && energy <= before + 1e-12,
                "{step}: {energy} J"
            );
            before = energy;
        }
    }
    assert!(world.positions(cloth).iter().all(|p| p.y < -0.09));
}

/// Targets of a sheet that swings about the axis of y: rigid, as skinning by one bone makes them.
fn swing(t: f32) -> Transform {
    Transform::from_xyz(t.sin() * 2.0, 0.0, 0.0).with_rotation(Quat::from_rotation_y(2.0 * t.sin()))
}

#[derive(Resource, Default)]
struct Clock(f32);

fn animate(mut clock: ResMut<Clock>, mut cloths: Query<(&Cloth, &mut ClothMotionTargets)>) {
    clock.0 += DT;
    let at = swing(clock.0);
    for (cloth, mut targets) in &mut cloths {
        let positions = cloth
            .rest_positions()
            .into_iter()
            .map(|p| at.transform_point(p));
        targets.set_positions(positions);
    }
}

#[test]
fn targets_in_either_space_are_followed_without_lag() {
    for space in [ClothTargetSpace::Frame, ClothTargetSpace::World] {
        let mut world = vacuum();
        world.app.init_resource::<Clock>();
        world.app.add_systems(bevy_app::FixedUpdate, animate);
        let most = 0.05;
        let limits = (0..81)
            .map(|i| if i < 9 { 0.0 } else { most })
            .collect::<Vec<_>>();
        let frame =
            |t: f32| Transform::from_xyz(t, 0.5, 0.0).with_rotation(Quat::from_rotation_z(t));
        let cloth = world.spawn((
            square(9),
            frame(0.0),
            Path::new(frame),
            ClothMotionConstraints::at_most(limits).with_backstop(0.02, 1.0),
            ClothMotionTargets::in_space(space),
        ));
        let rest = rest(cloth, &world);
        for _ in 0..90 {
            world.steps(1);
            let clock = world.resource::<Clock>().0;
            let at = swing(clock);
            for (i, rest) in rest.iter().enumerate() {
                let p = match space {
                    ClothTargetSpace::Frame => world.particles(cloth).position(i),
                    ClothTargetSpace::World => world.at(cloth, i),
                };
                let away = p.distance(at.transform_point(*rest));
                let most = if i < 9 { 0.0 } else { most };
                assert!(away <= most + 2e-5, "{space:?}, {i}: {away}");
                let behind = (at.rotation * Vec3::NEG_Z).dot(p - at.transform_point(*rest));
                assert!(behind < 0.025, "{space:?}, {i}: {behind} behind");
            }
        }
    }
}

#[test]
fn a_sphere_counts_before_the_maximum_distance() {
    let mut world = vacuum();
    world.spawn((
        ClothCollider::sphere(0.3),
        Transform::from_xyz(0.0, 0.0, -0.2),
    ));
    let cloth = world.spawn((square(17), ClothMotionConstraints::at_most(0.01)));
    world.steps(60);
    let center = Vec3::new(0.0, 0.0, -0.2);
    for p in world.positions(cloth) {
        assert!(p.distance(center) > 0.299, "{p}");
    }
}

#[test]
fn constraints_that_are_removed_let_go() {
    let mut world = vacuum();
    let cloth = world.spawn((square(9), ClothMotionConstraints::at_most(0.0)));
    world.steps(10);
    assert_eq!(world.at(cloth, 40), Vec3::ZERO);
    world
        .app
        .world_mut()
        .entity_mut(cloth)
        .remove::<ClothMotionConstraints>();
    world.steps(60);
    assert!(world.at(cloth, 40).y < -3.0);
}

#[test]
fn a_mesh_is_constrained_by_its_own_numbers() {
    // The particles of a mesh are stored in another order.
    let grid = Cloth::grid(Vec2::ONE, UVec2::new(6, 5));
    let mut positions = grid.rest_positions();
    positions.reverse();
    let cell = |c: u32, r: u32| {
        let i = |c: u32, r: u32| 29 - (r * 6 + c);
        [
            i(c, r),
            i(c, r + 1),
            i(c + 1, r),
            i(c + 1, r),
            i(c, r + 1),
            i(c + 1, r + 1),
        ]
    };
    let indices: Vec<u32> = (0..4)
        .flat_map(|r| (0..5).flat_map(move |c| cell(c, r)))
        .collect();
    let mut world = vacuum();
    let limits: Vec<f32> = (0..30)
        .map(|i| if i % 7 == 0 { 0.0 } else { 0.01 * i as f32 })
        .collect();
    let cloth = world.spawn((
        Cloth::mesh(positions, indices),
        rigid(),
        ClothMotionConstraints::at_most(limits.clone()),
    ));
    let rest = rest(cloth, &world);
    for _ in 0..100 {
        world.steps(1);
        for (i, rest) in rest.iter().enumerate() {
            assert!(
                world.at(cloth, i).distance(*rest) <= limits[i] + 1e-5,
                "{i}"
            );
        }
    }
}
