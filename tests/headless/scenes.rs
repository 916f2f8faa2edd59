//! Every component is registered for reflection; a cloth that was saved in a scene simulates after loading.

use std::any::TypeId;

use bevy::{
    asset::LoadFromPath,
    ecs::{entity::EntityHashMap, reflect::AppTypeRegistry},
    prelude::*,
    world_serialization::{DynamicWorld, DynamicWorldBuilder, serde::WorldDeserializer},
};
use serde::de::DeserializeSeed;
use tailorbird::prelude::*;

use crate::world::*;

#[test]
fn every_component_is_registered() {
    let mut sim = Sim::new();
    let cloth = sim.spawn(square(4));
    let sphere = sim.spawn(ClothCollider::sphere(1.0));
    sim.steps(1);
    let world = sim.app.world();
    let registry = world.resource::<AppTypeRegistry>().read();
    for entity in [cloth, sphere] {
        for (_, info) in world.inspect_entity(entity).unwrap() {
            let name = info.name().to_string();
            if !name.starts_with("tailorbird") {
                continue;
            }
            let registration = registry.get(info.type_id().unwrap());
            let registration = registration.unwrap_or_else(|| panic!("{name} is not registered"));
            assert!(
                registration.data::<ReflectComponent>().is_some(),
                "{name} lacks ReflectComponent"
            );
        }
    }
}

#[test]
fn every_resource_is_registered() {
    let sim = Sim::new();
    let registry = sim.app.world().resource::<AppTypeRegistry>().read();
    for id in [TypeId::of::<ClothSettings>(), TypeId::of::<ClothWind>()] {
        assert!(
            registry
                .get(id)
                .unwrap()
                .data::<ReflectResource>()
                .is_some()
        );
    }
}

/// A cloth refers to no asset.
struct NoAssets;

impl LoadFromPath for NoAssets {
    fn load_from_path_erased(
        &mut self,
        _type_id: TypeId,
        path: bevy::asset::AssetPath<'static>,
    ) -> UntypedHandle {
        panic!("no asset expected: {path}");
    }
}

/// Writes a cloth to text.
fn save(sim: &Sim, entity: Entity) -> String {
    let world = sim.app.world();
    let registry = world.resource::<AppTypeRegistry>().read();
    let scene: DynamicWorld = DynamicWorldBuilder::from_world(world, &registry)
        .allow_component::<Cloth>()
        .allow_component::<ClothMaterial>()
        .allow_component::<ClothPins>()
        .allow_component::<ClothShading>()
        .allow_component::<Transform>()
        .extract_entity(entity)
        .build();
    scene.serialize(&registry).unwrap()
}

fn load(sim: &mut Sim, text: &str) -> Entity {
    let registry = sim.app.world().resource::<AppTypeRegistry>().clone();
    let scene = {
        let registry = registry.read();
        let mut reader = ron::de::Deserializer::from_str(text).unwrap();
        WorldDeserializer {
            type_registry: &registry,
            load_from_path: &mut NoAssets,
        }
        .deserialize(&mut reader)
        .unwrap()
    };
    let mut entities = EntityHashMap::default();
    scene
        .write_to_world(sim.app.world_mut(), &mut entities)
        .unwrap();
    *entities.values().next().unwrap()
}

#[test]
fn a_cloth_simulates_after_loading_as_the_one_that_was_saved() {
    let (positions, indices) = (
        vec![Vec3::ZERO, Vec3::NEG_Y, Vec3::new(1.0, -1.0, 0.0), Vec3::X],
        vec![0, 1, 2, 0, 2, 3],
    );
    let pins = ClothPins::particles([1]).with(ClothPin::at(0, Vec3::new(0.1, 0.0, 0.0)));
    for (cloth, pins) in [
        (square(5), ClothPins::corners(ClothCorner::TOP)),
        (Cloth::mesh(positions, indices), pins),
    ] {
        let mut sim = Sim::new();
        let saved = sim.spawn((
            cloth,
            pins,
            ClothMaterial::denim(),
            Transform::from_xyz(0.0, 2.0, 0.0).with_rotation(lying()),
        ));
        let text = save(&sim, saved);
        let mut other = Sim::new();
        let loaded = load(&mut other, &text);
        assert_eq!(sim.get::<Cloth>(saved), other.get::<Cloth>(loaded));
        assert_eq!(sim.get::<ClothPins>(saved), other.get::<ClothPins>(loaded));
        sim.steps(30);
        other.steps(30);
        assert_eq!(sim.hash(saved), other.hash(loaded));
    }
}

#[test]
fn a_whole_entity_survives_a_round_trip() {
    // With everything that is reflected, the state too: what cannot be saved is built again.
    let mut sim = Sim::new();
    let saved = sim.spawn((square(5), ClothPins::corners(ClothCorner::TOP)));
    sim.steps(10);
    let registry = sim.app.world().resource::<AppTypeRegistry>().clone();
    let text = {
        let registry = registry.read();
        let scene = DynamicWorldBuilder::from_world(sim.app.world(), &registry)
            .extract_entity(saved)
            .build();
        scene.serialize(&registry).unwrap()
    };
    let mut other = Sim::new();
    let loaded = load(&mut other, &text);
    other.steps(60);
    assert_eq!(other.particles(loaded).len(), 25);
    assert!(other.errors(loaded).is_empty());
    assert!(other.all_finite(loaded));
    assert!(longest_edge(&other, loaded) < 1.1 && other.at(loaded, 24).y < 0.0);
}
