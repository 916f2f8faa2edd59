//! A ball of 2 kg falls on a sheet that is held at its edges, without a window. Prints the ball's height, the force with which
//! the sheet carries it, and what the pins carry: that force and the sheet's weight.
//!
//! ```sh
//! cargo run -p tailorbird_avian --example avian_ball
//! ```

use std::{f32::consts::FRAC_PI_2, time::Duration};

use avian3d::prelude::*;
use bevy_app::{App, TaskPoolPlugin};
use bevy_math::{Quat, UVec2, Vec2};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::{TransformPlugin, components::Transform};
use tailorbird_avian::ClothAvianPlugin;
use tailorbird_cloth::prelude::*;

const HZ: u32 = 60;
const MASS: f32 = 2.0;
const GRAVITY: f32 = 9.81;

fn main() {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin));
    app.add_plugins((
        PhysicsPlugins::default(),
        ClothPlugin::default(),
        ClothAvianPlugin::default(),
    ));
    // Each update is a step, as fast as the machine can.
    let step = Duration::from_secs(1) / HZ;
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step))
        .insert_resource(Time::<Fixed>::from_duration(step));

    // A ball that weighs three times as much as the sheet takes more substeps than the sheet alone.
    app.insert_resource(ClothSettings {
        substeps: Some(32),
        ..ClothSettings::default()
    });

    let edges = [
        ClothEdge::Top,
        ClothEdge::Bottom,
        ClothEdge::Left,
        ClothEdge::Right,
    ];
    let material = ClothMaterial::cotton();
    let side = 2.0;
    app.world_mut().spawn((
        Cloth::grid(Vec2::splat(side), UVec2::splat(32)).centered(),
        material,
        ClothPins::edges(edges),
        Transform::from_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
    ));
    let ball = app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::sphere(0.15),
        Mass(MASS),
        LinearDamping(1.0),
        Transform::from_xyz(0.0, 0.65, 0.0),
    ));
    let ball = ball.id();
    app.finish();
    app.cleanup();

    let sheet_weight = material.areal_density * side * side * GRAVITY;
    println!(
        "the ball weighs {:.2} N, the sheet {sheet_weight:.2} N",
        MASS * GRAVITY
    );
    println!("   time   height     force      pins");
    let mut impulse = 0.0;
    for step in 1..=8 * HZ {
        app.update();
        let reactions = app.world().resource::<ClothReactions>();
        impulse += reactions.get(ball).map_or(0.0, |push| push.impulse.y);
        if step % (HZ / 2) == 0 {
            let force = impulse * 2.0;
            impulse = 0.0;
            let height = app.world().get::<Position>(ball).map_or(0.0, |at| at.y);
            let time = step as f32 / HZ as f32;
            println!(
                "{time:5.1} s {height:6.3} m {force:7.2} N {:7.2} N",
                force + sheet_weight
            );
        }
    }
}
