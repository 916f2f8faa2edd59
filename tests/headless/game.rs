//! An app as a game has it, without a window system and without a graphics driver, with manual time; and the hands of a
//! player: pointer, buttons, wheel and keys, as the window system would report them.

use std::{thread, time::Duration};

use bevy::{
    camera::Viewport,
    gltf::GltfPlugin,
    input::{
        ButtonState,
        keyboard::{Key, KeyboardInput},
        mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel},
    },
    log::LogPlugin,
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    time::TimeUpdateStrategy,
    window::{CursorMoved, PrimaryWindow, WindowEvent, WindowResolution},
    winit::WinitPlugin,
};
use tailorbird::prelude::*;

pub const HERTZ: f64 = 60.0;
pub const SIZE: UVec2 = UVec2::new(800, 600);

/// A game with a window of 800 × 600, and frames that each last one fixed step.
pub fn game() -> App {
    let mut app = unfinished();
    app.finish();
    app.cleanup();
    app
}

/// The same, before its plugins are finished: more can be added.
pub fn unfinished() -> App {
    let mut app = without_hands();
    app.add_plugins((ClothDragPlugin, ClothSphereControlsPlugin));
    app
}

/// The same as a game that asks for cloth alone.
pub fn without_hands() -> App {
    with_textures(ClothFabricPlugin::default())
}

/// The same, with fabrics' textures from elsewhere.
pub fn with_textures(textures: ClothFabricPlugin) -> App {
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(WgpuSettings {
                    backends: None,
                    ..default()
                })),
                ..default()
            })
            .set(
                GltfPlugin::default()
                    .add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_CLOTH_PIN),
            )
            .set(WindowPlugin {
                primary_window: Some(Window {
                    resolution: WindowResolution::new(SIZE.x, SIZE.y),
                    ..default()
                }),
                ..default()
            }),
    )
    // Without a graphics driver Bevy leaves this out, and despawning a camera then panics.
    .add_plugins((
        bevy::extract::sync_world::SyncWorldPlugin::<bevy::render::RenderApp>::default(),
        ClothPlugins::default().set(textures),
    ))
    .insert_resource(Time::<Fixed>::from_hz(HERTZ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / HERTZ)));
    app
}

/// Lets frames pass until something is so; the files are read meanwhile.
pub fn wait(app: &mut App, mut until: impl FnMut(&mut App) -> bool) {
    for _ in 0..2000 {
        app.update();
        if until(app) {
            return;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("nothing comes");
}

/// Lets frames pass.
pub fn frames(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
    }
}

/// A camera `distance` [m] away that looks along −z at the origin.
pub fn camera(
    app: &mut App,
    distance: f32,
    viewport: Option<(UVec2, UVec2)>,
    order: isize,
) -> Entity {
    app.world_mut()
        .spawn((
            Camera3d::default(),
            Camera {
                viewport: viewport.map(|(physical_position, physical_size)| Viewport {
                    physical_position,
                    physical_size,
                    ..default()
                }),
                order,
                ..default()
            },
            Transform::from_xyz(0.0, 0.0, distance).looking_at(Vec3::ZERO, Vec3::Y),
        ))
        .id()
}

/// A sheet of 2 m × 2 m around the origin, pinned at its upper corners, that faces the camera.
pub fn curtain(app: &mut App, resolution: u32) -> Entity {
    app.world_mut()
        .spawn((
            Cloth::grid(Vec2::splat(2.0), UVec2::splat(resolution)).centered(),
            ClothPins::corners(ClothCorner::TOP),
            MeshMaterial3d::<StandardMaterial>::default(),
        ))
        .id()
}

fn window(app: &mut App) -> Entity {
    let mut windows = app
        .world_mut()
        .query_filtered::<Entity, With<PrimaryWindow>>();
    windows.single(app.world()).expect("one window")
}

/// Moves the pointer to a place in the window [logical pixels from the top left].
pub fn point(app: &mut App, position: Vec2) {
    let window = window(app);
    app.world_mut()
        .write_message(WindowEvent::CursorMoved(CursorMoved {
            window,
            position,
            delta: None,
        }));
}

/// Place of a point of the world in the picture of a camera [logical pixels of the window].
pub fn on_screen(app: &App, camera: Entity, point: Vec3) -> Vec2 {
    let camera = app.world().entity(camera);
    let (Some(view), Some(place)) = (camera.get::<Camera>(), camera.get::<GlobalTransform>())
    else {
        panic!("no camera");
    };
    view.world_to_viewport(place, point).expect("in view")
}

/// Presses or releases a mouse button.
pub fn button(app: &mut App, button: MouseButton, state: ButtonState) {
    let window = window(app);
    app.world_mut()
        .write_message(WindowEvent::MouseButtonInput(MouseButtonInput {
            button,
            state,
            window,
        }));
}

/// Turns the wheel by some notches.
pub fn wheel(app: &mut App, notches: f32) {
    let window = window(app);
    let event = MouseWheel {
        unit: MouseScrollUnit::Line,
        x: 0.0,
        y: notches,
        window,
        phase: bevy::input::touch::TouchPhase::Moved,
    };
    app.world_mut()
        .write_message(WindowEvent::MouseWheel(event));
    app.world_mut().write_message(event);
}

/// Presses or releases a key.
pub fn key(app: &mut App, key_code: KeyCode, state: ButtonState) {
    let window = window(app);
    app.world_mut().write_message(KeyboardInput {
        key_code,
        logical_key: Key::Dead(None),
        state,
        text: None,
        repeat: false,
        window,
    });
}

/// Presses a key for one frame.
pub fn tap(app: &mut App, key_code: KeyCode) {
    key(app, key_code, ButtonState::Pressed);
    app.update();
    key(app, key_code, ButtonState::Released);
    app.update();
}

/// A component of an entity.
pub fn get<C: Component>(app: &App, entity: Entity) -> &C {
    app.world().get::<C>(entity).expect("the component")
}

/// Position of a particle in the world.
pub fn particle(app: &App, cloth: Entity, i: usize) -> Vec3 {
    get::<ClothParticles>(app, cloth).world_position(i, get::<ClothFrame>(app, cloth))
}
