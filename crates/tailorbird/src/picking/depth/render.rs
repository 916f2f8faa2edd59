//! The pass that reads texels of the depth prepass, and the buffers that bring them back.

use std::{
    num::NonZeroU64,
    sync::{Arc, Mutex, PoisonError},
};

use bevy_app::App;
use bevy_asset::{AssetServer, embedded_asset, load_embedded_asset};
use bevy_camera::MainPassResolutionOverride;
use bevy_core_pipeline::{
    core_3d::DEPTH_PREPASS_TEXTURE_SUPPORTED,
    prepass::ViewPrepassTextures,
    schedule::{Core3d, Core3dSystems},
};
use bevy_ecs::prelude::*;
use bevy_math::UVec2;
use bevy_render::{
    ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems,
    camera::TemporalJitter,
    render_resource::{
        BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer,
        BufferDescriptor, BufferUsages, CachedComputePipelineId, ComputePassDescriptor,
        ComputePipelineDescriptor, DownlevelFlags, MapMode, PipelineCache, ShaderStages,
        binding_types::{storage_buffer_sized, texture_depth_2d, texture_depth_2d_multisampled},
    },
    renderer::{RenderAdapter, RenderContext, RenderDevice, RenderQueue, ViewQuery},
    sync_world::MainEntity,
    view::ExtractedView,
};
use tracing::warn;

use super::{
    mailbox::{Answer, Mailbox, Question},
    view::View,
};

/// Texels read for one camera in one frame: one for each pointer over it. Known to the shader.
const PROBES: usize = 16;
/// Bytes of one probe: texel (two words), median and mean depth of its samples.
const PROBE_BYTES: usize = 16;
/// Texels under way at most: cameras × frames until the answer, two or three. What is over is asked again next frame.
const SLOTS: usize = 32;

/// Adds what runs in the render world. `false` where there is none.
pub(super) fn build(app: &mut App, mailbox: Mailbox) -> bool {
    if app.get_sub_app(RenderApp).is_none() {
        return false;
    }
    embedded_asset!(app, "read_depth.wesl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return false;
    };
    render_app
        .insert_resource(mailbox)
        .init_resource::<Questions>()
        .add_systems(RenderStartup, init_depth_reader)
        .add_systems(ExtractSchedule, take_questions)
        .add_systems(
            Core3d,
            read_depth
                .after(Core3dSystems::Prepass)
                .before(Core3dSystems::MainPass)
                .run_if(any_questions),
        )
        .add_systems(Render, map_buffers.in_set(RenderSystems::Cleanup));
    true
}

/// Questions of this frame. Empty unless the depth backend is in use.
#[derive(Resource, Default)]
struct Questions(Vec<Question>);

fn any_questions(questions: Res<Questions>) -> bool {
    !questions.0.is_empty()
}

/// Resources of the pass. They belong to one device, and are made anew for a new one.
#[derive(Resource)]
struct DepthReader {
    single: DepthPipeline,
    multisampled: DepthPipeline,
    pool: Arc<Mutex<Pool>>,
    /// Passes that are recorded, but whose buffer is not asked for yet.
    recorded: Vec<Batch>,
}

struct DepthPipeline {
    layout: BindGroupLayoutDescriptor,
    id: CachedComputePipelineId,
}

/// The buffers of one pass.
struct Slot {
    /// Written by the CPU (texels) and the pass (depths).
    probes: Buffer,
    /// A copy that can be mapped.
    staging: Buffer,
}

/// Slots that are not under way.
#[derive(Default)]
struct Pool {
    free: Vec<Slot>,
    /// Slots that exist, free or not.
    made: usize,
}

/// Questions to one camera in one frame.
struct Batch {
    slot: Slot,
    view: View,
    probes: Vec<(Question, UVec2)>,
}

/// Makes the pipelines. Where the device cannot run them there are none, and the depth backend finds nothing.
fn init_depth_reader(
    mut commands: Commands,
    adapter: Res<RenderAdapter>,
    device: Res<RenderDevice>,
    assets: Res<AssetServer>,
    cache: Res<PipelineCache>,
) {
    commands.remove_resource::<DepthReader>();
    let compute = adapter
        .get_downlevel_capabilities()
        .flags
        .contains(DownlevelFlags::COMPUTE_SHADERS)
        && device.limits().max_storage_buffers_per_shader_stage > 0;
    if !compute || !DEPTH_PREPASS_TEXTURE_SUPPORTED {
        return;
    }
    let shader = load_embedded_asset!(&*assets, "read_depth.wesl");
    let size = NonZeroU64::new((PROBES * PROBE_BYTES) as u64);
    let pipeline = |name: &'static str, multisampled: bool| {
        let texture = if multisampled {
            texture_depth_2d_multisampled()
        } else {
            texture_depth_2d()
        };
        let layout = BindGroupLayoutDescriptor::new(
            name,
            &BindGroupLayoutEntries::sequential(
                ShaderStages::COMPUTE,
                (texture, storage_buffer_sized(false, size)),
            ),
        );
        let id = cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some(name.into()),
            layout: vec![layout.clone()],
            shader: shader.clone(),
            shader_defs: multisampled
                .then(|| "MULTISAMPLED".into())
                .into_iter()
                .collect(),
            entry_point: Some("read_depth".into()),
            ..Default::default()
        });
        DepthPipeline { layout, id }
    };
    commands.insert_resource(DepthReader {
        single: pipeline("cloth_picking_depth", false),
        multisampled: pipeline("cloth_picking_depth_multisampled", true),
        pool: Arc::default(),
        recorded: Vec::new(),
    });
}

/// Takes what the main world asks.
fn take_questions(mailbox: Res<Mailbox>, mut questions: ResMut<Questions>) {
    questions.0 = mailbox.take_questions();
}

/// Records the pass of one camera.
fn read_depth(
    view: ViewQuery<(
        &MainEntity,
        &ExtractedView,
        &ViewPrepassTextures,
        Option<&TemporalJitter>,
        Option<&MainPassResolutionOverride>,
    )>,
    questions: Res<Questions>,
    reader: Option<ResMut<DepthReader>>,
    cache: Res<PipelineCache>,
    queue: Res<RenderQueue>,
    mut context: RenderContext,
    mut reported: Local<bool>,
) {
    let Some(mut reader) = reader else {
        if !std::mem::replace(&mut *reported, true) {
            warn!(
                "ClothPickingBackend::Depth finds nothing: this device has no compute shaders, or cannot read depth \
                 textures. Use ClothPickingBackend::Ray."
            );
        }
        return;
    };
    let (camera, extracted, textures, jitter, resolution) = view.into_inner();
    let Some(depth) = &textures.depth else {
        return;
    };
    let mut view = View {
        view_from_clip: extracted.clip_from_view,
        world_from_view: extracted.world_from_view,
        origin: extracted.viewport.truncate().truncate(),
        size: resolution.map_or(
            UVec2::new(extracted.viewport.z, extracted.viewport.w),
            |resolution| **resolution,
        ),
    };
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut view.view_from_clip, view.size.as_vec2());
    }
    view.view_from_clip = view.view_from_clip.inverse();

    let probes: Vec<_> = questions
        .0
        .iter()
        .filter(|question| question.ray.camera == camera.id())
        .filter_map(|question| Some((*question, view.texel(question.ndc)?)))
        .take(PROBES)
        .collect();
    let pipeline = if depth.texture.texture.sample_count() > 1 {
        &reader.multisampled
    } else {
        &reader.single
    };
    let (false, Some(compute)) = (probes.is_empty(), cache.get_compute_pipeline(pipeline.id))
    else {
        return;
    };
    let device = context.render_device().clone();
    let Some(slot) = reader
        .pool
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take(&device)
    else {
        return;
    };

    let mut bytes = [0; PROBES * PROBE_BYTES];
    for (bytes, (_, texel)) in bytes.chunks_exact_mut(PROBE_BYTES).zip(&probes) {
        let texel = view.origin + texel;
        bytes[..4].copy_from_slice(&texel.x.to_ne_bytes());
        bytes[4..8].copy_from_slice(&texel.y.to_ne_bytes());
    }
    queue.write_buffer(&slot.probes, 0, &bytes);
    let bind_group = device.create_bind_group(
        "cloth_picking_depth",
        &cache.get_bind_group_layout(&pipeline.layout),
        &BindGroupEntries::sequential((
            &depth.texture.default_view,
            slot.probes.as_entire_binding(),
        )),
    );
    let encoder = context.command_encoder();
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some("cloth_picking_depth"),
            timestamp_writes: None,
        });
        pass.set_pipeline(compute);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&slot.probes, 0, &slot.staging, 0, bytes.len() as u64);
    reader.recorded.push(Batch { slot, view, probes });
}

/// Asks for the buffers of the passes that were submitted. They come when the GPU is done, some frames later: nothing
/// waits for them.
fn map_buffers(reader: Option<ResMut<DepthReader>>, mailbox: Res<Mailbox>) {
    let Some(mut reader) = reader else {
        return;
    };
    let pool = reader.pool.clone();
    for batch in reader.recorded.drain(..) {
        let (mailbox, pool) = (mailbox.clone(), pool.clone());
        let staging = batch.slot.staging.clone();
        staging.slice(..).map_async(MapMode::Read, move |result| {
            let mut pool = pool.lock().unwrap_or_else(PoisonError::into_inner);
            if result.is_err() {
                // The device is lost: so is the slot.
                pool.made = pool.made.saturating_sub(1);
                return;
            }
            mailbox.answer(batch.answers());
            batch.slot.staging.unmap();
            pool.free.push(batch.slot);
        });
    }
}

impl Batch {
    /// Reads the mapped buffer.
    fn answers(&self) -> Vec<Answer> {
        let Ok(bytes) = self.slot.staging.slice(..).get_mapped_range() else {
            return Vec::new();
        };
        bytes
            .chunks_exact(PROBE_BYTES)
            .zip(&self.probes)
            .map(|(bytes, &(question, texel))| {
                let word = |i: usize| f32::from_ne_bytes([0, 1, 2, 3].map(|k| bytes[4 * i + k]));
                Answer {
                    question,
                    point: self.view.visible(texel, word(2), word(3)),
                }
            })
            .collect()
    }
}

impl Pool {
    /// A free slot, or a new one, or none where too many are under way.
    fn take(&mut self, device: &RenderDevice) -> Option<Slot> {
        if let Some(slot) = self.free.pop() {
            return Some(slot);
        }
        if self.made == SLOTS {
            return None;
        }
        self.made += 1;
        let buffer = |label, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size: (PROBES * PROBE_BYTES) as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Slot {
            probes: buffer(
                "cloth_picking_depth_probes",
                BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            ),
            staging: buffer(
                "cloth_picking_depth_staging",
                BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            ),
        })
    }
}
