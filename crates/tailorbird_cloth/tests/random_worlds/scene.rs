//! An app in which a world happens.

use std::time::Duration;

use bevy_app::{FixedPostUpdate, FixedUpdate, Update};
use bevy_ecs::prelude::*;
use tailorbird_cloth::prelude::*;
use tailorbird_test::Sim;

use crate::{
    CALM, WATCHED,
    film::{Film, film},
    play::{Play, play},
    world::World as Description,
};

/// Lets a world happen.
pub fn happen(description: &Description) -> Film {
    let clock = &description.clock;
    let mut sim = Sim::new();
    sim.set_hz(clock.hz);
    sim.set_frame(Duration::from_secs_f64(1.0 / clock.fps));
    let app = &mut sim.app;
    if !description.air {
        app.insert_resource(ClothWind::vacuum());
    }
    app.insert_resource(Film::new(clock.hz, description.air))
        .add_systems(FixedPostUpdate, film.after(ClothSystems::Writeback));
    if clock.fixed {
        app.add_systems(FixedUpdate, play);
    } else {
        app.add_systems(Update, play);
    }
    let play = Play::new(app.world_mut(), description);
    app.insert_resource(play);
    let enough = (clock.hz * f64::from(CALM + WATCHED)).ceil() as usize;
    while sim.resource::<Film>().calm_steps() < enough {
        sim.frames(1);
        let paused = sim.resource_mut::<Play>().take_pause();
        if let Some((holder, by)) = paused {
            sim.pause(true);
            sim.frames(1);
            let world = sim.app.world_mut();
            world.resource_scope(|world, mut play: Mut<Play>| play.shift(world, holder, by));
            sim.frames(1);
            sim.pause(false);
        }
    }
    sim.app.world_mut().remove_resource::<Film>().unwrap()
}
