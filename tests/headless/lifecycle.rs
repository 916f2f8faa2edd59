//! Cloths come and go at any time.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

#[test]
fn an_app_without_cloth_runs() {
    let mut sim = Sim::new();
    sim.spawn(ClothCollider::sphere(1.0));
    sim.steps(10);
    assert_eq!(sim.app.world().resource::<ClothStep>().steps(), 10);
}

#[test]
fn despawning_in_the_middle_of_things_does_no_harm() {
    let mut sim = Sim::new();
    let sphere = sim.spawn(ClothCollider::sphere(0.3));
    let stays = sim.spawn((square(6), ClothPins::corners(ClothCorner::TOP)));
    let goes = sim.spawn((square(6), ClothPins::corners(ClothCorner::TOP)));
    sim.steps(5);
    sim.edit::<ClothGrab>(goes, |grab| grab.take(14, 0.2, Vec3::Z));
    sim.edit::<ClothForces>(goes, |forces| forces.add_force(3, Vec3::X));
    sim.steps(2);
    sim.edit::<ClothForces>(goes, |forces| forces.add_force(3, Vec3::NAN));
    sim.app.world_mut().despawn(goes);
    sim.steps(2);
    sim.app.world_mut().despawn(sphere);
    sim.steps(5);
    assert!(sim.all_finite(stays) && sim.errors(stays).is_empty());
    assert!(sim.app.world().get_entity(goes).is_err());
}

/// Despawns the cloth whose error it observes.
fn despawn_what_is_wrong(error: On<ClothError>, mut commands: Commands) {
    commands.entity(error.event().entity).despawn();
}

#[test]
fn an_observer_may_despawn_what_is_wrong() {
    let mut sim = Sim::new();
    sim.app.add_observer(despawn_what_is_wrong);
    let cloth = sim.spawn((
        Cloth::grid(Vec2::ZERO, UVec2::splat(4)),
        ClothMaterial::silk(),
    ));
    let other = sim.spawn(square(4));
    sim.steps(5);
    assert!(sim.app.world().get_entity(cloth).is_err());
    assert!(sim.all_finite(other));
}

#[test]
fn removing_the_cloth_leaves_an_entity_that_is_none() {
    let mut sim = Sim::new();
    let cloth = sim.spawn(square(4));
    sim.steps(5);
    sim.app.world_mut().entity_mut(cloth).remove::<Cloth>();
    let bits = sim.hash(cloth);
    sim.steps(5);
    assert_eq!(sim.hash(cloth), bits);
    sim.app.world_mut().entity_mut(cloth).insert(square(5));
    sim.steps(5);
    assert_eq!(sim.particles(cloth).len(), 25);
}

#[test]
fn cloths_of_one_world_do_not_feel_each_other() {
    let run = |others: usize| {
        let mut sim = Sim::new();
        let cloth = sim.spawn((square(6), ClothPins::corners([ClothCorner::TopLeft])));
        for _ in 0..others {
            sim.spawn((square(7), ClothMaterial::denim()));
        }
        sim.steps(30);
        sim.hash(cloth)
    };
    assert_eq!(run(0), run(3));
}
