//! A solid of a game's own: a torus, which this crate does not have. A tablecloth falls on it, sags into its hole and goes round with it.
//! Drag the cloth with the mouse.

use bevy::prelude::*;
use tailorbird::{cloth::collider::find_contacts, prelude::*};

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, turn)
        .add_systems(
            ClothSubstep,
            (
                // Before the constraints: they then move what touches along the surface.
                approach
                    .in_set(ClothSubstepSystems::Approach)
                    .after(find_contacts),
                // After them, with friction.
                collide.in_set(ClothSubstepSystems::Collide),
            ),
        )
        .run();
}

/// A torus about the y axis.
#[derive(Component, Clone, Copy)]
struct ClothTorus {
    ring: f32,
    tube: f32,
    /// About the y axis [rad/s].
    spin: f32,
}

impl ClothTorus {
    /// Contact of a point of the world with the torus in its place, in a substep of this length \[s\].
    fn contact(self, place: &Transform, seconds: f32, point: Vec3) -> Option<SubstepContact> {
        let p = point - place.translation;
        let ring = self.ring * p.with_y(0.0).try_normalize()?;
        let away = p - ring;
        let contact = SubstepContact::new(away.try_normalize()?, self.tube - away.length());
        let moved = self.spin * seconds * Vec3::Y.cross(p);
        Some(contact.with_friction(0.8).moving(moved))
    }
}

fn approach(mut cloths: SubstepCloths, tori: Query<(&ClothTorus, &Transform)>) {
    for mut cloth in cloths.iter_mut() {
        for (torus, place) in &tori {
            let seconds = cloth.seconds();
            cloth.approach(|p| torus.contact(place, seconds, p));
        }
    }
}

fn collide(mut cloths: SubstepCloths, tori: Query<(&ClothTorus, &Transform)>) {
    for mut cloth in cloths.iter_mut() {
        for (torus, place) in &tori {
            let seconds = cloth.seconds();
            cloth.collide(|p| torus.contact(place, seconds, p));
        }
    }
}

fn turn(time: Res<Time>, mut tori: Query<(&ClothTorus, &mut Transform)>) {
    for (torus, mut place) in &mut tori {
        place.rotate_y(torus.spin * time.delta_secs());
    }
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Cloth::grid(Vec2::splat(1.7), UVec2::splat(56)).centered(),
        ClothMaterial::cotton(),
        // A torus is no collider of the crate: nothing would wake the cloth when it turns.
        ClothSleep::never(),
        ClothLook::new(ClothFabric::COTTON).with_dye(Color::srgb(0.15, 0.35, 0.65)),
        Transform::from_xyz(0.0, 1.2, 0.0)
            .with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)),
    ));
    let torus = ClothTorus {
        ring: 0.55,
        tube: 0.2,
        spin: 0.4,
    };
    // Drawn a little thinner: cloth has edges between its particles.
    let drawn = Torus::new(
        torus.ring - torus.tube + 0.01,
        torus.ring + torus.tube - 0.01,
    );
    commands.spawn((
        torus,
        Mesh3d(meshes.add(drawn)),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.8, 0.7))),
        Transform::from_xyz(0.0, 0.7, 0.0),
    ));
    commands.spawn((
        ClothCollider::half_space(),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.35, 0.33, 0.3))),
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
        Transform::from_xyz(1.4, 2.4, 2.6).looking_at(Vec3::Y * 0.6, Vec3::Y),
    ));
}
