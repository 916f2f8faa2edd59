//! The depth backend: what the camera sees under the pointer, and the particle nearest to it.
//!
//! Each frame the main world asks for every pointer over a camera with a `DepthPrepass` ([`mailbox`]). The render world
//! reads that texel of the prepass, and sends it back when the GPU is done, two or three frames later, with the world
//! point that it shows ([`render`], [`view`]). The nearest triangle of a cloth to that point is the hit ([`locate`]); it
//! is sent each frame, wherever the triangle has moved, until the next answer comes or the pointer leaves the camera.
//!
//! Objects outside the depth prepass are not seen: transparent materials, and cloth behind anything that is in it.

mod locate;
mod mailbox;
mod render;
mod view;

use std::collections::HashMap;

use bevy_app::{App, Plugin, PreUpdate};
use bevy_camera::{Camera, Camera3d, visibility::RenderLayers};
use bevy_core_pipeline::prepass::DepthPrepass;
use bevy_ecs::prelude::*;
use bevy_picking::{
    PickingSystems,
    backend::{
        PointerHits,
        ray::{RayId, RayMap},
    },
};
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::prelude::*;
use tracing::warn;

use self::{
    locate::{Cloths, Located},
    mailbox::{Mailbox, Question},
};
use super::{ClothPickingBackend, ClothPickingSettings};

/// Adds the depth backend. Does nothing where there is no renderer.
pub(super) struct ClothDepthPickingPlugin;

impl Plugin for ClothDepthPickingPlugin {
    fn build(&self, app: &mut App) {
        let mailbox = Mailbox::default();
        if render::build(app, mailbox.clone()) {
            app.insert_resource(mailbox).add_systems(
                PreUpdate,
                update_hits
                    .in_set(PickingSystems::Backend)
                    .run_if(resource_exists::<RayMap>.and_then(resource_exists::<ClothStep>)),
            );
        }
    }
}

/// An answer that is this many frames old no longer counts: the camera does not answer any more.
const FRAMES_KEPT: u64 = 30;

/// The latest answers.
#[derive(Default)]
struct Latest {
    /// The frame that is asked in.
    frame: u64,
    /// Answers to questions from before this frame do not count.
    first: u64,
    /// When the question was asked, and the cloth that was found.
    answers: HashMap<RayId, (u64, Option<Located>)>,
    /// True if a camera without a prepass was reported.
    reported: bool,
}

/// Takes what was answered, sends a hit for each pointer that is on a cloth, and asks for this frame.
fn update_hits(
    mut latest: Local<Latest>,
    settings: Res<ClothPickingSettings>,
    mailbox: Res<Mailbox>,
    rays: Res<RayMap>,
    step: Res<ClothStep>,
    cameras: Query<(
        &Camera,
        &GlobalTransform,
        Option<&RenderLayers>,
        Has<Camera3d>,
        Has<DepthPrepass>,
    )>,
    cloths: Query<Cloths, With<Cloth>>,
    mut hits: MessageWriter<PointerHits>,
) {
    let latest = &mut *latest;
    latest.frame += 1;
    if settings.backend != ClothPickingBackend::Depth {
        latest.first = latest.frame;
        latest.answers.clear();
        return;
    }

    for answer in mailbox.take_answers() {
        let Question {
            ray,
            frame,
            elapsed,
            ..
        } = answer.question;
        let newer = latest
            .answers
            .get(&ray)
            .is_none_or(|&(asked, _)| asked < frame);
        if frame < latest.first || !newer {
            continue;
        }
        let layers = cameras.get(ray.camera).ok().and_then(|camera| camera.2);
        // How long cloth may have moved since it was drawn, which was up to a step behind the particles.
        let seconds = (step.elapsed() - elapsed).max(0.0) as f32 + step.seconds();
        let located = answer
            .point
            .and_then(|point| locate::nearest(point, seconds, layers, &cloths));
        latest.answers.insert(ray, (frame, located));
    }
    latest.answers.retain(|ray, (asked, _)| {
        rays.map.contains_key(ray) && latest.frame - *asked <= FRAMES_KEPT
    });

    let mut questions = Vec::new();
    for (&id, &ray) in rays.iter() {
        let Ok((camera, transform, _, is_3d, prepass)) = cameras.get(id.camera) else {
            continue;
        };
        if !prepass {
            if is_3d && !std::mem::replace(&mut latest.reported, true) {
                warn!(
                    "ClothPickingBackend::Depth finds nothing through camera {}: add a DepthPrepass to it.",
                    id.camera
                );
            }
            continue;
        }
        if let Some((_, Some(located))) = latest.answers.get(&id)
            && let Some(pick) = located.pick(id.camera, ray, &cloths)
        {
            hits.write(PointerHits::new(
                id.pointer,
                vec![pick],
                camera.order as f32,
            ));
        }
        // Through the ray instead of the pointer's place on the target, so that rays that a game adds work as well.
        if let Some(ndc) = camera.world_to_ndc(transform, ray.get_point(1.0)) {
            questions.push(Question {
                ray: id,
                ndc: ndc.truncate(),
                frame: latest.frame,
                elapsed: step.elapsed(),
            });
        }
    }
    mailbox.ask(questions);
}
