//! A cloth is drawn again after the graphics device was lost, where it was.

use std::{thread, time::Duration};

use bevy::{
    prelude::*,
    render::{
        error_handler::{RenderErrorHandler, RenderErrorPolicy},
        render_resource::PollType,
        renderer::RenderDevice,
        settings::{Backends, RenderCreation, WgpuSettings},
    },
};
use tailorbird::prelude::*;

use crate::offscreen::{Offscreen, difference, keep};

#[test]
fn cloth_is_there_after_the_device_was_lost() {
    let size = UVec2::new(160, 120);
    let Some(mut app) = Offscreen::new("loss of the device", size) else {
        return;
    };
    let recover = RenderErrorHandler(|_, _, _| {
        let settings = WgpuSettings {
            backends: Some(Backends::PRIMARY),
            ..default()
        };
        RenderErrorPolicy::Recover(RenderCreation::Automatic(Box::new(settings)))
    });
    app.app.insert_resource(recover);
    let target = app.target();
    let world = app.app.world_mut();
    let cloth = world.resource_mut::<Assets<StandardMaterial>>();
    let look = cloth.into_inner().add(StandardMaterial {
        unlit: true,
        ..Color::srgb(0.9, 0.2, 0.1).into()
    });
    world.spawn((
        Cloth::grid(Vec2::ONE, UVec2::splat(20)).centered(),
        ClothPins::corners(ClothCorner::TOP),
        ClothSleep::never(),
        MeshMaterial3d(look),
        Transform::from_rotation(Quat::from_rotation_x(-1.2)),
    ));
    let eye = Transform::from_xyz(0.0, 0.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((Camera3d::default(), target, Msaa::Off, eye));
    app.update(25);
    app.app.world_mut().resource_mut::<ClothSettings>().paused = true;
    app.update(2);
    let before = app.picture();
    keep(&before, "device_before");

    let lost = app.app.world().resource::<RenderDevice>().clone();
    lost.wgpu_device().destroy();
    // As a driver would tell it: before the next frame.
    let _ = lost.poll(PollType::Poll);
    let since = |app: &Offscreen| {
        app.app
            .world()
            .resource_ref::<RenderDevice>()
            .last_changed()
    };
    let before_loss = since(&app);
    let has_another = |app: &Offscreen| since(app) != before_loss;
    for _ in 0..200 {
        if has_another(&app) {
            break;
        }
        app.app.update();
        thread::sleep(Duration::from_millis(25));
    }
    assert_eq!(app.app.should_exit(), None, "the renderer came back");
    assert!(has_another(&app), "there is another device");
    app.update(3);
    let after = app.picture();
    keep(&after, "device_after");
    let changed = difference(&before, &after, 2);
    assert!(changed == 0.0, "{changed} of the picture differs");

    // And it goes on.
    app.app.world_mut().resource_mut::<ClothSettings>().paused = false;
    app.update(10);
    let later = app.picture();
    keep(&later, "device_later");
    assert!(difference(&after, &later, 30) > 0.01, "it moves");
}
