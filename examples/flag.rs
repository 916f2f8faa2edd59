//! A flag in a gusty wind. Drag it with the left mouse button, turn the camera with the right one; the keys W and S
//! make the wind stronger and weaker, A and D turn it.

mod common;

use std::process::ExitCode;

use bevy::prelude::*;
use common::{
    camera::OrbitCamera,
    graphics::check_driver,
    scenes::{SceneAssets, SceneKind, spawn_scene},
    settings::DemoSettings,
    stage::StagePlugin,
    window::ExitAfterFrames,
};
use tailorbird::prelude::*;

fn main() -> ExitCode {
    if let Err(message) = check_driver() {
        eprintln!("flag: {message}");
        return ExitCode::FAILURE;
    }
    App::new()
        .add_plugins((
            DefaultPlugins,
            ClothPlugins::default(),
            ClothDragPlugin,
            StagePlugin::default(),
            ExitAfterFrames,
        ))
        .insert_resource(SceneKind::Flag.wind())
        .add_systems(Startup, hoist)
        .add_systems(PostStartup, look)
        .add_systems(Update, change_wind)
        .run();
    ExitCode::SUCCESS
}

/// A flag of silk on a pole.
fn hoist(mut commands: Commands, mut assets: SceneAssets) {
    spawn_scene(
        &mut commands,
        &DemoSettings::of(SceneKind::Flag),
        &mut assets,
    );
}

fn look(mut camera: Single<&mut OrbitCamera>) {
    **camera = SceneKind::Flag.view();
}

fn change_wind(keys: Res<ButtonInput<KeyCode>>, time: Res<Time>, mut wind: ResMut<Wind>) {
    let axis = |more, less| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let stronger = axis(KeyCode::KeyW, KeyCode::KeyS) * time.delta_secs();
    let turn = axis(KeyCode::KeyA, KeyCode::KeyD) * time.delta_secs();
    if stronger != 0.0 || turn != 0.0 {
        let turned = Quat::from_rotation_y(turn) * wind.velocity;
        wind.velocity = (turned * (1.0 + stronger)).clamp_length(0.1, 20.0);
    }
}
