//! Props that cloth hangs from in the scenes.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use tailorbird::prelude::*;

use super::{
    moving::Moving,
    scenes::{SceneAssets, SceneEntity},
};

/// The rod above the curtain.
pub fn spawn_rail(commands: &mut Commands, assets: &mut SceneAssets) {
    let brass = assets.painted(Color::srgb(0.75, 0.6, 0.35), 0.35, 1.0);
    let rod = assets.mesh(Cylinder::new(0.014, 1.9));
    let knob = assets.mesh(Sphere::new(0.032));
    let across =
        Transform::from_xyz(0.0, 1.87, -0.015).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    commands.spawn((SceneEntity, rod, brass.clone(), across));
    for x in [-0.95, 0.95] {
        let place = Transform::from_xyz(x, 1.87, -0.015);
        commands.spawn((SceneEntity, knob.clone(), brass.clone(), place));
    }
}

/// The pole of the flag.
pub fn spawn_flagpole(commands: &mut Commands, assets: &mut SceneAssets) {
    let white = assets.painted(Color::srgb(0.85, 0.85, 0.86), 0.4, 0.0);
    let gold = assets.painted(Color::srgb(0.9, 0.7, 0.3), 0.3, 1.0);
    let pole = assets.mesh(Cylinder::new(0.022, 2.62));
    let knob = assets.mesh(Sphere::new(0.05));
    commands.spawn((
        SceneEntity,
        pole,
        white,
        Transform::from_xyz(0.0, 1.31, 0.0),
    ));
    commands.spawn((SceneEntity, knob, gold, Transform::from_xyz(0.0, 2.65, 0.0)));
}

/// Four posts under the corners of a sheet, so far from the middle and so high [m].
pub fn spawn_posts(commands: &mut Commands, assets: &mut SceneAssets, side: f32, height: f32) {
    let wood = assets.painted(Color::srgb(0.42, 0.28, 0.17), 0.7, 0.0);
    let post = assets.mesh(Cylinder::new(0.02, height));
    for (x, z) in [(-side, -side), (side, -side), (-side, side), (side, side)] {
        let place = Transform::from_xyz(x, 0.5 * height, z);
        commands.spawn((SceneEntity, post.clone(), wood.clone(), place));
    }
}

/// A boat that sails in circles; returns it.
pub fn spawn_boat(commands: &mut Commands, assets: &mut SceneAssets) -> Entity {
    let wood = assets.painted(Color::srgb(0.34, 0.21, 0.12), 0.6, 0.0);
    let pale = assets.painted(Color::srgb(0.62, 0.47, 0.30), 0.7, 0.0);
    let boat = (
        SceneEntity,
        Moving::along(sail),
        Transform::default(),
        Visibility::default(),
    );
    let boat = commands.spawn(boat).id();
    let hull = Transform::from_xyz(0.0, 0.2, 0.0).with_scale(Vec3::new(0.5, 1.0, 1.25));
    let deck = Transform::from_xyz(0.0, 0.375, 0.0).with_scale(Vec3::new(0.46, 1.0, 1.18));
    let across = Quat::from_rotation_z(FRAC_PI_2);
    let (mast, yard) = (2.3, 1.4);
    commands.entity(boat).with_children(|boat| {
        let shape = ConicalFrustum {
            radius_top: 1.0,
            radius_bottom: 0.62,
            height: 0.36,
        };
        boat.spawn((assets.mesh(shape), wood.clone(), hull));
        boat.spawn((assets.mesh(Cylinder::new(1.0, 0.02)), pale.clone(), deck));
        for (radius, length, at) in [
            (0.035, mast, Transform::from_xyz(0.0, 0.3 + 0.5 * mast, 0.0)),
            (
                0.022,
                yard,
                Transform::from_xyz(0.0, 2.34, 0.05).with_rotation(across),
            ),
        ] {
            boat.spawn((
                ClothCollider::capsule(radius, length),
                assets.mesh(Capsule3d::new(radius, length)),
                wood.clone(),
                at,
            ));
        }
    });
    boat
}

/// Holds the upper edge of the banner, of so many columns, at nine places.
pub fn rings(columns: u32) -> ClothPins {
    const RINGS: u32 = 8;
    ClothPins::particles((0..=RINGS).map(|ring| ring * (columns - 1) / RINGS))
}

/// In a circle, pitching and rolling.
fn sail(t: f32) -> Transform {
    let angle = 0.55 * t;
    let place = 1.1 * Vec3::new(angle.sin(), 0.0, angle.cos());
    let heave = 0.07 * (1.7 * t).sin();
    let swell = Quat::from_rotation_z(0.2 * (1.3 * t).sin())
        * Quat::from_rotation_x(0.1 * (1.9 * t + 1.0).sin());
    Transform::from_translation(place + heave * Vec3::Y)
        .with_rotation(Quat::from_rotation_y(angle + FRAC_PI_2) * swell)
}
