//! A server: no window, no renderer. A sail blows in gusts, and what pulls the ship is printed once a second, until Ctrl+C ends it.
//!
//! A game's own server depends on `tailorbird_cloth`, or on `tailorbird` with `default-features = false`; names are the same.

use std::time::Duration;

use bevy::{app::ScheduleRunnerPlugin, prelude::*, time::common_conditions::on_timer};
use tailorbird::cloth::prelude::*;

fn main() {
    // As often as the fixed loop steps: `Time::<Fixed>::from_hz` sets another rate.
    let ticks = Duration::from_secs_f64(1.0 / 64.0);
    App::new()
        .add_plugins((
            MinimalPlugins.set(ScheduleRunnerPlugin::run_loop(ticks)),
            ClothPlugin::default(),
        ))
        .insert_resource(ClothWind {
            gusts: ClothGusts {
                strength: 0.6,
                period: 4.0,
            },
            ..ClothWind::steady(Vec3::new(0.0, 0.0, 6.0))
        })
        .add_systems(Startup, hoist)
        .add_systems(Update, tell.run_if(on_timer(Duration::from_secs(1))))
        .run();
}

/// A sail that is held by its corners, nearer to each other than it is wide, so that it bellies.
fn hoist(mut commands: Commands) {
    let half = 1.8;
    let held = |corner, x: f32, y: f32| ClothPin {
        target: Some(half * Vec3::new(x, y, 0.0)),
        ..ClothPin::new(ClothSelection::Corner(corner))
    };
    commands.spawn((
        Cloth::grid(Vec2::splat(4.0), UVec2::splat(41)).centered(),
        ClothMaterial::canvas(),
        ClothPins::default()
            .with(held(ClothCorner::TopLeft, -1.0, 1.0))
            .with(held(ClothCorner::TopRight, 1.0, 1.0))
            .with(held(ClothCorner::BottomLeft, -1.0, -1.0))
            .with(held(ClothCorner::BottomRight, 1.0, -1.0)),
        // Measured where it is asked for.
        ClothPinForces::default(),
        Transform::from_xyz(0.0, 5.0, 0.0),
    ));
}

fn tell(
    time: Res<Time>,
    wind: Res<ClothWindState>,
    step: Res<ClothStepTime>,
    sail: Single<(&ClothParticles, &ClothFrame, &ClothPinForces)>,
) {
    let (particles, frame, forces) = *sail;
    let middle = particles.world_position(particles.len() / 2, frame);
    println!(
        "{:3.0} s: wind {:4.1} m/s, the sail bellies by {:.2} m and pulls forward with {:4.0} N; a step takes {:.2} ms",
        time.elapsed_secs(),
        wind.velocity_at(middle).length(),
        middle.z,
        forces.force().z,
        step.total.as_secs_f64() * 1e3,
    );
}
