//! A second cloth beside the first: the same in all but its solver, so that anyone sees the difference.

use bevy::prelude::*;
use tailorbird::prelude::*;

use super::{
    camera::OrbitCamera,
    moving::Moving,
    scenes::{SceneAssets, SceneCloth, SceneEntity, SceneKind, spawn_scene},
    settings::DemoSettings,
};

/// On what belongs to the second cloth: it, what holds it, and what it falls on.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Beside;

/// On the entities of the first cloth, while the second is spawned.
#[derive(Component, Clone, Copy, Debug, Default)]
struct First;

/// From the first to the second [m].
pub fn shift(scene: SceneKind) -> Vec3 {
    /// Between the two [m].
    const GAP: f32 = 0.4;
    let width = match scene {
        // They move about.
        SceneKind::Cape => 4.4,
        SceneKind::Banner => 4.2,
        _ => scene.size().x,
    };
    Vec3::X * (width + GAP)
}

/// View of both cloths.
pub fn view(scene: SceneKind) -> OrbitCamera {
    let alone = scene.view();
    let offset = shift(scene);
    OrbitCamera {
        focus: alone.focus + 0.5 * offset,
        distance: (alone.distance + 0.9 * offset.x).min(15.0),
        // Seen from the side, one would hide the other.
        yaw: 0.4 * alone.yaw,
        ..alone
    }
}

/// Spawns the scene once more, aside, and gives its cloth the other solver. The first was spawned just before.
pub fn spawn_beside(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    commands.queue(|world: &mut World| {
        for entity in of_scene(world) {
            world.entity_mut(entity).insert(First);
        }
    });
    spawn_scene(commands, settings, assets);
    let (offset, solver) = (shift(settings.scene), settings.other_solver());
    commands.queue(move |world: &mut World| {
        for entity in of_scene(world) {
            let mut entity = world.entity_mut(entity);
            if entity.take::<First>().is_some() {
                continue;
            }
            entity.insert(Beside);
            if entity.contains::<SceneCloth>() {
                entity.insert(solver);
            }
            if entity.contains::<ChildOf>() {
                continue;
            }
            if let Some(mut moving) = entity.get_mut::<Moving>() {
                moving.offset = offset;
            }
            if let Some(mut transform) = entity.get_mut::<Transform>() {
                transform.translation += offset;
            }
        }
    });
}

fn of_scene(world: &mut World) -> Vec<Entity> {
    let mut all = world.query_filtered::<Entity, Or<(With<SceneEntity>, With<SceneCloth>)>>();
    all.iter(world).collect()
}

/// Figures of one cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothFigures {
    /// Its solver.
    pub solver: ClothSolver,
    /// Its particles.
    pub particles: usize,
    /// Stretch of its edges [-].
    pub stretch: ClothStretch,
}

/// Figures of the cloths of the scene, the first one first.
pub fn figures(
    cloths: &Query<(&ClothSolver, &ClothParticles, &ClothTopology, Has<Beside>), With<SceneCloth>>,
) -> Vec<ClothFigures> {
    let mut all: Vec<(bool, ClothFigures)> = cloths
        .iter()
        .map(|(solver, particles, topology, beside)| {
            let figures = ClothFigures {
                solver: *solver,
                particles: particles.len(),
                stretch: particles.stretch(topology),
            };
            (beside, figures)
        })
        .collect();
    all.sort_by_key(|(beside, _)| *beside);
    all.into_iter().map(|(_, figures)| figures).collect()
}
