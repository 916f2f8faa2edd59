//! A silk curtain on a line, and a fan that turns to and fro in front of it: wind in a part of the world.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::prelude::*;
use tailorbird::prelude::*;

use super::{
    moving::Moving,
    scenes::{SceneAssets, SceneEntity},
};

/// Of the fan's axis above the ground, and in front of the curtain [m].
const AXIS: Vec3 = Vec3::new(0.0, 0.95, 1.5);
/// Of its blades [m].
const BLADES: f32 = 0.21;
/// Distance that its air reaches [m].
const REACH: f32 = 2.4;
/// The air before the blades [m/s].
const SPEED: f32 = 5.0;
/// From one side to the other and back [s].
const SWEEP: f32 = 7.0;

/// Air that the fan moves: a box before it, along its z axis.
fn draught() -> ClothWindZone {
    let size = Vec3::new(0.68, 0.68, REACH);
    ClothWindZone {
        falloff: 0.22,
        gusts: ClothGusts {
            strength: 0.15,
            period: 0.8,
        },
        turbulence: ClothTurbulence {
            speed: 0.8,
            scale: 0.4,
            seed: 3,
        },
        ..ClothWindZone::cuboid(size, SPEED * Vec3::Z)
    }
}

/// Spawns the line and the fan.
pub fn spawn(commands: &mut Commands, assets: &mut SceneAssets) {
    spawn_line(commands, assets);
    let dark = assets.painted(Color::srgb(0.13, 0.14, 0.16), 0.5, 0.0);
    let steel = assets.painted(Color::srgb(0.62, 0.64, 0.67), 0.3, 1.0);
    let forward = Quat::from_rotation_x(FRAC_PI_2);
    let ground = AXIS.with_y(0.0);
    let pole = Cylinder::new(0.014, AXIS.y);
    let foot = ConicalFrustum {
        radius_top: 0.05,
        radius_bottom: 0.17,
        height: 0.05,
    };
    let stand = [
        (assets.mesh(pole), 0.5 * AXIS.y),
        (assets.mesh(foot), 0.025),
    ];
    for (mesh, height) in stand {
        let place = Transform::from_translation(ground + height * Vec3::Y);
        commands.spawn((SceneEntity, mesh, dark.clone(), place));
    }
    let rings = [-0.035, 0.0, 0.035].map(|z: f32| {
        let shape = Torus {
            minor_radius: 0.004,
            major_radius: BLADES + 0.02 - 2.0 * z.abs(),
        };
        let place = Transform::from_xyz(0.0, 0.0, 0.08 + z).with_rotation(forward);
        (assets.mesh(shape), place)
    });
    let spokes = (0..8).map(|spoke| {
        let angle = TAU * spoke as f32 / 8.0;
        let out = Quat::from_rotation_z(angle) * Vec3::Y * 0.5 * BLADES;
        Transform::from_translation(out + 0.118 * Vec3::Z)
            .with_rotation(Quat::from_rotation_z(angle))
    });
    let spoke = assets.mesh(Cylinder::new(0.002, BLADES));
    let motor = assets.mesh(Capsule3d::new(0.05, 0.1));
    let blade = assets.mesh(Cuboid::new(0.075, 0.17, 0.003));
    let air = Transform::from_xyz(0.0, 0.0, 0.5 * REACH + 0.1);
    commands
        .spawn((
            Name::new("fan"),
            SceneEntity,
            Moving::along(sweep),
            Transform::default(),
            Visibility::default(),
        ))
        .with_children(|head| {
            head.spawn((Name::new("draught"), draught(), air));
            let back = Transform::from_xyz(0.0, 0.0, -0.04).with_rotation(forward);
            head.spawn((motor, dark.clone(), back));
            for (ring, place) in rings {
                head.spawn((ring, steel.clone(), place));
            }
            for place in spokes {
                head.spawn((spoke.clone(), steel.clone(), place));
            }
            head.spawn((
                SceneEntity,
                Moving::along(spin),
                Transform::default(),
                Visibility::default(),
            ))
            .with_children(|hub| {
                for turn in [0.0, TAU / 3.0, 2.0 * TAU / 3.0] {
                    let turn = Quat::from_rotation_z(turn);
                    let place = Transform::from_translation(turn * Vec3::new(0.0, 0.12, 0.0))
                        .with_rotation(turn * Quat::from_rotation_y(0.55));
                    hub.spawn((blade.clone(), dark.clone(), place));
                }
            });
        });
}

fn spawn_line(commands: &mut Commands, assets: &mut SceneAssets) {
    const HALF: f32 = 1.3;
    const HEIGHT: f32 = 1.9;
    let wood = assets.painted(Color::srgb(0.42, 0.28, 0.17), 0.7, 0.0);
    let cord = assets.painted(Color::srgb(0.80, 0.78, 0.72), 0.9, 0.0);
    let post = assets.mesh(Cylinder::new(0.03, HEIGHT + 0.06));
    for x in [-HALF, HALF] {
        let place = Transform::from_xyz(x, 0.5 * HEIGHT + 0.03, 0.0);
        commands.spawn((SceneEntity, post.clone(), wood.clone(), place));
    }
    let across =
        Transform::from_xyz(0.0, HEIGHT, 0.0).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    let line = assets.mesh(Cylinder::new(0.005, 2.0 * HALF));
    commands.spawn((SceneEntity, line, cord, across));
}

/// Towards the curtain, and to and fro.
fn sweep(t: f32) -> Transform {
    let turn = 0.6 * (TAU * t / SWEEP).sin();
    Transform::from_translation(AXIS)
        .with_rotation(Quat::from_rotation_y(std::f32::consts::PI + turn))
}

/// Slow enough to be seen.
fn spin(t: f32) -> Transform {
    Transform::from_xyz(0.0, 0.0, 0.08).with_rotation(Quat::from_rotation_z(9.0 * t))
}

/// Holds the upper edge, of this width [m] and so many columns, in pleats along the line.
pub fn pleats(width: f32, columns: u32) -> ClothPins {
    // What is gathered: 1 is flat.
    const GATHERED: f32 = 0.8;
    const PLEATS: f32 = 11.0;
    let length = GATHERED * width;
    let wave = TAU * PLEATS / length;
    // The length of a sine of amplitude a and wave number k over s is about s (1 + (a k)²/4).
    let depth = (4.0 * (1.0 / GATHERED - 1.0)).sqrt() / wave;
    let pins = (0..columns).map(|column| {
        let part = column as f32 / (columns - 1).max(1) as f32;
        let place = Vec3::new(
            length * (part - 0.5),
            0.0,
            depth * (TAU * PLEATS * part).sin(),
        );
        ClothPin::at(column, place)
    });
    ClothPins {
        pins: pins.collect(),
    }
}
