//! Cost of a game's systems within a substep.

use std::time::Duration;

use bevy_app::{App, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use serde::Serialize;
use tailorbird_cloth::{collider::find_contacts, prelude::*};

use super::{cli::Args, measure::median};

/// One measurement, as it is written.
#[derive(Serialize, Clone, Debug)]
pub struct Record {
    system: &'static str,
    cloths: u32,
    /// Particles along a side.
    size: u32,
    ms: f64,
    /// Ratio to the time without a system of a game.
    ratio: f64,
}

/// A game's systems.
type Systems = fn(&mut App);

fn read(mut cloths: SubstepCloths) {
    for cloth in cloths.iter_mut() {
        for i in 0..cloth.len() {
            std::hint::black_box(cloth.position(i));
        }
    }
}

/// A ball far below.
fn ball(p: Vec3) -> Option<SubstepContact> {
    let away = p + Vec3::Y * 9.0;
    let depth = 0.5 - away.length();
    (depth > 0.0).then(|| SubstepContact::new(away.normalize(), depth).with_friction(0.5))
}

fn approach(mut cloths: SubstepCloths) {
    cloths.iter_mut().for_each(|mut cloth| cloth.approach(ball));
}

fn collide(mut cloths: SubstepCloths) {
    cloths.iter_mut().for_each(|mut cloth| cloth.collide(ball));
}

const SYSTEMS: [(&str, Systems); 4] = [
    ("none", |_| {}),
    ("one that does nothing", |app| {
        app.add_systems(ClothSubstep, || {});
    }),
    ("one that reads all positions", |app| {
        app.add_systems(ClothSubstep, read.in_set(ClothSubstepSystems::Collide));
    }),
    ("a solid: two looks at all", |app| {
        let approach = approach
            .in_set(ClothSubstepSystems::Approach)
            .after(find_contacts);
        let collide = collide.in_set(ClothSubstepSystems::Collide);
        app.add_systems(ClothSubstep, (approach, collide));
    }),
];

/// Measures and prints.
pub fn run(args: &Args) -> Vec<Record> {
    let steps = args.steps.unwrap_or(120);
    let mut records = Vec::new();
    println!("ms a step of sheets that hang by two corners, and against none");
    for (cloths, size) in [(1, 64), (1, 128), (100, 32)] {
        let mut none = 0.0;
        for (system, add) in SYSTEMS {
            let ms = measure(cloths, size, steps, add);
            if system == "none" {
                none = ms;
            }
            let ratio = ms / none;
            println!("{cloths:>4} × {size:>3}² {system:<30} {ms:>8.3} {ratio:>6.2}");
            records.push(Record {
                system,
                cloths,
                size,
                ms,
                ratio,
            });
        }
    }
    records
}

fn measure(cloths: u32, size: u32, steps: u32, add: Systems) -> f64 {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        ClothPlugin::default(),
    ));
    let fixed = Time::<Fixed>::from_hz(60.0);
    let step = fixed.timestep();
    app.insert_resource(fixed)
        .insert_resource(TimeUpdateStrategy::ManualDuration(step))
        .insert_resource(ClothWind::vacuum());
    add(&mut app);
    for k in 0..cloths {
        app.world_mut().spawn((
            Cloth::grid(Vec2::splat(2.0), UVec2::splat(size)),
            ClothMaterial::cotton(),
            ClothPins::corners(ClothCorner::TOP),
            ClothSleep::never(),
            Transform::from_xyz(3.0 * k as f32, 0.0, 0.0),
        ));
    }
    app.update();
    let times: Vec<Duration> = (0..steps)
        .map(|_| {
            app.update();
            app.world().resource::<ClothStepTime>().total
        })
        .collect();
    median(times).as_secs_f64() * 1e3
}
