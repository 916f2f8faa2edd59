//! The same bits whether a game has systems between the stages or not, with all shapes and bodies.

use bevy_math::{Isometry3d, Mat3, UVec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::{
    scene::{Scene, Sheet},
    shapes,
};

fn bits(own_stages: bool, instruction_set: InstructionSet) -> Vec<[u32; 3]> {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::splat(40),
        substeps: Some(8),
        instruction_set,
        ..Scene::default()
    });
    if own_stages {
        sheet.app.add_systems(ClothSubstep, || {});
    }
    let world = sheet.app.world_mut();
    for (k, case) in shapes::all().into_iter().enumerate() {
        let at = Vec3::new(
            0.35 * (k % 4) as f32 - 0.6,
            0.35 * (k / 4) as f32 - 0.6,
            -0.7,
        );
        let small = Transform::from_translation(at).with_scale(Vec3::splat(0.5));
        world.spawn((case.collider, small));
    }
    let entity = world.spawn_empty().id();
    let mut reactions = Vec::new();
    for _ in 0..40 {
        let at = Isometry3d::from_translation(Vec3::new(0.5, -0.5, -0.2));
        sheet
            .app
            .world_mut()
            .resource_mut::<ExternalColliders>()
            .push(ExternalCollider {
                entity,
                part: 0,
                shape: ColliderShape::Capsule {
                    radius: 0.1,
                    half_length: 0.2,
                },
                friction: 0.5,
                margin: 0.0,
                layers: ClothLayers::ALL,
                start: at,
                end: at,
                body: Some(ColliderBody {
                    body: entity,
                    inv_mass: Vec3::splat(10.0),
                    inv_inertia: Mat3::IDENTITY * 1000.0,
                    center_of_mass: at.translation.into(),
                    linear_velocity: Vec3::ZERO,
                    angular_velocity: Vec3::ZERO,
                }),
            });
        sheet.steps(1);
        let of = sheet.app.world().resource::<ClothReactions>();
        reactions.extend(
            of.get(entity)
                .map(|r| r.impulse.to_array().map(f32::to_bits)),
        );
    }
    assert!(!reactions.is_empty(), "the body was met");
    let particles = sheet
        .app
        .world()
        .get::<ClothParticles>(sheet.entity)
        .expect("particles");
    let places = particles
        .positions()
        .map(|p| p.to_array().map(f32::to_bits));
    places.chain(reactions).collect()
}

#[test]
fn both_runners_and_all_instruction_sets_give_the_same_bits() {
    let whole = bits(false, InstructionSet::Auto);
    assert!(whole == bits(true, InstructionSet::Auto), "stage by stage");
    assert!(
        whole == bits(false, InstructionSet::Scalar),
        "without vectors"
    );
}
