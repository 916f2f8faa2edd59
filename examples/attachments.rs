//! A flag in a hand: an attachment holds its edge at a bone of a skinned mesh. The skeleton is made in code; a bone of a character
//! from a glTF file is found by its name as well.
//!
//! Space: let go, and take hold again. Drag the flag with the left mouse button.

use bevy::{
    camera::visibility::DynamicSkinnedMeshBounds,
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use tailorbird::prelude::*;

/// From the shoulder to the elbow, and from there to the hand [m].
const BONE: f32 = 0.5;
/// Of the flag [m].
const SIZE: Vec2 = Vec2::new(1.0, 0.66);
const RESOLUTION: UVec2 = UVec2::new(49, 33);

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugins::default(), ClothDragPlugin))
        .insert_resource(ClearColor(Color::srgb(0.62, 0.72, 0.82)))
        .insert_resource(ClothWind::steady(Vec3::new(1.5, 0.0, 0.5)))
        .add_systems(Startup, setup)
        // Once a frame, as Bevy animates bones.
        .add_systems(Update, (wave, hold_or_let_go))
        .run();
}

/// An attachment is an entity of its own: it comes when a bone of this name does, and is gone when it is despawned.
fn hold_or_let_go(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    bones: Query<(Entity, Ref<Name>)>,
    flag: Single<Entity, With<Cloth>>,
    attachments: Query<Entity, With<ClothAttachment>>,
) {
    for (bone, name) in bones.iter().filter(|(_, name)| name.as_str() == "hand") {
        if !name.is_added() && !keys.just_pressed(KeyCode::Space) {
            continue;
        }
        attachments
            .iter()
            .for_each(|held| commands.entity(held).despawn());
        if attachments.is_empty() {
            // Along the stick, which is the bone's y axis.
            let row = SIZE.y / (RESOLUTION.y - 1) as f32;
            let points = (0..RESOLUTION.y).map(|k| Vec3::Y * (0.8 - row * k as f32));
            let edge = ClothAttachment::edge(ClothEdge::Left).with_points(points);
            commands.spawn((edge.to(bone), ClothAttachmentOf(*flag)));
        }
    }
}

/// Amplitude of a bone's swing, and its delay [rad].
#[derive(Component)]
#[require(Visibility)]
struct Bone(f32, f32);

fn wave(time: Res<Time>, mut bones: Query<(&Bone, &mut Transform)>) {
    for (Bone(swing, late), mut transform) in &mut bones {
        transform.rotation =
            Quat::from_rotation_z(swing * (2.4 * time.elapsed_secs() - late).sin());
    }
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut skeletons: ResMut<Assets<SkinnedMeshInverseBindposes>>,
) -> Result {
    commands.spawn((
        Cloth::grid(SIZE, RESOLUTION),
        ClothMaterial::silk(),
        ClothLook::new(ClothFabric::SILK).with_dye(Color::srgb(0.85, 0.62, 0.10)),
        Transform::from_xyz(0.0, 2.9, 0.0),
    ));

    let grey = MeshMaterial3d(materials.add(Color::srgb(0.36, 0.38, 0.40)));
    let bone = |name, swing, late, height| {
        let place = Transform::from_xyz(0.0, height, 0.0);
        (Bone(swing, late), Name::new(name), place)
    };
    let shoulder = commands.spawn(bone("shoulder", 0.35, 0.0, 1.2)).id();
    let elbow = bone("elbow", 0.5, 0.7, BONE);
    let elbow = commands.spawn((elbow, ChildOf(shoulder))).id();
    let stick = Mesh3d(meshes.add(Cylinder::new(0.012, 0.95)));
    let stick = (stick, grey.clone(), Transform::from_xyz(0.0, 0.35, 0.0));
    let hand = (bone("hand", 0.4, 1.4, BONE), children![stick]);
    commands.spawn((hand, ChildOf(elbow)));
    let at_rest = [0.0, BONE].map(|y| Mat4::from_translation(-y * Vec3::Y));
    commands.spawn((
        Mesh3d(meshes.add(arm()?)),
        grey,
        SkinnedMesh {
            inverse_bindposes: skeletons.add(at_rest.to_vec()),
            joints: vec![shoulder, elbow],
        },
        DynamicSkinnedMeshBounds,
    ));
    commands.spawn((
        ClothCollider::half_space(),
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
        Transform::from_xyz(0.4, 1.7, 4.3).looking_at(Vec3::new(0.1, 1.5, 0.0), Vec3::Y),
    ));
    Ok(())
}

/// A capsule along y whose vertices follow the upper bone, the lower one, or near the elbow both.
fn arm() -> Result<Mesh> {
    let capsule = Capsule3d::new(0.055, 2.0 * BONE).mesh().rings(24).build();
    let mut arm = capsule.translated_by(BONE * Vec3::Y);
    let Some(VertexAttributeValues::Float32x3(places)) = arm.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return Err("a capsule without places".into());
    };
    let fore = places
        .iter()
        .map(|place| ((place[1] - BONE) / 0.2 + 0.5).clamp(0.0, 1.0));
    let weights: Vec<_> = fore.map(|fore| [1.0 - fore, fore, 0.0, 0.0]).collect();
    let joints = VertexAttributeValues::Uint16x4(vec![[0, 1, 0, 0]; weights.len()]);
    arm.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    arm.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    Ok(arm.with_generated_skinned_mesh_bounds()?)
}
