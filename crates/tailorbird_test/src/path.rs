//! Entities that move by a clock.

use bevy_app::{App, FixedUpdate, PostUpdate, Update};
use bevy_ecs::prelude::*;
use bevy_time::Time;
use bevy_transform::components::Transform;

/// The schedule in which something moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Before each step.
    FixedUpdate,
    /// Once a frame.
    Update,
    /// Once a frame, after animation.
    PostUpdate,
}

/// The place of its entity by the clock of a schedule \[s\].
#[derive(Component)]
pub struct Path {
    when: When,
    at: Box<dyn Fn(f32) -> Transform + Send + Sync>,
}

impl Path {
    /// Moves before each step, to where the entity is at its end.
    pub fn new(at: impl Fn(f32) -> Transform + Send + Sync + 'static) -> Self {
        Self::when(When::FixedUpdate, at)
    }

    /// Moves in this schedule.
    pub fn when(when: When, at: impl Fn(f32) -> Transform + Send + Sync + 'static) -> Self {
        let at = Box::new(at);
        Self { when, at }
    }
}

fn go(when: When) -> impl Fn(Res<Time>, Query<(&Path, &mut Transform)>) {
    move |time, mut movers| {
        for (path, mut place) in &mut movers {
            if path.when == when {
                *place = (path.at)(time.elapsed_secs());
            }
        }
    }
}

/// Lets paths be followed.
pub(crate) fn follow(app: &mut App) {
    app.add_systems(FixedUpdate, go(When::FixedUpdate))
        .add_systems(Update, go(When::Update))
        .add_systems(PostUpdate, go(When::PostUpdate));
}
