//! A game whose frames are as long as it is told, and whose things move by themselves.

use std::time::Duration;

use bevy_app::{FixedPostUpdate, FixedUpdate, PostUpdate, Update};
use bevy_ecs::{prelude::*, schedule::ScheduleLabel};
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::Time;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Sim, When};

/// Moves the targets of a cloth from their places at rest.
#[derive(Component, Clone, Copy)]
pub struct TargetMover(pub When, pub fn(f32) -> Transform);

fn aim(when: When) -> impl Fn(Res<Time>, Query<(&TargetMover, &Cloth, &mut ClothMotionTargets)>) {
    move |time, mut movers| {
        for (mover, cloth, mut targets) in &mut movers {
            if mover.0 == when {
                let place = mover.1(time.elapsed_secs());
                let rest = cloth.rest_positions();
                targets.set_positions(rest.into_iter().map(|p| place.transform_point(p)));
            }
        }
    }
}

/// Positions of all particles of the first cloth after each step, in the world.
#[derive(Resource, Default)]
pub struct Film {
    pub steps: Vec<Vec<Vec3>>,
    pub stretch: Vec<ClothStretch>,
}

fn look(
    mut film: ResMut<Film>,
    cloths: Query<(&ClothParticles, &ClothFrame, &ClothTopology), With<Cloth>>,
) {
    let Some((particles, frame, topology)) = cloths.iter().next() else {
        return;
    };
    let all = (0..particles.len()).map(|i| particles.world_position(i, frame));
    film.steps.push(all.collect());
    film.stretch.push(particles.stretch(topology));
}

/// So many frames and steps a second.
pub fn game(fps: f64, hz: f64) -> Sim {
    filmed(Sim::vacuum(), FixedPostUpdate, fps, hz)
}

/// Cloths step once a frame.
pub fn game_stepping_in(schedule: impl ScheduleLabel + Clone, fps: f64) -> Sim {
    let mut game = Sim::stepping_in(schedule.clone());
    game.app.insert_resource(ClothWind::vacuum());
    filmed(game, schedule, fps, fps)
}

fn filmed(mut game: Sim, schedule: impl ScheduleLabel, fps: f64, hz: f64) -> Sim {
    game.app
        .init_resource::<Film>()
        .add_systems(FixedUpdate, aim(When::FixedUpdate))
        .add_systems(Update, aim(When::Update))
        .add_systems(PostUpdate, aim(When::PostUpdate))
        .add_systems(schedule, look.after(ClothSystems::Writeback));
    game.set_hz(hz);
    game.set_frame(Duration::from_secs_f64(1.0 / fps));
    game.started()
}

/// Film since the last call.
pub fn film(game: &mut Sim) -> Film {
    std::mem::take(&mut game.resource_mut::<Film>())
}

impl Film {
    /// Mean of the second differences of places in each row of so many particles [m].
    pub fn jolts(&self, columns: usize) -> Vec<f32> {
        let rows = self.steps[0].len() / columns;
        let of_row = |row: usize| {
            let mut sum = 0.0;
            let particles = row * columns..(row + 1) * columns;
            for three in self.steps.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|k| &three[k][particles.clone()]);
                for ((a, b), c) in a.iter().zip(b).zip(c) {
                    sum += (*a - 2.0 * *b + *c).length();
                }
            }
            sum / ((self.steps.len() - 2) * columns) as f32
        };
        (0..rows).map(of_row).collect()
    }

    /// The largest stretch of all [-].
    pub fn stretch(&self) -> f32 {
        self.stretch.iter().map(|s| s.max).fold(0.0, f32::max)
    }

    /// The fastest of the particles, from step to step [m/s].
    pub fn speed(&self, hz: f32) -> f32 {
        let mut fastest = 0.0f32;
        for two in self.steps.windows(2) {
            for (from, to) in two[0].iter().zip(&two[1]) {
                fastest = fastest.max(from.distance(*to) * hz);
            }
        }
        fastest
    }
}

/// Columns and rows of a cape.
pub const SIZE: UVec2 = UVec2::new(16, 24);

/// A cape of 0.8 m × 1.2 m that hangs from its middle.
pub fn cape() -> impl Bundle {
    (
        Cloth::grid(Vec2::new(0.8, 1.2), SIZE).with_origin(Vec2::new(0.5, 0.0)),
        ClothMaterial::cotton(),
        ClothSleep::never(),
    )
}

/// Holder of the cape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Pinned to its entity, which moves.
    Pinned,
    /// Pinned, below an entity that moves.
    Child,
    /// Attached to an entity that moves.
    Attached,
    /// The same, by springs.
    Sprung,
}

pub const HELD: [Held; 4] = [Held::Pinned, Held::Child, Held::Attached, Held::Sprung];

/// A cape, and the entity that moves.
pub fn spawn_cape(game: &mut Sim, held: Held) -> (Entity, Entity) {
    let cloth = game.spawn(cape());
    let top = || ClothAttachment::edge(ClothEdge::Top);
    let pins = ClothPins::edges([ClothEdge::Top]);
    match held {
        Held::Pinned => {
            game.insert(cloth, pins);
            (cloth, cloth)
        }
        Held::Child => {
            let body = game.spawn(Transform::default());
            let mut cloth = game.app.world_mut().entity_mut(cloth);
            cloth.insert((pins, ChildOf(body)));
            (cloth.id(), body)
        }
        Held::Attached | Held::Sprung => {
            let body = game.spawn(Transform::default());
            let clip = if held == Held::Sprung {
                top().with_compliance(1e-4)
            } else {
                top()
            };
            game.attach(cloth, body, clip);
            (cloth, body)
        }
    }
}
