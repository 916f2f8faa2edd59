//! Writes vertices to where the renderer keeps them, past the mesh asset.
//!
//! A change of the asset costs a copy of the mesh, its memory on the GPU anew, all attributes interleaved again, and the indices.
//! The vertices that follow a cloth go there as they are, in one piece. What is there belongs to the asset: when the renderer moves
//! it or takes it from the asset again, it is written again.

use std::collections::{HashMap, HashSet};

use bevy_app::App;
use bevy_asset::AssetId;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;
use bevy_render::{
    ExtractSchedule, MainWorld, Render, RenderApp, RenderSystems,
    mesh::{
        RenderMesh,
        allocator::{MeshAllocator, allocate_and_free_meshes},
    },
    render_asset::{AssetExtractionSystems, ExtractedAssets, RenderAssets},
    render_resource::{BufferId, BufferUsages},
    renderer::RenderQueue,
};

use super::ClothMesh;

/// Number of frames in a row in which vertices may not fit their mesh before it is given up.
const PATIENCE: u32 = 3;

/// The vertices of a mesh.
pub(super) struct VertexUpload {
    pub words: Vec<f32>,
    /// Numbers of a vertex.
    pub stride: usize,
    pub version: u32,
}

/// Vertices that go to the renderer, and its answers. It exists if there is a renderer.
#[derive(Resource, Default)]
pub(super) struct VertexUploads {
    /// Vertices that changed.
    pub fresh: HashMap<AssetId<Mesh>, VertexUpload>,
    /// Meshes that are written as assets.
    pub forgotten: Vec<AssetId<Mesh>>,
    /// Vertices that are not needed any more, to be written anew.
    pub spent: HashMap<AssetId<Mesh>, VertexUpload>,
    /// Meshes that cannot be written in this way.
    pub refused: HashSet<AssetId<Mesh>>,
}

/// The vertices as they are to be drawn.
#[derive(Resource, Default)]
struct ShownVertices {
    all: HashMap<AssetId<Mesh>, Shown>,
    refused: Vec<AssetId<Mesh>>,
}

struct Shown {
    vertices: VertexUpload,
    /// Place where they were written: the buffer, and the first vertex.
    place: Option<(BufferId, u32)>,
    /// True if these vertices were compared with the mesh.
    judged: bool,
    /// Number of frames in a row that did not fit.
    mismatches: u32,
}

/// Adds what writes vertices, where there is a renderer.
pub(super) fn finish(app: &mut App) {
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    super::sorting::finish(render_app);
    render_app
        .init_resource::<ShownVertices>()
        .add_systems(
            ExtractSchedule,
            extract_vertices.after(AssetExtractionSystems),
        )
        .add_systems(
            Render,
            write_vertices
                .in_set(RenderSystems::PrepareResources)
                // What goes through the queue is no conflict that the schedule could see.
                .after(allocate_and_free_meshes)
                .before(RenderSystems::Render)
                .run_if(resource_exists::<MeshAllocator>),
        );
    app.init_resource::<VertexUploads>();
}

/// Forgets the vertices of a cloth that goes: its meshes belong to others, if to anyone.
pub(super) fn forget_vertices(
    gone: On<Remove<ClothMesh>>,
    cloths: Query<&ClothMesh>,
    uploads: Option<ResMut<VertexUploads>>,
) {
    if let (Ok(cloth), Some(mut uploads)) = (cloths.get(gone.entity), uploads) {
        for part in &cloth.parts {
            uploads.forget(part.handle.id());
            uploads.refused.remove(&part.handle.id());
        }
    }
}

impl VertexUploads {
    /// Leaves a mesh to its asset.
    pub fn forget(&mut self, id: AssetId<Mesh>) {
        self.fresh.remove(&id);
        self.forgotten.push(id);
    }
}

fn extract_vertices(
    mut main: ResMut<MainWorld>,
    mut shown: ResMut<ShownVertices>,
    extracted: Res<ExtractedAssets<RenderMesh>>,
) {
    for id in &extracted.removed {
        if !extracted.added.contains(id) {
            shown.all.remove(id);
        }
    }
    // What is taken from the asset again is to be written again, though it may lie where it lay.
    for (id, _) in &extracted.extracted {
        if let Some(shown) = shown.all.get_mut(id) {
            shown.place = None;
        }
    }
    let Some(mut uploads) = main.get_resource_mut::<VertexUploads>() else {
        return;
    };
    let uploads = &mut *uploads;
    uploads.refused.extend(shown.refused.drain(..));
    for id in uploads.forgotten.drain(..) {
        shown.all.remove(&id);
    }
    // What nobody took in the last frame is not taken in this one.
    uploads.spent.clear();
    for (id, vertices) in uploads.fresh.drain() {
        match shown.all.get_mut(&id) {
            Some(shown) => {
                let before = std::mem::replace(&mut shown.vertices, vertices);
                uploads.spent.insert(id, before);
                (shown.place, shown.judged) = (None, false);
            }
            None => {
                let new = Shown {
                    vertices,
                    place: None,
                    judged: false,
                    mismatches: 0,
                };
                shown.all.insert(id, new);
            }
        }
    }
}

fn write_vertices(
    mut shown: ResMut<ShownVertices>,
    allocator: Res<MeshAllocator>,
    meshes: Res<RenderAssets<RenderMesh>>,
    queue: Res<RenderQueue>,
) {
    let ShownVertices { all, refused } = &mut *shown;
    for (id, shown) in all {
        let (Some(slice), Some(mesh)) = (allocator.mesh_vertex_slice(id), meshes.get(*id)) else {
            continue;
        };
        let place = Some((slice.buffer.id(), slice.range.start));
        if shown.place == place {
            continue;
        }
        let VertexUpload { words, stride, .. } = &shown.vertices;
        let size = mesh.layout.0.layout().array_stride;
        let right = size == 4 * *stride as u64
            && words.len() == *stride * mesh.vertex_count as usize
            && slice.buffer.usage().contains(BufferUsages::COPY_DST);
        if right {
            let offset = u64::from(slice.range.start) * size;
            queue.write_buffer(slice.buffer, offset, bytemuck::cast_slice(words));
            (shown.place, shown.mismatches) = (place, 0);
        } else if !std::mem::replace(&mut shown.judged, true) {
            shown.mismatches += 1;
            if shown.mismatches == PATIENCE {
                refused.push(*id);
            }
        }
    }
}
