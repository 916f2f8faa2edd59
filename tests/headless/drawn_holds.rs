//! Attached particles are drawn where their holder is drawn, in every frame, however frames and steps fall.

use std::time::Duration;

use bevy::{mesh::VertexAttributeValues, prelude::*, time::TimeUpdateStrategy};
use tailorbird::prelude::*;

use crate::game::*;

/// Swings, as a bone does that is animated in each frame.
#[derive(Component)]
struct Bone;

fn pose(t: f32) -> Transform {
    Transform::from_xyz(1.5 * (2.0 * t).sin(), 2.0, 0.5 * t)
        .with_rotation(Quat::from_rotation_y(2.5 * t))
}

fn swing(time: Res<Time<Virtual>>, mut bones: Query<&mut Transform, With<Bone>>) {
    for mut transform in &mut bones {
        *transform = pose(time.elapsed_secs());
    }
}

/// Drawn places of the vertices in the world.
fn drawn(app: &App, cloth: Entity) -> Vec<Vec3> {
    let handle = &get::<Mesh3d>(app, cloth).0;
    let meshes = app.world().resource::<Assets<Mesh>>();
    let mesh = meshes.get(handle).expect("the mesh");
    let place = get::<GlobalTransform>(app, cloth);
    match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(values)) => values
            .iter()
            .map(|v| place.transform_point(Vec3::from(*v)))
            .collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn they_are_where_their_bone_is() {
    const SIDE: usize = 9;
    for rate in [30.0, 60.0, 144.0] {
        let mut app = game();
        app.add_systems(Update, swing);
        let bone = app.world_mut().spawn((Bone, pose(0.0))).id();
        let cloth = app
            .world_mut()
            .spawn((
                Cloth::grid(Vec2::ONE, UVec2::splat(SIDE as u32)).with_origin(Vec2::new(0.5, 0.0)),
                related!(ClothAttachments[ClothAttachment::edge(ClothEdge::Top).to(bone)]),
                pose(0.0),
            ))
            .id();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / rate,
        )));
        for _ in 0..4 {
            app.update();
        }
        // Where they were attached, in the axes of the bone.
        let held: Vec<Vec3> = {
            let at = get::<GlobalTransform>(&app, bone).affine().inverse();
            let row = drawn(&app, cloth).into_iter().take(SIDE);
            row.map(|p| at.transform_point3(p)).collect()
        };
        for frame in 0..100 {
            app.update();
            let at = *get::<GlobalTransform>(&app, bone);
            let all = drawn(&app, cloth);
            for (k, point) in held.iter().enumerate() {
                let distance = all[k].distance(at.transform_point(*point));
                assert!(distance < 1e-4, "{rate} Hz, frame {frame}: {distance} m");
            }
            // What lies around them comes along: the bone is up to 15 cm further on than the cloth, which is spread over 60 cm.
            for k in 0..SIDE * (SIDE - 1) {
                let edge = all[k].distance(all[k + SIDE]) * (SIDE - 1) as f32;
                assert!(edge < 1.6, "{rate} Hz, frame {frame}: {edge}");
            }
        }
    }
}
