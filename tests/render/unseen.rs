//! Cloth that no camera and no light sees sleeps where it is to, and only there.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::offscreen::{Offscreen, keep, pixel};

const SIZE: UVec2 = UVec2::new(120, 90);

fn is_unseen(app: &Offscreen, cloth: Entity) -> bool {
    let rest = app.app.world().get::<ClothSleepState>(cloth);
    rest.is_some_and(ClothSleepState::is_unseen)
}

#[test]
fn cloth_sleeps_while_neither_it_nor_its_shadow_is_seen() {
    let Some(mut app) = Offscreen::new("cloth that nobody sees", SIZE) else {
        return;
    };
    let target = app.target();
    let world = app.app.world_mut();
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            unlit: true,
            ..default()
        });
    let away = Transform::from_xyz(0.0, 0.0, 3.0).looking_at(Vec3::Z * 9.0, Vec3::Y);
    let camera = world
        .spawn((Camera3d::default(), target, Msaa::Off, away))
        .id();
    let mut spawn = |unseen: bool, x: f32| {
        let sleep = ClothSleep {
            unseen,
            ..ClothSleep::never()
        };
        let cloth = (
            Cloth::grid(Vec2::ONE, UVec2::splat(8)).centered(),
            ClothPins::edges([ClothEdge::Top]),
            MeshMaterial3d(material.clone()),
            Transform::from_xyz(x, 0.0, 0.0),
            sleep,
        );
        world.spawn(cloth).id()
    };
    let (sleeps, stays) = (spawn(true, 0.0), spawn(false, 2.0));
    app.update(10);
    assert!(is_unseen(&app, sleeps) && !is_unseen(&app, stays));
    let hash = |app: &Offscreen| {
        let particles = app.app.world().get::<ClothParticles>(sleeps);
        particles.map(|p| {
            p.positions()
                .map(|p| p.to_array().map(f32::to_bits))
                .collect::<Vec<_>>()
        })
    };
    let before = hash(&app);
    app.update(10);
    assert_eq!(hash(&app), before);

    // Its mesh is built anew though nobody sees it.
    for n in [13, 5, 8] {
        let mut cloth = app
            .app
            .world_mut()
            .get_mut::<Cloth>(sleeps)
            .expect("a cloth");
        *cloth = Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered();
        app.update(3);
    }
    assert!(is_unseen(&app, sleeps));

    // A light whose shadows it is in sees it, where a camera sees the light's shadows.
    let light = app
        .app
        .world_mut()
        .spawn((
            PointLight {
                shadow_maps_enabled: true,
                range: 20.0,
                ..default()
            },
            Transform::from_xyz(0.0, 1.0, 4.0),
        ))
        .id();
    app.update(4);
    assert!(!is_unseen(&app, sleeps));
    app.app.world_mut().despawn(light);
    app.update(4);
    assert!(is_unseen(&app, sleeps));

    let here = Transform::from_xyz(0.0, 0.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    app.app.world_mut().entity_mut(camera).insert(here);
    app.update(4);
    assert!(!is_unseen(&app, sleeps));
    let picture = app.picture();
    keep(&picture, "unseen");
    let [middle, corner] = [SIZE / 2, UVec2::ONE].map(|at| pixel(&picture, at)[0]);
    assert!(middle > 150 && corner < 80, "{middle} {corner}");
}
