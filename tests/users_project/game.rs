//! A game of one file, as a user writes it outside this workspace, but without a window: the README's curtain, and how long a step takes.

use bevy_app::{App, TaskPoolPlugin};
use bevy_log::LogPlugin;
use bevy_math::{UVec2, Vec2};
use bevy_time::{Time, TimePlugin, TimeUpdateStrategy};
use std::time::{Duration, Instant};
use tailorbird::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        LogPlugin::default(),
        ClothPlugins::default(),
    ));
    let step = app.world().resource::<Time<bevy_time::Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    app.world_mut().spawn((
        Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48)),
        ClothMaterial::cotton(),
        ClothPins::corners(ClothCorner::TOP),
    ));
    let mut best = Duration::MAX;
    for _ in 0..60 {
        let start = Instant::now();
        app.update();
        let took = start.elapsed();
        if app.world().resource::<ClothStep>().steps() > 2 {
            best = best.min(took);
        }
    }
    println!("best step: {} µs", best.as_micros());
}
