//! A gamepad: the left stick moves the ball, the right one turns the view, the triggers zoom.

use bevy::{app::RunFixedMainLoopSystems, input::gamepad::GamepadButton as Button, prelude::*};
use tailorbird::{
    prelude::*,
    sphere_controls::{draw_spheres, move_spheres},
};

use super::{
    camera::{OrbitCamera, place_cameras},
    settings::DemoSettings,
};

/// Plays by gamepad.
pub struct GamepadPlugin;

impl Plugin for GamepadPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, press_buttons)
            .add_systems(
                FixedUpdate,
                (
                    take_back.before(move_spheres),
                    push_spheres.after(move_spheres),
                ),
            )
            .add_systems(
                RunFixedMainLoop,
                (
                    turn_view
                        .before(place_cameras)
                        .in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
                    draw_pushed
                        .after(draw_spheres)
                        .in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
                ),
            );
    }
}

/// The most that the right stick turns the view [rad/s].
const TURN: f32 = 2.0;
/// Speed at which the triggers zoom [notches of the wheel/s].
const ZOOM: f32 = 8.0;

fn press_buttons(pads: Query<&Gamepad>, mut settings: ResMut<DemoSettings>) {
    for pad in &pads {
        if pad.just_pressed(Button::South) {
            settings.paused = !settings.paused;
        }
        if pad.just_pressed(Button::West) {
            settings.reset();
        }
        if pad.just_pressed(Button::LeftTrigger) {
            settings.show_next(-1);
        }
        if pad.just_pressed(Button::RightTrigger) {
            settings.show_next(1);
        }
    }
}

fn turn_view(pads: Query<&Gamepad>, time: Res<Time<Real>>, mut cameras: Query<&mut OrbitCamera>) {
    let seconds = time.delta_secs();
    for pad in &pads {
        let stick = pad.right_stick();
        let trigger = |button| pad.get(button).unwrap_or(0.0);
        let closer = trigger(Button::RightTrigger2) - trigger(Button::LeftTrigger2);
        for mut camera in &mut cameras {
            if stick != Vec2::ZERO {
                let turn = stick * TURN * seconds;
                camera.turn(turn.x, turn.y);
            }
            if closer != 0.0 {
                camera.zoom(closer * ZOOM * seconds);
            }
        }
    }
}

/// Places to which the stick pushed something, after the last two fixed steps. It is drawn between them, as cloth is.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Pushed {
    previous: Vec3,
    current: Vec3,
    /// Place that was put into the `Transform` last; another one there was put there by somebody else.
    drawn: Option<Vec3>,
}

/// Puts back what was drawn between two steps.
fn take_back(mut things: Query<(&mut Pushed, &mut Transform)>) {
    for (mut pushed, mut transform) in &mut things {
        if pushed.drawn.take() == Some(transform.translation) {
            transform.translation = pushed.current;
        }
        pushed.previous = transform.translation;
    }
}

/// The left stick, over the ground as seen from the camera.
fn push_spheres(
    mut commands: Commands,
    pads: Query<&Gamepad>,
    time: Res<Time>,
    cameras: Query<&OrbitCamera>,
    mut things: Query<(
        Entity,
        &ClothSphereControls,
        &mut Transform,
        Option<&mut Pushed>,
    )>,
) {
    let stick: Vec2 = pads.iter().map(Gamepad::left_stick).sum();
    let stick = stick.clamp_length_max(1.0);
    if stick == Vec2::ZERO {
        return;
    }
    let yaw = cameras.iter().next().map_or(0.0, |camera| camera.yaw);
    let direction = Quat::from_rotation_y(yaw) * Vec3::new(stick.x, 0.0, -stick.y);
    for (entity, controls, mut transform, pushed) in &mut things {
        let before = transform.translation;
        transform.translation += direction * controls.speed * time.delta_secs();
        let current = transform.translation;
        match pushed {
            Some(mut pushed) => {
                pushed.current = current;
                pushed.drawn = Some(current);
            }
            None => {
                commands.entity(entity).insert(Pushed {
                    previous: before,
                    current,
                    drawn: Some(current),
                });
            }
        }
    }
}

fn draw_pushed(time: Res<Time<Fixed>>, mut things: Query<(&mut Pushed, &mut Transform)>) {
    for (mut pushed, mut transform) in &mut things {
        if pushed.drawn != Some(transform.translation) {
            continue;
        }
        let place = pushed
            .previous
            .lerp(pushed.current, time.overstep_fraction());
        if transform.translation != place {
            transform.translation = place;
        }
        pushed.drawn = Some(place);
    }
}
