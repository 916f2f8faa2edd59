//! Makes cloths of meshes, and makes them anew.

use std::collections::HashMap;

use bevy_camera::{primitives::Aabb, visibility::NoAutoAabb};
use bevy_ecs::prelude::*;
use bevy_math::{Vec2, Vec3};
use bevy_mesh::{Mesh, Mesh3d, MeshVertexAttribute, skinning::SkinnedMesh};
use tailorbird_cloth::{
    cloth::{Cloth, ClothShape},
    error::{ClothErrorKind, ClothErrorSource, ClothStatus},
    pins::{ClothPin, ClothPins, ClothSelection},
    topology::repair::Repaired,
    weights::ClothWeights,
};
use tracing::warn;

use super::{
    ClothFromMesh, ClothMeshOf, ClothMeshPins, ClothMeshThreads,
    changes::Changes,
    parts::{Finder, Found, MeshSource, append},
    plain::texture_coordinates,
};

/// The meshes that a cloth was made of.
#[derive(Component, Clone, Debug)]
pub(super) struct ClothMeshSource {
    pub parts: Vec<MeshSource>,
    weld_distance: f32,
    threads: ClothMeshThreads,
    /// Number of cloths that had been made when this one was: it tells this one from those of the same shape.
    pub made: u64,
    /// Their attributes that are not drawn.
    pub left_out: Option<MeshVertexAttribute>,
    /// The pin that they name.
    pin: Option<ClothPin>,
}

/// The skin that a mesh had before it became cloth.
#[derive(Component, Clone, Debug)]
pub(super) struct SkinSetAside(SkinnedMesh);

/// Makes cloths of meshes that are there, and makes them anew when those are others.
pub(super) fn cloth_from_mesh(
    mut entities: Query<(
        Entity,
        Ref<ClothFromMesh>,
        Option<&ClothPins>,
        Option<&ClothMeshSource>,
        Has<Cloth>,
        &mut ClothStatus,
    )>,
    mut changes: Changes,
    mut pending: Local<HashMap<Entity, Waiting>>,
    mut count: Local<u64>,
    finder: Finder,
    parts: Query<(Option<&ClothMeshOf>, Option<&SkinSetAside>, Option<&Mesh3d>)>,
    skins: Query<&SkinnedMesh>,
    mut commands: Commands,
    parallel_commands: ParallelCommands,
) {
    let happened = changes.read();
    for maker in happened.makers {
        pending.entry(maker).or_default().failed = false;
    }
    for (entity, from_mesh, pins, source, is_cloth, mut status) in &mut entities {
        let other_assets = source.is_some_and(|source| {
            let mut parts = source.parts.iter();
            parts.any(|part| happened.assets.contains(&part.mesh.id()))
        });
        let waited = pending.remove(&entity);
        let before = waited.unwrap_or_default();
        let changed = from_mesh.is_changed() || other_assets;
        let other_assets = other_assets || before.other_assets;
        let asked = !is_cloth || changed || other_assets || before.asked;
        // A cloth that was not made here stays what it is.
        if is_cloth && source.is_none() || !asked && waited.is_none() {
            continue;
        }
        let mut waits = Waiting {
            asked,
            other_assets,
            failed: false,
        };
        if before.failed && !changed && happened.assets.is_empty() {
            pending.insert(entity, before);
            continue;
        }
        let mut errors = Vec::new();
        match make(entity, &from_mesh, &finder, &mut errors) {
            // What is still being loaded is waited for; meanwhile the cloth stays what it was.
            Ok(None) => {
                pending.insert(entity, waits);
            }
            Ok(Some(mut made))
                if asked || source.is_none_or(|old| !old.is_part_of(&made.source)) =>
            {
                *count += 1;
                made.source.made = *count;
                let mut pins = pins.cloned().unwrap_or_default();
                if let Some(old) = source {
                    pins.pins.retain(|pin| Some(pin) != old.pin.as_ref());
                    if other_assets || !old.has_same_particles(&made.source) {
                        pins.pins.retain(ClothPin::is_by_place);
                    }
                    give_back(old, &made.source, &parts, &mut commands);
                }
                pins.pins.extend(made.source.pin.clone());
                set_skins_aside(entity, &made.source, &finder, &skins, &mut commands);
                let mut entity = commands.entity(entity);
                entity.insert((made.cloth, made.source, pins));
                match made.weights {
                    Some(weights) => entity.insert(weights),
                    None => entity.remove::<ClothWeights>(),
                };
            }
            Ok(Some(_)) => {}
            Err(error) => {
                // What is wrong may be mended in an asset that this cloth was not made of.
                if is_cloth {
                    waits.failed = true;
                    pending.insert(entity, waits);
                }
                errors.push(error);
            }
        }
        ClothStatus::update(
            &mut status,
            entity,
            &parallel_commands,
            ClothErrorSource::Mesh,
            errors,
        );
    }
    pending.retain(|entity, _| entities.contains(*entity));
}

/// Why a cloth that waits for its meshes is made.
#[derive(Clone, Copy, Default)]
pub(super) struct Waiting {
    /// True if it is made whatever is found.
    asked: bool,
    /// True if meshes that it was made of have changed.
    other_assets: bool,
    /// True if the meshes were wrong: they are checked again when a mesh asset, or the cloth's list of meshes, changes.
    failed: bool,
}

impl ClothMeshSource {
    /// Returns whether all of its meshes are still there. Others that come to lie beside them are no reason to make the cloth anew.
    fn is_part_of(&self, other: &Self) -> bool {
        let mut all = self.parts.iter();
        all.all(|part| other.parts.iter().any(|other| part.is_same(other)))
    }

    /// Returns whether a cloth of these meshes has the same particles as one of those.
    fn has_same_particles(&self, other: &Self) -> bool {
        let mut pairs = self.parts.iter().zip(&other.parts);
        self.weld_distance == other.weld_distance
            && self.threads == other.threads
            && self.parts.len() == other.parts.len()
            && pairs.all(|(a, b)| a.is_same(b))
    }
}

/// Takes the skins off the meshes that become cloth, and tells what of them does not move it.
fn set_skins_aside(
    cloth: Entity,
    source: &ClothMeshSource,
    finder: &Finder,
    skins: &Query<&SkinnedMesh>,
    commands: &mut Commands,
) {
    for part in &source.parts {
        let morphs = finder
            .mesh(part)
            .is_some_and(|mesh| matches!(mesh.try_has_morph_targets(), Ok(true)));
        let skin = skins.get(part.entity).ok();
        if let Some(skin) = skin {
            commands
                .entity(part.entity)
                .insert(SkinSetAside(skin.clone()))
                .remove::<SkinnedMesh>();
        }
        let ignored = match (skin, morphs) {
            (Some(skin), true) => format!(
                "its skin ({} joints) and its morph targets",
                skin.joints.len()
            ),
            (Some(skin), false) => format!("its skin ({} joints)", skin.joints.len()),
            (None, true) => "its morph targets".to_owned(),
            (None, false) => continue,
        };
        warn!(
            "{cloth}: the mesh of {} becomes cloth, so {ignored} no longer move it; hold it with ClothAttachment, or give it \
             ClothMotionTargets",
            part.entity
        );
    }
}

/// Parts of a cloth from meshes.
struct Made {
    cloth: Cloth,
    source: ClothMeshSource,
    weights: Option<ClothWeights>,
}

/// Makes the cloth; nothing while assets are loading. Pins that are wrong are left out and reported in `errors`.
fn make(
    entity: Entity,
    from_mesh: &ClothFromMesh,
    finder: &Finder,
    errors: &mut Vec<ClothErrorKind>,
) -> Result<Option<Made>, ClothErrorKind> {
    let Found::Meshes(parts) = finder.find(entity, &from_mesh.parts)? else {
        return Ok(None);
    };
    let (mut positions, mut indices, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let mut meshes = Vec::with_capacity(parts.len());
    for part in &parts {
        let Some(mesh) = finder.mesh(part) else {
            return Ok(None);
        };
        let first = positions.len();
        append(mesh, part.to_cloth, &mut positions, &mut indices)?;
        if from_mesh.threads == ClothMeshThreads::Uvs
            && let Some(own) = texture_coordinates(mesh)
        {
            // Parts before that have none get coordinates without an area, which tell nothing.
            uvs.resize(first, Vec2::ZERO);
            uvs.extend(own);
            uvs.resize(positions.len(), Vec2::ZERO);
        }
        meshes.push(mesh);
    }
    if !uvs.is_empty() {
        uvs.resize(positions.len(), Vec2::ZERO);
    }
    let held = match held(from_mesh, &meshes, &positions, &indices) {
        Ok(held) => held,
        Err(error) => {
            errors.push(error);
            None
        }
    };
    let pin = held.as_ref().map(|(_, pin)| pin.clone());
    let painted = from_mesh.pins.are_painted();
    let weights = held.filter(|_| painted).map(|(weights, _)| weights);
    let shape = ClothShape::Mesh {
        positions,
        indices,
        uvs,
        weld_distance: from_mesh.weld_distance,
    };
    Ok(Some(Made {
        cloth: Cloth { shape },
        source: ClothMeshSource {
            parts,
            weld_distance: from_mesh.weld_distance,
            threads: from_mesh.threads,
            made: 0,
            left_out: from_mesh.pins.paint().filter(|_| !from_mesh.draw_paint),
            pin,
        },
        weights,
    }))
}

/// The weights of the particles, and the pin of those above the threshold.
fn held(
    from_mesh: &ClothFromMesh,
    meshes: &[&Mesh],
    positions: &[Vec3],
    indices: &[u32],
) -> Result<Option<(ClothWeights, ClothPin)>, ClothErrorKind> {
    if matches!(from_mesh.pins, ClothMeshPins::None) {
        return Ok(None);
    }
    let threshold = from_mesh.pins.threshold()?;
    let weights = from_mesh.pins.weights(meshes, positions)?;
    let repaired = Repaired::new(positions, indices, from_mesh.weld_distance, Vec3::ONE);
    let weights = ClothWeights {
        weights: repaired.weights(&weights),
    };
    let particles = weights.above(threshold).collect();
    let pin = ClothPin::new(ClothSelection::Particles(particles));
    Ok(Some((weights, pin)))
}

/// Gives meshes that are no part of the cloth any more what they were, but for what others have given them since.
fn give_back(
    old: &ClothMeshSource,
    new: &ClothMeshSource,
    parts: &Query<(Option<&ClothMeshOf>, Option<&SkinSetAside>, Option<&Mesh3d>)>,
    commands: &mut Commands,
) {
    for part in &old.parts {
        let stays = new.parts.iter().any(|other| other.entity == part.entity);
        let Ok((of, skin, shown)) = parts.get(part.entity) else {
            continue;
        };
        if stays {
            continue;
        }
        let mut entity = commands.entity(part.entity);
        if matches!((of, shown), (Some(of), Some(shown)) if of.built == shown.0) {
            entity.insert(Mesh3d(part.mesh.clone()));
        }
        entity.remove::<(ClothMeshOf, SkinSetAside, NoAutoAabb, Aabb)>();
        if let Some(SkinSetAside(skin)) = skin {
            entity.insert(skin.clone());
        }
    }
}
