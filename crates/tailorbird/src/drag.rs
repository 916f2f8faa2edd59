//! Drags cloth with the pointer, and pins it with a key.
//!
//! Press on a cloth and the nearest particle and its neighbours are in the hand; moving the pointer moves them in the plane
//! parallel to the screen at that depth, the wheel moves them in depth, release lets go. A key (P) pins what is held; while
//! nothing is held it releases what was pinned so.

use bevy_app::{App, Plugin, PreUpdate};
use bevy_camera::Camera;
use bevy_ecs::prelude::*;
use bevy_input::{
    ButtonInput,
    keyboard::KeyCode,
    mouse::{MouseScrollPixelsPerLine, MouseScrollUnit, MouseWheel},
};
use bevy_math::Vec3;
use bevy_picking::{
    PickingSystems,
    backend::ray::{RayId, RayMap},
    events::PointerPress,
    pointer::{PointerAction, PointerButton, PointerId, PointerInput},
};
use bevy_reflect::prelude::*;
use bevy_shape::Ray3d;
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::prelude::*;

use crate::picking::ClothPointerHit;

/// Drags cloth with the pointer, and pins it with a key. Needs a picking backend; [`ClothDragSettings`] has the knobs.
pub struct ClothDragPlugin;

/// Settings of dragging. Change it at any time.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothDragSettings {
    /// The button that drags.
    pub button: PointerButton,
    /// Radius around the held particle within which the cloth is taken along \[m\]; its direct neighbours always are.
    pub radius: f32,
    /// Pins what is held; while nothing is held, releases the pins that were made so.
    pub pin_key: KeyCode,
    /// True if that releases the pins that the scene came with as well.
    pub release_scene_pins: bool,
    /// Distance by which a notch of the wheel moves the held particle away from the camera \[m\].
    pub wheel_step: f32,
}

impl Default for ClothDragSettings {
    fn default() -> Self {
        Self {
            button: PointerButton::Primary,
            radius: 0.08,
            pin_key: KeyCode::KeyP,
            release_scene_pins: false,
            wheel_step: 0.1,
        }
    }
}

/// On a cloth while it is dragged.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component)]
pub struct ClothDrag {
    /// Pointer that drags.
    pub pointer: PointerId,
    /// Through which camera.
    pub camera: Entity,
    /// Distance from the camera along its view direction \[m\].
    pub depth: f32,
    /// From the point under the pointer to the held particle, in the world \[m\].
    offset: Vec3,
}

/// A cloth was grabbed.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothGrabbed {
    /// The cloth.
    pub entity: Entity,
    /// The particle in the hand.
    pub particle: u32,
}

/// A cloth was let go.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothReleased {
    /// The cloth.
    pub entity: Entity,
}

/// Event: the held particles of a cloth were pinned.
#[derive(EntityEvent, Clone, Debug, PartialEq, Eq, Reflect)]
pub struct ClothPinned {
    /// The cloth.
    pub entity: Entity,
    /// The particles.
    pub particles: Vec<u32>,
}

/// Pins of a cloth were released.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
pub struct ClothUnpinned {
    /// The cloth.
    pub entity: Entity,
    /// Number of pins.
    pub count: usize,
}

impl Plugin for ClothDragPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ClothDragSettings>()
            .register_type::<ClothDrag>()
            .init_resource::<ClothDragSettings>()
            .add_observer(grab)
            .add_systems(
                PreUpdate,
                (
                    release.run_if(resource_exists::<Messages<PointerInput>>),
                    pin.run_if(resource_exists::<ButtonInput<KeyCode>>),
                    move_hand.run_if(resource_exists::<RayMap>),
                )
                    .chain()
                    .after(PickingSystems::Last),
            );
    }
}

/// Length of a ray up to `depth` \[m\] from the camera along its view direction.
fn at_depth(ray: &Ray3d, camera: &GlobalTransform, depth: f32) -> Option<Vec3> {
    let forward = *camera.forward();
    let along = ray.direction.dot(forward);
    let ahead = depth - (ray.origin - camera.translation()).dot(forward);
    (along > 1e-4).then(|| ray.origin + *ray.direction * (ahead / along))
}

fn grab(
    press: On<PointerPress>,
    settings: Res<ClothDragSettings>,
    mut cloths: Query<(&mut ClothGrab, &ClothParticles, &ClothFrame), Without<ClothDrag>>,
    cameras: Query<&GlobalTransform, With<Camera>>,
    mut commands: Commands,
) {
    if press.button != settings.button {
        return;
    }
    let entity = press.entity;
    let (Ok((mut grab, particles, frame)), Some(point)) =
        (cloths.get_mut(entity), press.hit.position)
    else {
        return;
    };
    let particle = match press.hit.extra_as::<ClothPointerHit>() {
        Some(hit) => Some(hit.particle),
        // Another backend found the cloth.
        None => particles
            .closest_particle(frame.to_frame(point))
            .map(|(i, _)| i),
    };
    let (Some(particle), Ok(camera)) = (
        particle.filter(|i| *i < particles.len()),
        cameras.get(press.hit.camera),
    ) else {
        return;
    };
    let held = particles.world_position(particle, frame);
    grab.take(particle as u32, settings.radius, held);
    commands.entity(entity).insert(ClothDrag {
        pointer: press.pointer.id,
        camera: press.hit.camera,
        depth: (point - camera.translation()).dot(*camera.forward()),
        offset: held - point,
    });
    commands.trigger(ClothGrabbed {
        entity,
        particle: particle as u32,
    });
}

/// Lets go when the button goes up, wherever the pointer is by then, or when the camera is gone.
fn release(
    settings: Res<ClothDragSettings>,
    mut inputs: MessageReader<PointerInput>,
    mut cloths: Query<(Entity, &mut ClothGrab, &ClothDrag)>,
    cameras: Query<(), With<Camera>>,
    mut commands: Commands,
) {
    let ended: Vec<PointerId> = inputs
        .read()
        .filter(|input| match input.action {
            PointerAction::Release(button) => button == settings.button,
            PointerAction::Cancel => true,
            _ => false,
        })
        .map(|input| input.pointer_id)
        .collect();
    for (entity, mut grab, drag) in &mut cloths {
        if ended.contains(&drag.pointer) || !cameras.contains(drag.camera) {
            grab.release();
            commands.entity(entity).remove::<ClothDrag>();
            commands.trigger(ClothReleased { entity });
        }
    }
}

fn pin(
    settings: Res<ClothDragSettings>,
    keys: Res<ButtonInput<KeyCode>>,
    mut cloths: Query<
        (
            Entity,
            &mut ClothPins,
            &ClothGrab,
            &ClothParticles,
            Has<ClothDrag>,
        ),
        With<Cloth>,
    >,
    mut commands: Commands,
) {
    if !keys.just_pressed(settings.pin_key) {
        return;
    }
    let dragging = cloths.iter().any(|(.., dragged)| dragged);
    for (entity, mut pins, grab, particles, dragged) in &mut cloths {
        if dragged {
            let held: Vec<u32> = grab
                .particles()
                .filter(|i| (*i as usize) < particles.len() && !particles.is_pinned(*i as usize))
                .collect();
            pins.pins.extend(held.iter().map(|&particle| ClothPin {
                author: ClothPinAuthor::User,
                ..ClothPin::at(particle, particles.position(particle as usize))
            }));
            commands.trigger(ClothPinned {
                entity,
                particles: held,
            });
        } else if !dragging {
            let count = if settings.release_scene_pins {
                std::mem::take(&mut pins.bypass_change_detection().pins).len()
            } else {
                pins.bypass_change_detection().release_user_pins()
            };
            if count > 0 {
                pins.set_changed();
                commands.trigger(ClothUnpinned { entity, count });
            }
        }
    }
}

/// Moves what is held to the pointer. While the pointer is outside the camera's viewport, it stays.
fn move_hand(
    settings: Res<ClothDragSettings>,
    rays: Res<RayMap>,
    wheel: Option<MessageReader<MouseWheel>>,
    pixels_per_line: Option<Res<MouseScrollPixelsPerLine>>,
    mut cloths: Query<(&mut ClothGrab, &mut ClothDrag)>,
    cameras: Query<&GlobalTransform, With<Camera>>,
) {
    let pixels_per_line = pixels_per_line.map_or_else(Default::default, |ratio| *ratio);
    let notches: f32 = wheel.map_or(0.0, |mut wheel| {
        wheel
            .read()
            .map(|event| match event.unit {
                MouseScrollUnit::Line => event.y,
                MouseScrollUnit::Pixel => event.y / pixels_per_line,
            })
            .sum()
    });
    for (mut grab, mut drag) in &mut cloths {
        if notches != 0.0 && drag.pointer == PointerId::Mouse {
            drag.depth = (drag.depth + notches * settings.wheel_step).max(0.1);
        }
        let ray = rays.map.get(&RayId::new(drag.camera, drag.pointer));
        if let (Some(ray), Ok(camera)) = (ray, cameras.get(drag.camera))
            && let Some(point) = at_depth(ray, camera, drag.depth)
        {
            grab.move_to(point + drag.offset);
        }
    }
}
