//! The order of systems is fixed: no two that touch the same data are left without one. A game can choose the schedule
//! and put its own systems between the stages.

use bevy::{
    ecs::schedule::{LogLevel, ScheduleBuildSettings},
    prelude::*,
};
use tailorbird::prelude::*;

use crate::world::*;

#[test]
fn no_systems_are_ambiguous() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()));
    let strict = |schedule: &mut Schedule| {
        schedule.set_build_settings(ScheduleBuildSettings {
            ambiguity_detection: LogLevel::Error,
            ..default()
        });
    };
    app.edit_schedule(FixedPostUpdate, strict);
    app.edit_schedule(ClothSubstep, strict);
    let mut sim = Sim::of(app);
    let cloth = sim.spawn(square(4));
    // Building a schedule with an ambiguity panics.
    sim.steps(3);
    assert!(!sim.particles(cloth).is_empty());
}

#[test]
fn any_schedule_will_do() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::new(FixedUpdate)));
    let mut other = Sim::of(app);
    let mut sim = Sim::new();
    let [a, b] = [&mut sim, &mut other].map(|sim| {
        let cloth = sim.spawn(square(5));
        sim.steps(20);
        sim.hash(cloth)
    });
    assert_eq!(a, b);
}

#[derive(Resource, Default)]
struct Calls(Vec<(u32, &'static str)>);

#[test]
fn a_game_can_put_systems_between_the_stages() {
    let mut sim = Sim::new().with_passes(3, 1);
    sim.app.init_resource::<Calls>();
    let call = |name: &'static str| {
        move |step: Res<ClothStep>, mut calls: ResMut<Calls>| {
            calls.0.push((step.substep(), name));
        }
    };
    use ClothSubstepSystems::{Collide, Integrate, Solve};
    sim.app.add_systems(
        ClothSubstep,
        (call("before"), call("moved"), call("solved"), call("after")).chain(),
    );
    sim.app.add_systems(
        ClothSubstep,
        (
            (|| ()).after(Integrate).before(Solve),
            (|| ()).after(Solve).before(Collide),
        ),
    );
    sim.spawn(square(3));
    sim.steps(1);
    let expected: Vec<_> = (0..3)
        .flat_map(|k| ["before", "moved", "solved", "after"].map(|name| (k, name)))
        .collect();
    assert_eq!(sim.app.world().resource::<Calls>().0, expected);
}
