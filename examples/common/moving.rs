//! Things that move by themselves, along paths in time.

use bevy::{app::RunFixedMainLoopSystems, prelude::*};
use tailorbird::prelude::*;

/// Moves its entity: the transform is a function of the time since it appeared [s].
#[derive(Component, Clone, Copy)]
pub struct Moving {
    path: fn(f32) -> Transform,
    seconds: f32,
    /// Added to the path [m].
    pub offset: Vec3,
}

impl Moving {
    /// Along this path.
    pub fn along(path: fn(f32) -> Transform) -> Self {
        Self {
            path,
            seconds: 0.0,
            offset: Vec3::ZERO,
        }
    }

    /// Its place after so many seconds.
    fn place(&self, seconds: f32) -> Transform {
        let place = (self.path)(seconds);
        place.with_translation(place.translation + self.offset)
    }
}

/// Moves what is [`Moving`], in fixed steps, and draws it between them, as cloth is.
pub struct MovingPlugin;

impl Plugin for MovingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(FixedUpdate, go_on).add_systems(
            RunFixedMainLoop,
            draw_between_steps.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
        );
    }
}

fn go_on(
    time: Res<Time>,
    settings: Res<ClothSettings>,
    mut things: Query<(&mut Moving, &mut Transform)>,
) {
    let runs = !settings.paused || settings.pending_steps > 0;
    for (mut thing, mut transform) in &mut things {
        if runs {
            thing.seconds += time.delta_secs();
        }
        *transform = thing.place(thing.seconds);
    }
}

fn draw_between_steps(
    time: Res<Time<Fixed>>,
    settings: Res<ClothSettings>,
    mut things: Query<(&Moving, &mut Transform)>,
) {
    let late = if settings.paused {
        0.0
    } else {
        (1.0 - time.overstep_fraction()) * time.timestep().as_secs_f32()
    };
    for (thing, mut transform) in &mut things {
        *transform = thing.place((thing.seconds - late).max(0.0));
    }
}
