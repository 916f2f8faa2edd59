//! Plays a script: sends the messages that a mouse and a keyboard send, so that everything takes the same way as
//! with a player.

use bevy::{
    camera::NormalizedRenderTarget,
    ecs::system::SystemState,
    input::{
        ButtonState,
        keyboard::{Key, KeyboardInput, NativeKey},
        mouse::{MouseScrollUnit, MouseWheel},
        touch::TouchPhase,
    },
    log::warn,
    picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput},
    prelude::*,
    window::PrimaryWindow,
};
use tailorbird::prelude::*;

use super::{
    camera::OrbitCamera,
    scenes::SceneCloth,
    script::{Action, Script},
    settings::DemoSettings,
};

/// Plays a script.
#[derive(Clone, Debug)]
pub struct Actor {
    script: Script,
    next: usize,
    lasting: Vec<Lasting>,
    target: NormalizedRenderTarget,
    size: Vec2,
    pointer: Vec2,
    pressed: bool,
}

/// Something that takes a while.
#[derive(Clone, Debug)]
struct Lasting {
    what: Motion,
    seconds_left: f32,
}

#[derive(Clone, Debug)]
enum Motion {
    Pointer(Vec2),
    Orbit(Vec2),
    Key(KeyCode),
}

impl Actor {
    /// Plays `script` on a picture of this size [pixels].
    pub fn new(script: Script, target: NormalizedRenderTarget, size: UVec2) -> Self {
        Self {
            script,
            next: 0,
            lasting: Vec::new(),
            target,
            size: size.as_vec2(),
            pointer: Vec2::ZERO,
            pressed: false,
        }
    }

    /// Returns whether the pointer touches something within `seconds` from `time`, so that the camera has to look.
    pub fn touches(&self, time: f32, seconds: f32) -> bool {
        let soon = self.script.cues[self.next..]
            .iter()
            .take_while(|cue| cue.at <= time + seconds);
        self.pressed
            || soon.into_iter().any(|cue| {
                matches!(
                    cue.action,
                    Action::Press | Action::PointAt(_) | Action::PointAtCloth(_)
                )
            })
    }

    /// Does what is to be done in the frame from `time` to `time + seconds`.
    pub fn act(&mut self, world: &mut World, time: f32, seconds: f32) {
        self.go_on(world, seconds);
        while let Some(cue) = self.script.cues.get(self.next).filter(|cue| cue.at <= time) {
            let action = cue.action.clone();
            self.next += 1;
            self.start(world, action);
        }
    }

    fn go_on(&mut self, world: &mut World, seconds: f32) {
        let mut lasting = std::mem::take(&mut self.lasting);
        lasting.retain_mut(|motion| {
            let part = (seconds / motion.seconds_left).min(1.0);
            match &mut motion.what {
                Motion::Pointer(left) => {
                    let step = *left * part;
                    *left -= step;
                    self.point(world, self.pointer + step);
                }
                Motion::Orbit(left) => {
                    let step = *left * part;
                    *left -= step;
                    orbit(world, step);
                }
                Motion::Key(key) if part >= 1.0 => send_key(world, *key, ButtonState::Released),
                Motion::Key(_) => {}
            }
            motion.seconds_left -= seconds;
            part < 1.0
        });
        self.lasting.append(&mut lasting);
    }

    fn start(&mut self, world: &mut World, action: Action) {
        match action {
            Action::PointAt(place) => self.point(world, place * self.size),
            Action::PointAtCloth(place) => match cloth_on_screen(world, place) {
                Some(at) => self.point(world, at),
                None => warn!("script: this point of the cloth is not in the picture: {place}"),
            },
            Action::Press => self.press(world, true),
            Action::Release => self.press(world, false),
            Action::Move { by, over } => {
                self.last(Motion::Pointer(by * self.size.y), over);
            }
            Action::Wheel(notches) => send_wheel(world, notches),
            Action::Key { key, seconds } => {
                send_key(world, key, ButtonState::Pressed);
                self.last(Motion::Key(key), seconds);
            }
            Action::Orbit { by, over } => self.last(Motion::Orbit(by), over),
            Action::Zoom(notches) => {
                let mut cameras = world.query::<&mut OrbitCamera>();
                cameras
                    .iter_mut(world)
                    .for_each(|mut camera| camera.zoom(notches));
            }
            Action::ClothWind(velocity) => set(world, |s| s.wind.velocity = velocity),
            Action::ClothGusts(strength) => set(world, |s| s.wind.gusts.strength = strength),
            Action::Preset(name) => set(world, |s| s.choose_preset(&name)),
            Action::Look { name, shown } => set(world, |s| s.look.set(&name, shown)),
        }
    }

    fn last(&mut self, what: Motion, seconds: f32) {
        self.lasting.push(Lasting {
            what,
            seconds_left: seconds.max(1e-4),
        });
    }

    fn point(&mut self, world: &mut World, to: Vec2) {
        let delta = to - self.pointer;
        self.pointer = to;
        self.send(world, PointerAction::Move { delta });
    }

    fn press(&mut self, world: &mut World, pressed: bool) {
        self.pressed = pressed;
        self.send(
            world,
            if pressed {
                PointerAction::Press(PointerButton::Primary)
            } else {
                PointerAction::Release(PointerButton::Primary)
            },
        );
    }

    fn send(&self, world: &mut World, action: PointerAction) {
        let location = Location {
            target: self.target.clone(),
            position: self.pointer,
        };
        world.write_message(PointerInput::new(PointerId::Mouse, location, action));
    }
}

fn set(world: &mut World, change: impl FnOnce(&mut DemoSettings)) {
    change(&mut world.resource_mut::<DemoSettings>());
}

fn orbit(world: &mut World, degrees: Vec2) {
    let mut cameras = world.query::<&mut OrbitCamera>();
    for mut camera in cameras.iter_mut(world) {
        camera.turn(degrees.x.to_radians(), degrees.y.to_radians());
    }
}

fn window(world: &mut World) -> Entity {
    let mut windows = world.query_filtered::<Entity, With<PrimaryWindow>>();
    windows.iter(world).next().unwrap_or(Entity::PLACEHOLDER)
}

fn send_key(world: &mut World, key_code: KeyCode, state: ButtonState) {
    let window = window(world);
    world.write_message(KeyboardInput {
        key_code,
        logical_key: Key::Unidentified(NativeKey::Unidentified),
        state,
        text: None,
        repeat: false,
        window,
    });
}

fn send_wheel(world: &mut World, notches: f32) {
    let window = window(world);
    world.write_message(MouseWheel {
        unit: MouseScrollUnit::Line,
        x: 0.0,
        y: notches,
        window,
        phase: TouchPhase::Moved,
    });
}

/// Place of a point of the cloth in the picture [pixels].
fn cloth_on_screen(world: &mut World, place: Vec2) -> Option<Vec2> {
    type Cloths = Query<
        'static,
        'static,
        (&'static Cloth, &'static ClothParticles, &'static ClothFrame),
        With<SceneCloth>,
    >;
    type Cameras =
        Query<'static, 'static, (&'static Camera, &'static GlobalTransform), With<OrbitCamera>>;
    let mut state: SystemState<(Cloths, Cameras)> = SystemState::new(world);
    let (cloths, cameras) = state.get(world).ok()?;
    let (cloth, particles, frame) = cloths.iter().next()?;
    let (camera, eye) = cameras.iter().next()?;
    let last = cloth.resolution()? - 1;
    let cell = (place.clamp(Vec2::ZERO, Vec2::ONE) * last.as_vec2())
        .round()
        .as_uvec2();
    let particle = (cell.y * (last.x + 1) + cell.x) as usize;
    if particle >= particles.len() {
        return None;
    }
    camera
        .world_to_viewport(eye, particles.world_position(particle, frame))
        .ok()
}
