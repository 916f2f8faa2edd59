//! A camera that goes round a point: the right mouse button turns, the middle one moves, the wheel comes closer, and
//! keys do. The left button is left to the cloth.

use std::f32::consts::FRAC_PI_2;

use bevy::{
    input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollPixelsPerLine},
    post_process::dof::DepthOfField,
    prelude::*,
};
use bevy_egui::input::EguiWantsInput;
use tailorbird::prelude::*;

use super::compare::Beside;

/// Drives every [`OrbitCamera`].
pub struct OrbitCameraPlugin;

impl Plugin for OrbitCameraPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            RunFixedMainLoop,
            (turn_by_mouse, turn_by_keys, follow, place_cameras)
                .chain()
                .in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        );
    }
}

/// Place of a camera, around the point that it looks at.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// Point that it looks at [m].
    pub focus: Vec3,
    /// To the right, seen from above [rad].
    pub yaw: f32,
    /// Above the focus [rad].
    pub pitch: f32,
    /// From the focus [m].
    pub distance: f32,
    /// The part of the picture's width at the right that something covers [-]: the focus is in the middle of the rest.
    pub covered: f32,
    /// Added to the focus: over which point of the ground what is followed is [m].
    pub followed: Option<Vec3>,
}

/// On what a camera goes along with.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Followed;

impl OrbitCamera {
    /// Largest angle up and down [rad].
    const STEEPEST: f32 = FRAC_PI_2 - 0.05;
    /// Turn per pixel of the mouse's displacement [rad].
    const TURN: f32 = 0.006;

    /// Looks at `focus` [m] from `distance` [m]; yaw and pitch in degrees.
    pub fn new(focus: Vec3, yaw: f32, pitch: f32, distance: f32) -> Self {
        Self {
            focus,
            yaw: yaw.to_radians(),
            pitch: pitch.to_radians(),
            distance,
            covered: 0.0,
            followed: None,
        }
    }

    /// Goes round [rad].
    pub fn turn(&mut self, yaw: f32, pitch: f32) {
        self.yaw += yaw;
        // From below, the ground would hide everything.
        self.pitch = (self.pitch + pitch).clamp(-0.1, Self::STEEPEST);
    }

    /// Comes closer by this number of notches of the wheel.
    pub fn zoom(&mut self, notches: f32) {
        self.distance = (self.distance * (-0.12 * notches).exp()).clamp(0.4, 15.0);
    }

    fn rotation(&self) -> Quat {
        Quat::from_euler(EulerRot::YXZ, self.yaw, -self.pitch, 0.0)
    }

    /// Transform of the camera, for the width [m] of what it sees at a distance of 1 m.
    fn transform(&self, width: f32) -> Transform {
        let rotation = self.rotation();
        let aside = 0.5 * self.covered * width * self.distance;
        let focus = self.focus + self.followed.unwrap_or_default();
        let position = focus + rotation * Vec3::new(aside, 0.0, self.distance);
        Transform::from_translation(position.with_y(position.y.max(0.05))).with_rotation(rotation)
    }
}

/// Motion of the camera that began, and lasts while its button is down.
#[derive(Default)]
enum Hold {
    #[default]
    None,
    Turn,
    Move,
}

fn turn_by_mouse(
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    pixels_per_line: Res<MouseScrollPixelsPerLine>,
    panel: Option<Res<EguiWantsInput>>,
    dragged: Query<(), With<ClothDrag>>,
    mut hold: Local<Hold>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    let over_panel = panel.is_some_and(|panel| panel.wants_any_pointer_input());
    if !over_panel && buttons.just_pressed(MouseButton::Right) {
        *hold = Hold::Turn;
    } else if !over_panel && buttons.just_pressed(MouseButton::Middle) {
        *hold = Hold::Move;
    } else if !buttons.any_pressed([MouseButton::Right, MouseButton::Middle]) {
        *hold = Hold::None;
    }
    let notches = scroll.to_lines(&pixels_per_line).delta.y;
    let zooms = !over_panel && dragged.is_empty();
    for mut camera in &mut cameras {
        if zooms && notches != 0.0 {
            camera.zoom(notches);
        }
        let drag = motion.delta;
        if drag == Vec2::ZERO {
            continue;
        }
        match *hold {
            Hold::None => {}
            Hold::Turn => {
                let turn = -drag * OrbitCamera::TURN;
                camera.turn(turn.x, -turn.y);
            }
            Hold::Move => {
                let step = Vec3::new(-drag.x, drag.y, 0.0) * 0.001 * camera.distance;
                let step = camera.rotation() * step;
                camera.focus += step;
            }
        }
    }
}

/// W, A, S and D turn, + and − zoom.
fn turn_by_keys(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    time: Res<Time<Real>>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    /// [rad/s].
    const TURN: f32 = 1.2;
    /// Notches of the wheel [1/s].
    const ZOOM: f32 = 6.0;
    let Some(keys) = keys else {
        return;
    };
    let axis = |more: &[KeyCode], less: &[KeyCode]| {
        let pressed = |keys_of: &[KeyCode]| f32::from(keys.any_pressed(keys_of.iter().copied()));
        (pressed(more) - pressed(less)) * time.delta_secs()
    };
    let turn = TURN
        * Vec2::new(
            axis(&[KeyCode::KeyD], &[KeyCode::KeyA]),
            axis(&[KeyCode::KeyW], &[KeyCode::KeyS]),
        );
    let closer = ZOOM
        * axis(
            &[KeyCode::Equal, KeyCode::NumpadAdd],
            &[KeyCode::Minus, KeyCode::NumpadSubtract],
        );
    for mut camera in &mut cameras {
        if turn != Vec2::ZERO {
            camera.turn(turn.x, turn.y);
        }
        if closer != 0.0 {
            camera.zoom(closer);
        }
    }
}

/// Goes along over the ground, a little late.
fn follow(
    time: Res<Time>,
    things: Query<&Transform, (With<Followed>, Without<Beside>, Without<OrbitCamera>)>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    /// [s].
    const LATE: f32 = 0.2;
    let place = things.iter().next().map(|at| at.translation.with_y(0.0));
    let part = 1.0 - (-time.delta_secs() / LATE).exp();
    for mut camera in &mut cameras {
        let followed = match (camera.followed, place) {
            (Some(before), Some(now)) => Some(before.lerp(now, part)),
            (_, now) => now,
        };
        if camera.followed != followed {
            camera.followed = followed;
        }
    }
}

/// Puts the cameras where they belong.
pub fn place_cameras(
    mut cameras: Query<
        (
            &OrbitCamera,
            &Projection,
            &mut Transform,
            Option<&mut DepthOfField>,
        ),
        Changed<OrbitCamera>,
    >,
) {
    for (orbit, projection, mut transform, lens) in &mut cameras {
        if let Some(mut lens) = lens {
            lens.focal_distance = orbit.distance;
        }
        let width = match projection {
            Projection::Perspective(p) => 2.0 * (0.5 * p.fov).tan() * p.aspect_ratio,
            _ => 0.0,
        };
        *transform = orbit.transform(width);
    }
}
