//! Filters: colliders that cloth does not meet, and bodies that it does not wake.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use tailorbird_cloth::prelude::*;

use crate::world::{Body, Contact, Form, G, HZ, World, lying};

/// Distance that a sheet falls within a second over a box that would stop it after 0.2 m; the sheet has these layers.
fn falls(contact: Contact, layers: Option<ClothLayers>) -> f32 {
    let mut world = World::earth();
    let pins = ClothPins::default();
    let sheet = world.sheet(0.5, 16, ClothMaterial::cotton(), pins, lying(0.0));
    if let Some(layers) = layers {
        world.app.world_mut().entity_mut(sheet).insert(layers);
    }
    world.body(&Body {
        contact,
        ..Body::fixed(Form::Box(Vec3::new(4.0, 0.2, 4.0)), Vec3::Y * -0.3)
    });
    world.seconds(1.0);
    assert_eq!(world.complaint(sheet), None);
    let points = world.points(sheet);
    -points.iter().map(|p| p.y).sum::<f32>() / points.len() as f32
}

#[test]
fn layers_sensors_and_the_marker_opt_out() {
    let free = 0.5 * G;
    let stopped = |distance: f32| (0.18..0.21).contains(&distance);
    // The material's damping takes a part.
    let through = |distance: f32| distance > 0.8 * free;
    let cloth = |memberships, filters| Some(ClothLayers::new(memberships, filters));
    assert!(stopped(falls(Contact::Yes, None)));
    assert!(through(falls(Contact::Sensor, None)));
    assert!(through(falls(Contact::Disabled, None)));
    assert!(stopped(falls(
        Contact::Layers(0b10, 0b01),
        cloth(0b01, 0b10)
    )));
    assert!(through(falls(
        Contact::Layers(0b10, 0b01),
        cloth(0b01, 0b01)
    )));
    assert!(through(falls(
        Contact::Layers(0b10, 0b100),
        cloth(0b01, 0b10)
    )));
    assert!(through(falls(Contact::Layers(0, 0), None)));
    assert!(through(falls(Contact::Yes, cloth(0, 0))));
}

#[test]
fn a_collider_that_is_despawned_is_gone() {
    let mut world = World::earth();
    let pins = ClothPins::default();
    let sheet = world.sheet(0.5, 16, ClothMaterial::cotton(), pins, lying(0.0));
    let floor = world.body(&Body::fixed(
        Form::Box(Vec3::new(4.0, 0.2, 4.0)),
        Vec3::Y * -0.3,
    ));
    world.seconds(1.0);
    let lowest = |world: &World| world.points(sheet).iter().fold(f32::MAX, |y, p| y.min(p.y));
    assert!(lowest(&world) > -0.21, "{}", lowest(&world));
    world.app.world_mut().despawn(floor);
    world.seconds(1.0);
    assert!(lowest(&world) < -2.0, "{}", lowest(&world));
}

/// A crate that sleeps on a floor, and a sheet on both.
fn draped() -> (World, Entity, Entity) {
    let mut world = World::earth();
    world.body(&Body::fixed(Form::HalfSpace(Vec3::Y), Vec3::ZERO));
    let cube = world.body(&Body {
        sleeps: true,
        ..Body::new(Form::Box(Vec3::splat(0.4)), 5.0, Vec3::Y * 0.2)
    });
    world.seconds(3.0);
    assert!(world.motion(cube).asleep);
    let pins = ClothPins::default();
    let sheet = world.sheet(1.2, 24, ClothMaterial::cotton(), pins, lying(0.6));
    (world, cube, sheet)
}

#[test]
fn a_body_sleeps_on_under_a_sheet_that_lies_on_it() {
    let (mut world, cube, sheet) = draped();
    // What lands on it may wake it: 0.2 kg at 2 m/s on 5 kg.
    world.seconds(6.0);
    assert!(world.motion(cube).asleep);
    let at = world.motion(cube).position;
    for _ in 0..4 * HZ {
        world.steps(1);
        assert!(world.motion(cube).asleep);
    }
    assert_eq!(world.motion(cube).position, at);
    assert!(world.depth(sheet, cube) < 1e-3);
    assert_eq!(world.complaint(sheet), None);
}

#[test]
fn a_body_that_sleeps_wakes_from_a_pull() {
    let (mut world, cube, sheet) = draped();
    world.seconds(6.0);
    assert!(world.motion(cube).asleep);
    // 100 N sideways on the particles at the crate's left face push it to the right.
    let at = world.motion(cube).position;
    for _ in 0..HZ / 2 {
        let points = world.points(sheet);
        let face: Vec<u32> = (0..points.len())
            .filter(|i| points[*i].x < -0.15 && points[*i].y > 0.05 && points[*i].z.abs() < 0.2)
            .map(|i| i as u32)
            .collect();
        let mut forces = world.app.world_mut().get_mut::<ClothForces>(sheet).unwrap();
        let force = Vec3::X * 100.0 / face.len().max(1) as f32;
        face.iter().for_each(|i| forces.add_force(*i, force));
        world.steps(1);
    }
    let motion = world.motion(cube);
    println!("{motion:?}");
    assert!((motion.position - at).x > 0.05, "{motion:?}");
}
