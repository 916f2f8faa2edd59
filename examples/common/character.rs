//! Somebody who runs in circles, jumps, and is put elsewhere now and then: capsules on bones.

use std::f32::consts::{PI, TAU};

use bevy::prelude::*;
use tailorbird::prelude::*;

use super::{
    camera::Followed,
    moving::Moving,
    scenes::{MaterialOf, SceneAssets, SceneEntity},
};

/// Of the circle [m].
const RADIUS: f32 = 1.7;
/// Along the circle [m/s].
const SPEED: f32 = 3.0;
/// Steps of each foot in a second [1/s].
const CADENCE: f32 = 1.45;
/// From jump to jump, and how long one takes [s].
const JUMPS: (f32, f32) = (3.2, 0.6);
/// Height of a jump [m].
const JUMP: f32 = 0.4;
/// From teleport to teleport [s].
const TELEPORTS: f32 = 8.0;

/// Motion of its wearer that a cape feels: most of the displacement, less of the turns, nothing of being put elsewhere.
pub fn inertia() -> ClothInertia {
    ClothInertia {
        linear: 0.7,
        angular: 0.5,
        teleport_speed: 40.0,
        ..default()
    }
}

/// Turn of a cape at rest: it lies in the air behind its wearer, not in the chest.
pub fn behind() -> Quat {
    Quat::from_rotation_x(1.2)
}

/// Holds the upper edge of a cape of this width [m] and so many columns around neck and shoulders, in pleats.
pub fn collar(width: f32, columns: u32) -> ClothPins {
    // An arc from shoulder to shoulder, behind the neck; the pleats take up what is too long.
    const HALF: Vec2 = Vec2::new(0.215, 0.155);
    const SPAN: f32 = 1.15 * PI;
    const PLEATS: f32 = 9.0;
    let arc = SPAN * 0.5 * (HALF.x + HALF.y);
    // The length of a sine of amplitude a and wave number k over s is about s (1 + (a k)²/4).
    let wave = TAU * PLEATS / arc;
    let depth = (4.0 * (width / arc - 1.0).max(0.0)).sqrt() / wave;
    let pins = (0..columns).map(|column| {
        let part = column as f32 / (columns - 1).max(1) as f32;
        let angle = SPAN * (part - 0.5);
        let out = 1.0 + depth * (TAU * PLEATS * part).sin() / HALF.x;
        let place = Vec3::new(
            -HALF.x * angle.sin(),
            0.03 * angle.cos(),
            -HALF.y * angle.cos(),
        );
        ClothPin::at(
            column,
            behind().inverse() * (place * Vec3::new(out, 1.0, out)),
        )
    });
    ClothPins {
        pins: pins.collect(),
    }
}

/// Spawns them; returns the chest.
pub fn spawn(commands: &mut Commands, assets: &mut SceneAssets) -> Entity {
    let skin = assets.painted(Color::srgb(0.62, 0.60, 0.58), 0.6, 0.0);
    let dark = assets.painted(Color::srgb(0.16, 0.17, 0.20), 0.7, 0.0);
    let mut flesh =
        |commands: &mut Commands, bone, radius: f32, length: f32, at, of: &MaterialOf| {
            let capsule = (
                ClothCollider::capsule(radius, length).with_friction(0.2),
                assets.mesh(Capsule3d::new(radius, length)),
                of.clone(),
                at,
            );
            commands.entity(bone).with_child(capsule);
        };
    let bone = |commands: &mut Commands, parent: Option<Entity>, path| {
        let moving = Moving::along(path);
        let bone = commands.spawn((
            SceneEntity,
            moving,
            Transform::default(),
            Visibility::default(),
        ));
        let bone = bone.id();
        if let Some(parent) = parent {
            commands.entity(parent).add_child(bone);
        }
        bone
    };
    let lying = Quat::from_rotation_z(0.5 * PI);
    let below = |length: f32| Transform::from_xyz(0.0, -0.5 * length, 0.0);

    let start = root(0.0);
    let root = bone(commands, None, root);
    commands.entity(root).insert((Followed, start));
    let pelvis = bone(commands, Some(root), pelvis);
    flesh(
        commands,
        pelvis,
        0.115,
        0.12,
        Transform::from_rotation(lying),
        &dark,
    );
    let chest = bone(commands, Some(pelvis), chest);
    let trunk = Transform::from_xyz(0.0, -0.06, 0.0);
    flesh(commands, chest, 0.125, 0.22, trunk, &skin);
    let shoulders = Transform::from_xyz(0.0, 0.15, 0.0).with_rotation(lying);
    flesh(commands, chest, 0.075, 0.24, shoulders, &skin);
    let head = bone(commands, Some(chest), head);
    flesh(
        commands,
        head,
        0.1,
        0.06,
        Transform::from_xyz(0.0, 0.14, 0.0),
        &skin,
    );
    flesh(commands, head, 0.05, 0.1, Transform::default(), &skin);

    let arms: [[fn(f32) -> Transform; 2]; 2] = [
        [|t| upper_arm(t, 1.0), |t| forearm(t, 1.0)],
        [|t| upper_arm(t, -1.0), |t| forearm(t, -1.0)],
    ];
    for [upper, lower] in arms {
        let upper = bone(commands, Some(chest), upper);
        flesh(commands, upper, 0.05, 0.26, below(0.28), &skin);
        let lower = bone(commands, Some(upper), lower);
        flesh(commands, lower, 0.042, 0.26, below(0.28), &skin);
    }
    let legs: [[fn(f32) -> Transform; 2]; 2] = [
        [|t| thigh(t, 1.0), |t| shin(t, 1.0)],
        [|t| thigh(t, -1.0), |t| shin(t, -1.0)],
    ];
    for [upper, lower] in legs {
        let upper = bone(commands, Some(pelvis), upper);
        flesh(commands, upper, 0.078, 0.36, below(0.42), &dark);
        let lower = bone(commands, Some(upper), lower);
        flesh(commands, lower, 0.055, 0.36, below(0.4), &dark);
    }
    chest
}

/// Part of a run that it is already, 0 to 1: it starts standing.
fn pace(t: f32) -> f32 {
    (t - 0.5).clamp(0.0, 1.0)
}

/// Distance that it ran along the circle [m].
fn path_length(t: f32) -> f32 {
    let since = (t - 0.5).max(0.0);
    SPEED
        * if since < 1.0 {
            0.5 * since * since
        } else {
            since - 0.5
        }
}

/// Phase of the step [rad].
fn phase(t: f32) -> f32 {
    TAU * CADENCE * path_length(t) / SPEED
}

/// Height above the ground while it jumps [m].
fn jump(t: f32) -> f32 {
    let part = t.rem_euclid(JUMPS.0) / JUMPS.1;
    if t > JUMPS.0 && part < 1.0 {
        4.0 * JUMP * part * (1.0 - part)
    } else {
        0.0
    }
}

fn root(t: f32) -> Transform {
    // Put to the other side of the circle now and then.
    let jumps = (t / TELEPORTS).floor();
    let angle = path_length(t) / RADIUS + PI * jumps;
    let place = RADIUS * Vec3::new(angle.sin(), 0.0, angle.cos());
    // It faces along +z of its own, and runs along +x where the angle is 0.
    Transform::from_translation(place + jump(t) * Vec3::Y)
        .with_rotation(Quat::from_rotation_y(angle + 0.5 * PI))
}

fn pelvis(t: f32) -> Transform {
    let bob = 0.035 * pace(t) * (2.0 * phase(t)).cos();
    Transform::from_xyz(0.0, 0.93 + bob, 0.0)
        .with_rotation(Quat::from_rotation_y(0.12 * pace(t) * phase(t).sin()))
}

fn chest(t: f32) -> Transform {
    let turn = Quat::from_rotation_y(-0.22 * pace(t) * phase(t).sin());
    // It leans forward, and into the curve.
    let lean = Quat::from_rotation_x(0.16 * pace(t)) * Quat::from_rotation_z(0.12 * pace(t));
    Transform::from_xyz(0.0, 0.36, 0.0).with_rotation(lean * turn)
}

fn head(t: f32) -> Transform {
    Transform::from_xyz(0.0, 0.24, 0.0).with_rotation(Quat::from_rotation_x(-0.12 * pace(t)))
}

fn upper_arm(t: f32, side: f32) -> Transform {
    let swing = 0.75 * pace(t) * phase(t).sin() * side;
    Transform::from_xyz(0.2 * side, 0.15, 0.0)
        .with_rotation(Quat::from_rotation_z(0.16 * side) * Quat::from_rotation_x(swing))
}

fn forearm(t: f32, _side: f32) -> Transform {
    let bent = -0.15 - 1.2 * pace(t);
    Transform::from_xyz(0.0, -0.28, 0.0).with_rotation(Quat::from_rotation_x(bent))
}

fn thigh(t: f32, side: f32) -> Transform {
    let swing = -0.8 * pace(t) * phase(t).sin() * side - 0.15 * pace(t);
    Transform::from_xyz(0.1 * side, -0.06, 0.0).with_rotation(Quat::from_rotation_x(swing))
}

fn shin(t: f32, side: f32) -> Transform {
    let bent = 0.15 + 0.65 * (1.0 + side * phase(t).cos());
    Transform::from_xyz(0.0, -0.42, 0.0).with_rotation(Quat::from_rotation_x(pace(t) * bent))
}
