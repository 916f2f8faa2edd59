//! Entities through reflection, as Bevy writes worlds and scenes.

use bevy_app::App;
use bevy_ecs::{
    entity::EntityHashMap,
    prelude::*,
    reflect::{AppTypeRegistry, ReflectComponent},
    relationship::RelationshipHookMode,
};
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_reflect::{
    ReflectSerialize,
    serde::{ReflectDeserializer, ReflectSerializer},
};
use bevy_transform::components::Transform;
use serde::de::DeserializeSeed;
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

fn sim() -> Sim {
    let mut sim = Sim::new();
    sim.app.register_type::<Transform>();
    sim
}

/// Entities, and their components in RON.
type File = Vec<(Entity, Vec<String>)>;

/// Writes those components that can be saved: with serde, or all that can be reflected.
fn save(app: &App, entities: &[Entity], all: bool) -> File {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let of = |entity: Entity| {
        let components = registry.iter().filter_map(|registration| {
            if !all {
                registration.data::<ReflectSerialize>()?;
            }
            let component = registration.data::<ReflectComponent>()?;
            component.reflect(app.world().entity(entity))
        });
        components
            .map(|value| {
                let value = ReflectSerializer::new(value.as_partial_reflect(), &registry);
                ron::to_string(&value).unwrap()
            })
            .collect()
    };
    entities.iter().map(|e| (*e, of(*e))).collect()
}

/// Reads entities into another world: there they are others.
fn load(app: &mut App, file: &File) -> Vec<Entity> {
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let mut others = EntityHashMap::default();
    for (entity, _) in file {
        others.insert(*entity, app.world_mut().spawn_empty().id());
    }
    for (entity, components) in file {
        for text in components {
            let mut ron = ron::Deserializer::from_str(text).unwrap();
            let value = ReflectDeserializer::new(&registry)
                .deserialize(&mut ron)
                .unwrap_or_else(|error| panic!("{error}: {text}"));
            let id = value.get_represented_type_info().unwrap().type_id();
            let component = registry.get_type_data::<ReflectComponent>(id).unwrap();
            component.apply_or_insert_mapped(
                &mut app.world_mut().entity_mut(others[entity]),
                &*value,
                &registry,
                &mut others.clone(),
                RelationshipHookMode::Run,
            );
        }
    }
    file.iter().map(|(entity, _)| others[entity]).collect()
}

#[test]
fn what_a_game_sets_comes_back() {
    a_world_comes_back(false);
}

/// A game that does not choose saves what the simulation makes as well, which is then made anew.
#[test]
fn all_that_is_reflected_comes_back() {
    a_world_comes_back(true);
}

fn a_world_comes_back(all: bool) {
    let mut before = sim();

    let pole = before.spawn(Transform::from_xyz(0.0, 2.0, 0.0));
    let flag = before.spawn((
        Cloth::grid(Vec2::new(1.5, 1.0), UVec2::new(12, 8)),
        ClothMaterial::silk(),
        ClothPins::corners([ClothCorner::BottomLeft]),
        ClothSolver::GaussSeidel,
        ClothShading::Flat,
        ClothInertia::none(),
        ClothSleep::never(),
        ClothLayers::new(1, 2),
        ClothMotionConstraints::at_most(0.5),
        ClothMotionTargets::in_space(ClothTargetSpace::World),
        Transform::from_xyz(0.0, 2.0, 0.0),
    ));
    let attachment = ClothAttachment::edge(ClothEdge::Left).with_break_force(500.0);
    let hold = before.spawn((attachment.to(pole), ClothAttachmentOf(flag)));
    let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let rock = before.spawn((
        ClothCollider::convex_hull(&points).unwrap(),
        Transform::from_xyz(5.0, 0.0, 0.0),
    ));
    let fan = before.spawn(ClothWindZone::sphere(2.0, Vec3::X));
    before.steps(4);

    let file = save(&before.app, &[pole, flag, hold, rock, fan], all);
    let mut after = sim();
    // So that entities are others than before.
    after.app.world_mut().spawn_batch([(), (), ()]);
    let others = load(&mut after.app, &file);
    let [pole_after, flag_after, hold_after, rock_after, fan_after] = others[..] else {
        panic!("{others:?}");
    };

    macro_rules! same {
        ($(($before:ident, $after:ident): $($type:ty),+;)+) => {
            $($(
                assert_eq!(
                    after.get::<$type>($after),
                    before.get::<$type>($before),
                );
            )+)+
        };
    }
    same! {
        (pole, pole_after): Transform;
        (flag, flag_after): Cloth, ClothMaterial, ClothPins, ClothSolver, ClothShading, ClothInertia, ClothSleep;
        (flag, flag_after): ClothLayers, ClothMotionConstraints, ClothMotionTargets, Transform;
        (hold, hold_after): ClothAttachment;
        (rock, rock_after): ClothCollider, Transform;
        (fan, fan_after): ClothWindZone, Transform;
    }
    let world = after.app.world();
    assert_eq!(world.get(hold_after), Some(&ClothAttachmentOf(flag_after)));
    assert_eq!(world.get(hold_after), Some(&ClothAttachedTo(pole_after)));

    // What comes with a cloth is not in the file, and there all the same: the cloth hangs on its pole.
    after.steps(8);
    let particles = after.get::<ClothParticles>(flag_after);
    assert_eq!(particles.len(), 12 * 8);
    let status = after.get::<ClothStatus>(flag_after);
    assert_eq!(status, &ClothStatus::default());
    assert!(
        after
            .app
            .world()
            .get::<ClothAttachments>(flag_after)
            .is_some()
    );
}

/// Reflection has the errors of serde, and with them those of the constructors.
#[test]
fn a_wrong_shape_is_an_error_of_reflection_too() {
    let Sim { app, .. } = sim();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let text = r#"{"tailorbird_cloth::collider::ClothCollider": (shape: Sphere(radius: NaN))}"#;
    let mut ron = ron::Deserializer::from_str(text).unwrap();
    let error = ReflectDeserializer::new(&registry)
        .deserialize(&mut ron)
        .unwrap_err()
        .to_string();
    assert!(error.contains("ClothCollider radius is NaN"), "{error}");
}

/// All parts of what can be saved are known to the registry as well.
#[test]
fn resources_are_known_to_reflection() {
    let Sim { app, .. } = sim();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let settings = ClothSettings {
        iterations: 3,
        ..ClothSettings::default()
    };
    let wind = ClothWind::steady(Vec3::X);
    for value in [
        Box::new(settings) as Box<dyn bevy_reflect::Reflect>,
        Box::new(wind),
    ] {
        let value = value.as_partial_reflect();
        let text = ron::to_string(&ReflectSerializer::new(value, &registry)).unwrap();
        let mut ron = ron::Deserializer::from_str(&text).unwrap();
        let back = ReflectDeserializer::new(&registry)
            .deserialize(&mut ron)
            .unwrap();
        assert_eq!(value.reflect_partial_eq(&*back), Some(true), "{text}");
    }
}
