//! Writes the meshes of cloths, once per frame.

use std::collections::HashSet;

use bevy_asset::{AssetEvent, AssetId, Assets, RenderAssetUsages};
use bevy_camera::{primitives::Aabb, visibility::ViewVisibility};
use bevy_ecs::{prelude::*, system::NonSendMarker};
use bevy_math::Affine3A;
use bevy_mesh::Mesh;
use bevy_time::{Fixed, Time};
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::{
    attachment::ClothAttachedParticles,
    bounds::ClothBounds,
    frame::ClothFrame,
    normals::ClothNormals,
    particles::ClothParticles,
    sleep::{ClothSeen, ClothSleepState},
    step::ClothStep,
    topology::ClothTopology,
};
use tracing::warn;

use super::{
    ClothMesh, ClothMeshPart, ClothMeshSettings, ClothMeshWrite, ClothUnseen,
    drawn::Drawn,
    follow::{PIECE, share},
    packed::Packed,
    slab::{VertexUpload, VertexUploads},
};
use crate::drawn::ClothDrawnHolds;

/// Returns whether meshes are written as assets: then they are before their changes are told.
pub(super) fn writes_assets(
    settings: Res<ClothMeshSettings>,
    uploads: Option<Res<VertexUploads>>,
) -> bool {
    settings.write == ClothMeshWrite::Asset || uploads.is_none()
}

/// Sets the boxes around meshes.
pub(super) fn bound_cloth_meshes(
    mut commands: Commands,
    cloths: Query<(
        &ClothMesh,
        &ClothParticles,
        &ClothNormals,
        &ClothTopology,
        &ClothFrame,
        &ClothBounds,
    )>,
    mut aabbs: Query<&mut Aabb>,
) {
    for (cloth_mesh, particles, normals, topology, frame, bounds) in &cloths {
        if cloth_mesh.is_stale(topology, normals) || particles.is_empty() {
            continue;
        }
        let (a, b) = (bounds.min / frame.scale(), bounds.max / frame.scale());
        let around = Aabb::from_min_max(a.min(b), a.max(b));
        for part in &cloth_mesh.parts {
            let from_cloth = part.follow.from_cloth;
            let new = from_cloth.map_or(around, |from_cloth| moved(around, from_cloth));
            if let Ok(mut aabb) = aabbs.get_mut(part.entity) {
                aabb.set_if_neq(new);
            } else if let Ok(mut shown) = commands.get_entity(part.entity) {
                shown.insert(new);
            }
        }
    }
}

/// Notes which cloths somebody sees, where the renderer draws what is seen alone.
pub(super) fn note_seen(
    settings: Res<ClothMeshSettings>,
    uploads: Option<Res<VertexUploads>>,
    mut cloths: Query<(&ClothMesh, &mut ClothSeen)>,
    visible: Query<&ViewVisibility>,
) {
    if uploads.is_none() || settings.unseen == ClothUnseen::Write {
        return;
    }
    for (cloth_mesh, mut seen) in &mut cloths {
        let is_seen = |part: &ClothMeshPart| {
            !part.in_asset || visible.get(part.entity).is_ok_and(|v| v.get())
        };
        let parts = &cloth_mesh.parts;
        let any = parts.is_empty() || parts.iter().any(is_seen);
        seen.set_if_neq(ClothSeen(any));
    }
}

/// Computes positions, normals and tangents between the last two steps.
///
/// The particles live in the entity's rigid frame, its mesh in its own space: they differ by the scale alone. A mesh of an entity
/// below lies where that was when the cloth was made. A mesh that would stay as it is, while the simulation is paused or the cloth
/// sleeps, is left alone, and one that nobody sees as the settings say.
///
/// Runs on the main thread, which takes a part of the work: it would only wait for the threads of the pool, of which there is one on a
/// machine of two cores.
pub(super) fn follow_cloth(
    _: NonSendMarker,
    settings: Res<ClothMeshSettings>,
    uploads: Option<Res<VertexUploads>>,
    fixed: Option<Res<Time<Fixed>>>,
    step: Option<Res<ClothStep>>,
    mut cloths: Query<(
        &mut ClothMesh,
        &ClothSleepState,
        &ClothParticles,
        &ClothNormals,
        &ClothTopology,
        &ClothFrame,
        (
            &ClothAttachedParticles,
            &GlobalTransform,
            &mut ClothDrawnHolds,
        ),
    )>,
    places: Query<&GlobalTransform>,
    seen: Query<&ViewVisibility>,
    meshes: Res<Assets<Mesh>>,
) {
    let Some(step) = step else {
        return;
    };
    let fraction = match fixed {
        Some(fixed) if settings.interpolate && step.running() => {
            fixed.overstep_fraction().clamp(0.0, 1.0)
        }
        _ => 1.0,
    };
    let method = if uploads.is_some() {
        settings.write
    } else {
        ClothMeshWrite::Asset
    };
    let skips = method == ClothMeshWrite::Slab && settings.unseen == ClothUnseen::Skip;
    let mut jobs = Vec::new();
    let mut all: Vec<_> = cloths.iter_mut().collect();
    for (cloth_mesh, rest, particles, normals, topology, frame, held) in &mut all {
        // One that sleeps stays where it fell asleep, unless it is carried along.
        let (steps, fraction) = match rest.asleep_since() {
            _ if rest.is_unseen() => (step.steps(), 1.0),
            Some(step) => (step, 1.0),
            None => (step.steps(), fraction),
        };
        let scale = frame.scale();
        let now = Some(([steps, step.restores()], fraction, scale));
        let cloth_mesh = cloth_mesh.bypass_change_detection();
        if cloth_mesh.is_stale(topology, normals) || particles.is_empty() {
            continue;
        }
        let is_seen = |part: &ClothMeshPart| !skips || seen.get(part.entity).is_ok_and(|v| v.get());
        let (attached, place, holds) = held;
        let holds = holds.bypass_change_detection();
        let writes = cloth_mesh
            .parts
            .iter()
            .any(|part| !part.in_asset || is_seen(part));
        if !rest.is_asleep() || rest.is_unseen() && writes {
            let now = |target| places.get(target).ok().copied();
            holds.update(topology, particles, attached, place, fraction, now);
        }
        let moves = !(holds.is_still() || rest.is_asleep());
        let drawn = Drawn {
            particles,
            normals,
            holds,
            fraction,
            scale,
        };
        for part in &mut cloth_mesh.parts {
            if part.in_asset && !is_seen(part) {
                if let Some(packed) = &mut part.packed {
                    packed.forget_positions();
                }
                continue;
            }
            // Others may have changed an asset that was written in each frame.
            let elsewhere = part.went.replace(method) != Some(method);
            part.outdated |= elsewhere && part.in_asset;
            let mesh = meshes.get(&part.handle);
            let changed = mesh.is_some_and(|mesh| part.check(mesh)) || elsewhere;
            let Some(packed) = &part.packed else {
                continue;
            };
            if moves || changed || part.shows != now || packed.moved() {
                part.shows = now;
                jobs.push((drawn, part));
            }
        }
    }
    // Large meshes are shared out one by one, small ones several to a task.
    let (mut small, large): (Vec<_>, Vec<_>) = jobs
        .into_iter()
        .partition(|(_, part)| part.follow.len() <= PIECE);
    for (drawn, part) in large {
        part.write(drawn);
    }
    let vertices: usize = small.iter().map(|(_, part)| part.follow.len()).sum();
    let tasks = (vertices / PIECE).clamp(1, 64);
    let group = small.len().div_ceil(tasks).max(1);
    share(small.chunks_mut(group), &|_, group| {
        for (drawn, part) in group {
            part.write(*drawn);
        }
    });
}

/// A box around a box in another space.
fn moved(aabb: Aabb, by: Affine3A) -> Aabb {
    Aabb {
        center: by.transform_point3a(aabb.center),
        half_extents: by.matrix3.abs() * aabb.half_extents,
    }
}

impl ClothMesh {
    /// Returns whether it is to be built anew.
    fn is_stale(&self, topology: &ClothTopology, normals: &ClothNormals) -> bool {
        self.revision != topology.revision || normals.shading() != self.shading
    }
}

impl ClothMeshPart {
    /// Sees to it that its vertices have the attributes of the mesh; whether they had to be made.
    fn check(&mut self, mesh: &Mesh) -> bool {
        let version = match &self.packed {
            Some(packed) if packed.is_of(mesh) && !self.outdated => return false,
            Some(packed) => packed.version + 1,
            None => 0,
        };
        self.outdated = false;
        self.packed = Packed::of(mesh, version);
        self.packed.is_some()
    }

    fn write(&mut self, drawn: Drawn) {
        if let Some(packed) = &mut self.packed
            && packed.words.len() == self.follow.len() * packed.stride
        {
            self.follow.write(drawn, packed);
            packed.keep_positions();
            self.fresh = true;
        }
    }
}

/// Gives the vertices that were computed to the renderer, or to the mesh asset: those of a new mesh, or where there is no other
/// way.
pub(super) fn write_cloth_mesh(
    settings: Res<ClothMeshSettings>,
    mut cloths: Query<&mut ClothMesh>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut uploads: Option<ResMut<VertexUploads>>,
    mut warned: Local<bool>,
) {
    for mut cloth_mesh in &mut cloths {
        // What is written changes nothing that others look at.
        let cloth_mesh = cloth_mesh.bypass_change_detection();
        for part in &mut cloth_mesh.parts {
            let id = part.handle.id();
            let Some(packed) = part.packed.as_mut().filter(|_| part.fresh) else {
                continue;
            };
            part.fresh = false;
            let mesh = meshes.get(&part.handle);
            let drawn =
                mesh.is_some_and(|mesh| mesh.asset_usage.contains(RenderAssetUsages::RENDER_WORLD));
            let wanted = settings.write == ClothMeshWrite::Slab && drawn;
            let possible =
                |uploads: &VertexUploads| packed.complete && !uploads.refused.contains(&id);
            let possible = uploads.as_deref().map(possible);
            if wanted && possible == Some(false) && !*warned {
                warn!(
                    "the mesh of {} cannot be written where the renderer keeps it: it is written as an asset, which is slower",
                    part.entity
                );
                *warned = true;
            }
            let direct = wanted && part.in_asset && possible == Some(true);
            if let (true, Some(uploads)) = (direct, &mut uploads) {
                let (stride, version) = (packed.stride, packed.version);
                let spent = uploads.spent.remove(&id);
                let next = spent.filter(|spent| {
                    spent.version == version && spent.words.len() == packed.words.len()
                });
                let next = next.map_or_else(|| packed.words.clone(), |spent| spent.words);
                let words = std::mem::replace(&mut packed.words, next);
                let vertices = VertexUpload {
                    words,
                    stride,
                    version,
                };
                uploads.fresh.insert(id, vertices);
                continue;
            }
            let is_new = !std::mem::replace(&mut part.in_asset, true);
            if let Some(mut mesh) = meshes.get_mut(&part.handle) {
                packed.write_to(&mut mesh);
                part.own_change = true;
            }
            if let Some(uploads) = &mut uploads {
                uploads.forget(id);
                if is_new {
                    uploads.refused.remove(&id);
                }
            }
        }
    }
}

/// Notes which meshes others have changed: their other attributes are to be read again.
pub(super) fn watch_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut cloths: Query<&mut ClothMesh>,
) {
    let changed: HashSet<AssetId<Mesh>> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        })
        .collect();
    if changed.is_empty() {
        return;
    }
    for mut cloth_mesh in &mut cloths {
        for part in &mut cloth_mesh.bypass_change_detection().parts {
            if changed.contains(&part.handle.id()) && !std::mem::take(&mut part.own_change) {
                part.outdated = true;
            }
        }
    }
}
