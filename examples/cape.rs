//! Somebody in a cape who walks to and fro, hops and turns. The collar is attached to the shoulders, capsules on the body keep the
//! cape out, and it feels a part of the walk. Drag it with the left mouse button.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use bevy::{app::RunFixedMainLoopSystems::AfterFixedMainLoop, prelude::*};
use tailorbird::prelude::*;

/// A moving part: the whole figure, or what swings about a joint at a place [m] by a scaled axis [rad].
#[derive(Component, Clone, Copy)]
#[require(Transform, Visibility)]
enum Joint {
    Whole,
    Swings(Vec3, Vec3),
}

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.62, 0.72, 0.82)))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, walk)
        .add_systems(RunFixedMainLoop, walk.in_set(AfterFixedMainLoop))
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let grey = MeshMaterial3d(materials.add(Color::srgb(0.36, 0.38, 0.40)));
    let mut capsule = |radius, length, place| {
        let collider = ClothCollider::capsule(radius, length).with_friction(0.2);
        let mesh = Mesh3d(meshes.add(Capsule3d::new(radius, length)));
        (collider, mesh, grey.clone(), place)
    };
    let figure = commands.spawn(Joint::Whole).id();
    for side in [-1.0, 1.0] {
        let hip = Joint::Swings(Vec3::new(0.09 * side, 0.9, 0.0), 0.5 * side * Vec3::X);
        let leg = capsule(0.075, 0.66, Transform::from_xyz(0.0, -0.46, 0.0));
        commands.spawn((hip, ChildOf(figure), children![leg]));
        let shoulder = Joint::Swings(Vec3::new(0.23 * side, 1.42, 0.0), -0.4 * side * Vec3::X);
        let arm = capsule(0.045, 0.5, Transform::from_xyz(0.0, -0.28, 0.0));
        commands.spawn((shoulder, ChildOf(figure), children![arm]));
    }
    let trunk = capsule(0.13, 0.4, Transform::from_xyz(0.0, -0.08, 0.0));
    let across = Transform::from_rotation(Quat::from_rotation_z(FRAC_PI_2));
    let shoulders = capsule(0.07, 0.3, across.with_translation(0.22 * Vec3::Y));
    let head = capsule(0.1, 0.05, Transform::from_xyz(0.0, 0.44, 0.0));
    let chest = (Joint::Swings(1.2 * Vec3::Y, 0.2 * Vec3::Y), ChildOf(figure));
    let parts = children![trunk, shoulders, head];
    let chest = commands.spawn((chest, parts)).id();

    // Every fourth particle of the upper edge, on an arc that is shorter than the edge: so folds hang from it.
    let collar = (0..=12).map(|k| {
        let (sin, cos) = (1.1 * PI * (k as f32 / 12.0 - 0.5)).sin_cos();
        Vec3::new(0.23 * sin, 0.3, -0.13 * cos - 0.02)
    });
    let clasp = ClothAttachment::particles((0..=12).map(|k| 4 * k)).with_points(collar);
    commands.spawn((
        Cloth::grid(Vec2::new(1.0, 1.15), UVec2::new(49, 57)).with_origin(Vec2::new(0.5, 0.0)),
        // Heavier than it looks, so that it streams less.
        ClothMaterial::denim(),
        ClothLook::new(ClothFabric::COTTON).with_dye(Color::srgb(0.50, 0.05, 0.10)),
        // How much is felt of the motion of the cloth's own entity: so it is a child of the figure.
        ClothInertia {
            linear: 0.4,
            angular: 0.5,
            ..default()
        },
        ChildOf(figure),
        // At first it lies in the air behind the back.
        Transform::from_xyz(0.0, 1.5, -0.2).with_rotation(Quat::from_rotation_x(1.2)),
        related!(ClothAttachments[clasp.to(chest)]),
    ));

    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.35, 0.38, 0.34))),
    ));
    commands.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(-2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
        Transform::from_xyz(0.0, 1.6, 3.3).looking_at(0.95 * Vec3::Y, Vec3::Y),
    ));
}

/// Runs in each step, where cloth sees it, and once a frame: cloth is drawn between its last two steps, and so is the body, else
/// the one would be seen to cut into the other.
fn walk(time: Res<Time>, step: Res<Time<Fixed>>, mut joints: Query<(&Joint, &mut Transform)>) {
    let is_frame = time.elapsed() != step.elapsed();
    let late = f32::from(is_frame) * step.timestep().as_secs_f32();
    let t = (time.elapsed_secs() - late).max(0.0);
    // For 3.2 s on its way, with a hop; then half a turn. It looks along its z axis.
    let (walk_number, t) = ((t / 4.0).floor(), t % 4.0);
    let ease = |part: f32| 0.5 - 0.5 * (PI * part.clamp(0.0, 1.0)).cos();
    let x = 2.4 * (ease(t / 3.2) - 0.5) * (PI * walk_number).cos();
    let hop = ((t - 1.3) / 0.55).clamp(0.0, 1.0);
    let place = Vec3::new(x, 1.3 * hop * (1.0 - hop), 0.0);
    let turn = Quat::from_rotation_y(FRAC_PI_2 + PI * (walk_number + ease((t - 3.2) / 0.8)));
    let stride = (PI * t / 3.2).sin().max(0.0) * (TAU * 1.25 * t).sin();
    for (joint, mut transform) in &mut joints {
        let (at, rotation) = match *joint {
            Joint::Whole => (place, turn),
            Joint::Swings(at, by) => (at, Quat::from_scaled_axis(stride * by)),
        };
        *transform = Transform::from_translation(at).with_rotation(rotation);
    }
}
