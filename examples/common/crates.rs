//! Crates and a ball, bodies of avian, that fall on a sheet.

use avian3d::prelude::*;
use bevy::prelude::*;
use tailorbird_avian::ClothAvianPlugin;

use super::{
    scenes::{SceneAssets, SceneEntity},
    settings::DemoSettings,
};

/// Bodies, and cloth that carries them.
pub struct CratesPlugin;

impl Plugin for CratesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((PhysicsPlugins::default(), ClothAvianPlugin::default()))
            .add_systems(
                Update,
                fall_as_cloth_does.run_if(resource_changed::<DemoSettings>),
            );
    }
}

fn fall_as_cloth_does(
    settings: Res<DemoSettings>,
    mut gravity: ResMut<Gravity>,
    mut time: ResMut<Time<Physics>>,
) {
    gravity.0 = Vec3::new(0.0, -settings.gravity, 0.0);
    if settings.paused {
        time.pause();
    } else {
        time.unpause();
    }
}

/// Spawns them above the sheet, one after the other, and the ground for those that fall off.
pub fn spawn(commands: &mut Commands, assets: &mut SceneAssets) {
    commands.spawn((
        SceneEntity,
        RigidBody::Static,
        Collider::half_space(Vec3::Y),
        Transform::default(),
        // The stage has a ground for cloth already.
        tailorbird_avian::ClothCollisionDisabled,
    ));
    let wood = assets.painted(Color::srgb(0.55, 0.38, 0.22), 0.8, 0.0);
    let paint = assets.painted(Color::srgb(0.70, 0.20, 0.12), 0.5, 0.0);
    let crates = [
        (0.36, 4.0, Vec3::new(0.1, 2.3, 0.05)),
        (0.28, 2.0, Vec3::new(-0.25, 3.6, 0.1)),
        (0.32, 3.0, Vec3::new(0.15, 5.2, -0.2)),
        (0.22, 1.0, Vec3::new(-0.1, 7.4, 0.2)),
    ];
    for (k, (side, mass, place)) in crates.into_iter().enumerate() {
        let turned = Quat::from_scaled_axis(Vec3::new(0.4, 0.9, 0.2) * (k + 1) as f32);
        commands.spawn((
            SceneEntity,
            RigidBody::Dynamic,
            Collider::cuboid(side, side, side),
            Mass(mass),
            assets.mesh(Cuboid::from_length(side)),
            wood.clone(),
            Transform::from_translation(place).with_rotation(turned),
        ));
    }
    let radius = 0.16;
    commands.spawn((
        SceneEntity,
        RigidBody::Dynamic,
        Collider::sphere(radius),
        Mass(2.0),
        assets.sphere(radius),
        paint,
        Transform::from_xyz(0.3, 9.5, 0.1),
    ));
}
