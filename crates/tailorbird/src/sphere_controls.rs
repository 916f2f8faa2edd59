//! Moves a sphere (or anything else) with the keyboard.
//!
//! It moves in fixed steps, as the cloth does, and is drawn between the last two, as the cloth is: so the two are always
//! seen at the same moment, and a moving ball never seems to cut into the cloth on it.

use std::fmt;

use bevy_app::{App, FixedUpdate, Plugin, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy_ecs::prelude::*;
use bevy_input::{ButtonInput, keyboard::KeyCode};
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;

/// Moves entities with [`ClothSphereControls`] by keys.
pub struct ClothSphereControlsPlugin;

/// Moves the entity along the world's axes by keys. Printing it prints the keys.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[require(SphereControlsState)]
pub struct ClothSphereControls {
    /// Towards −x.
    pub key_left: KeyCode,
    /// Towards +x.
    pub key_right: KeyCode,
    /// Towards −z.
    pub key_forward: KeyCode,
    /// Towards +z.
    pub key_back: KeyCode,
    /// Towards +y.
    pub key_up: KeyCode,
    /// Towards −y.
    pub key_down: KeyCode,
    /// While held: [`Self::fast_speed`].
    pub key_fast: KeyCode,
    /// [m/s].
    pub speed: f32,
    /// [m/s].
    pub fast_speed: f32,
}

impl Default for ClothSphereControls {
    fn default() -> Self {
        Self {
            key_left: KeyCode::ArrowLeft,
            key_right: KeyCode::ArrowRight,
            key_forward: KeyCode::ArrowUp,
            key_back: KeyCode::ArrowDown,
            key_up: KeyCode::PageUp,
            key_down: KeyCode::PageDown,
            key_fast: KeyCode::ShiftLeft,
            speed: 1.5,
            fast_speed: 4.0,
        }
    }
}

impl fmt::Display for ClothSphereControls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Sphere Controls:
    {:?} & {:?}\t- Move left & right
    {:?} & {:?}\t- Move forward & backward
    {:?} & {:?}\t- Move up & down
    {:?}\t- Move faster while held",
            self.key_left,
            self.key_right,
            self.key_forward,
            self.key_back,
            self.key_up,
            self.key_down,
            self.key_fast,
        )
    }
}

impl ClothSphereControls {
    /// The velocity that these keys ask for [m/s].
    fn velocity(&self, keys: &ButtonInput<KeyCode>) -> Vec3 {
        let axis = |positive, negative| {
            f32::from(keys.pressed(positive)) - f32::from(keys.pressed(negative))
        };
        let direction = Vec3::new(
            axis(self.key_right, self.key_left),
            axis(self.key_up, self.key_down),
            axis(self.key_back, self.key_forward),
        );
        let speed = if keys.pressed(self.key_fast) {
            self.fast_speed
        } else {
            self.speed
        };
        direction.clamp_length_max(1.0) * speed
    }
}

/// Positions of the entity after the last two fixed steps. Written by this plugin alone.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct SphereControlsState {
    previous: Vec3,
    current: Vec3,
    /// Position that was put into the `Transform` last; another one there was put there by somebody else.
    drawn: Option<Vec3>,
}

impl Plugin for ClothSphereControlsPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ClothSphereControls>()
            .register_type::<SphereControlsState>()
            .add_systems(
                FixedUpdate,
                move_spheres.run_if(resource_exists::<ButtonInput<KeyCode>>),
            )
            .add_systems(
                RunFixedMainLoop,
                draw_spheres.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
    }
}

/// Moves them on by a fixed step.
pub fn move_spheres(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    mut spheres: Query<(
        &ClothSphereControls,
        &mut SphereControlsState,
        &mut Transform,
    )>,
) {
    for (controls, mut state, mut transform) in &mut spheres {
        if state.drawn != Some(transform.translation) {
            state.current = transform.translation;
        }
        state.previous = state.current;
        state.current += controls.velocity(&keys) * time.delta_secs();
        if transform.translation != state.current {
            transform.translation = state.current;
        }
        state.drawn = Some(state.current);
    }
}

/// Draws them between the last two fixed steps.
pub fn draw_spheres(
    time: Res<Time<Fixed>>,
    mut spheres: Query<(&mut SphereControlsState, &mut Transform), With<ClothSphereControls>>,
) {
    for (mut state, mut transform) in &mut spheres {
        if state.drawn != Some(transform.translation) {
            continue;
        }
        let place = state.previous.lerp(state.current, time.overstep_fraction());
        if transform.translation != place {
            transform.translation = place;
        }
        state.drawn = Some(place);
    }
}
