//! Notices that what a cloth was made of is not what it was: other meshes, another scene, a changed asset.

use std::collections::HashSet;

use bevy_asset::{AssetEvent, AssetId};
use bevy_ecs::{prelude::*, system::SystemParam};
use bevy_mesh::{Mesh, Mesh3d};
use bevy_scene::{Ready, ScenePatchInstance};
use bevy_world_serialization::WorldAssetRoot;

use super::{ClothFromMesh, ClothMeshOf};

/// The scene of this entity, one of `bsn!`, is complete with all that lies below it.
#[derive(Component)]
pub(super) struct SceneComplete;

/// Notes that a scene is complete.
pub(super) fn note_ready(
    ready: On<Ready>,
    scenes: Query<(), With<ScenePatchInstance>>,
    mut commands: Commands,
) {
    if scenes.contains(ready.entity)
        && let Ok(mut entity) = commands.get_entity(ready.entity)
    {
        entity.insert(SceneComplete);
    }
}

/// Changes after which a cloth may have to be made anew.
#[derive(SystemParam)]
pub(super) struct Changes<'w, 's> {
    touched: Query<
        'w,
        's,
        (
            Entity,
            Option<&'static Mesh3d>,
            Option<&'static ClothMeshOf>,
            Has<WorldAssetRoot>,
        ),
        Or<(
            Changed<Mesh3d>,
            Changed<WorldAssetRoot>,
            Added<SceneComplete>,
        )>,
    >,
    makers: Query<'w, 's, (Option<&'static ChildOf>, Has<ClothFromMesh>)>,
    events: MessageReader<'w, 's, AssetEvent<Mesh>>,
}

/// Changes since the last call.
pub(super) struct Happened {
    /// Entities with a [`ClothFromMesh`] that have other meshes at or below them, perhaps.
    pub makers: HashSet<Entity>,
    /// Mesh assets that are not what they were.
    pub assets: HashSet<AssetId<Mesh>>,
}

impl Changes<'_, '_> {
    /// Reads the changes since the last call.
    pub fn read(&mut self) -> Happened {
        let changed = self.events.read().filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        });
        let assets = changed.collect();
        let mut makers = HashSet::new();
        for (entity, mesh, part, is_scene) in &self.touched {
            // The mesh that shows a cloth is no news.
            let ours = matches!((mesh, part), (Some(mesh), Some(part)) if part.built == mesh.0);
            if !ours || is_scene {
                makers.extend(self.maker(entity));
            }
        }
        Happened { makers, assets }
    }

    /// The entity that makes a cloth of what is at or below it.
    fn maker(&self, mut entity: Entity) -> Option<Entity> {
        loop {
            let (above, makes) = self.makers.get(entity).ok()?;
            if makes {
                return Some(entity);
            }
            entity = above?.parent();
        }
    }
}
