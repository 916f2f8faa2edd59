//! An app in which a world happens.

use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, FixedUpdate, TaskPoolOptions, TaskPoolPlugin, Update};
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use tailorbird_cloth::prelude::*;

use crate::{
    CALM, WATCHED,
    film::{Film, film},
    play::{Play, play},
    world::World as Description,
};

/// Lets a world happen.
pub fn happen(description: &Description) -> Film {
    let mut app = App::new();
    let mut pools = TaskPoolOptions::default();
    pools.compute.min_threads = 1;
    pools.compute.max_threads = 1;
    let pools = TaskPoolPlugin {
        task_pool_options: pools,
    };
    let clock = &description.clock;
    app.add_plugins((pools, TimePlugin, ClothPlugin::default()))
        .insert_resource(if description.air {
            ClothWind::default()
        } else {
            ClothWind::vacuum()
        })
        .insert_resource(Time::<Fixed>::from_hz(clock.hz))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / clock.fps,
        )))
        .insert_resource(Film::new(clock.hz, description.air))
        .add_systems(FixedPostUpdate, film.after(ClothSystems::Writeback));
    if clock.fixed {
        app.add_systems(FixedUpdate, play);
    } else {
        app.add_systems(Update, play);
    }
    let play = Play::new(app.world_mut(), description);
    app.insert_resource(play);
    app.finish();
    app.cleanup();
    let enough = (clock.hz * f64::from(CALM + WATCHED)).ceil() as usize;
    while app.world().resource::<Film>().calm_steps() < enough {
        app.update();
        let paused = app.world_mut().resource_mut::<Play>().take_pause();
        if let Some((holder, by)) = paused {
            app.world_mut().resource_mut::<Time<Virtual>>().pause();
            app.update();
            let world = app.world_mut();
            world.resource_scope(|world, mut play: Mut<Play>| play.shift(world, holder, by));
            app.update();
            app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        }
    }
    app.world_mut().remove_resource::<Film>().unwrap()
}
