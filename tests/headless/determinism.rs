//! Two runs give the same bits, and so do 1, 2 and 4 threads, on which several cloths are simulated at the same time.

use bevy::{
    ecs::schedule::Schedules,
    prelude::*,
    tasks::{ComputeTaskPool, TaskPoolBuilder},
};
use tailorbird::prelude::*;
use tailorbird_test::child;

use crate::world::*;

/// Eight cloths, more particles in all than are simulated on one thread.
fn crowd() -> u64 {
    crowd_in(Sim::new())
}

fn crowd_in(sim: Sim) -> u64 {
    let mut sim = sim.with_passes(2, 2);
    let mut wind = ClothWind::steady(Vec3::new(1.0, 0.0, 5.0));
    wind.gusts.strength = 0.4;
    sim.app.insert_resource(wind);
    sim.spawn((
        ClothCollider::sphere(0.4),
        Transform::from_xyz(0.0, 0.0, 0.5),
    ));
    sim.spawn((
        ClothCollider::half_space(),
        Transform::from_xyz(0.0, -0.6, 0.0),
    ));
    let cloths: Vec<Entity> = (0..8)
        .map(|k| {
            let place = Transform::from_xyz(k as f32 * 0.2, 0.0, 0.0);
            let pins = ClothPins::particles([k, 40]);
            sim.spawn((square(46 + k), pins, place))
        })
        .collect();
    sim.steps(20);
    assert!(sim.app.world().resource::<ClothStep>().parallel());
    cloths
        .into_iter()
        .fold(0, |bits, cloth| bits.rotate_left(7) ^ sim.hash(cloth))
}

/// Run by the test below in processes of its own, since a process has one pool of threads.
#[test]
fn prints_the_bits_of_a_crowd() {
    let Some(threads) = child::threads() else {
        return;
    };
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    let bits = crowd();
    assert_eq!(ComputeTaskPool::get().thread_num(), threads);
    child::tell(bits);
}

fn bits_on(threads: usize) -> Vec<String> {
    let bits = child::bits("determinism::prints_the_bits_of_a_crowd", threads);
    assert_eq!(bits.len(), 1);
    bits
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let one = bits_on(1);
    assert_eq!(bits_on(2), one);
    assert_eq!(bits_on(4), one);
    assert_eq!(bits_on(4), one);
}

#[test]
fn two_runs_give_the_same_bits() {
    assert_eq!(crowd(), crowd());
}

/// A different order of systems in each, within what they ask for.
#[test]
fn the_order_of_systems_that_ask_for_none_does_not_matter() {
    let bits = crowd();
    for seed in 0..10 {
        let mut sim = Sim::new();
        let mut schedules = sim.app.world_mut().resource_mut::<Schedules>();
        let mut shuffled = 0;
        for (_, schedule) in schedules.iter_mut() {
            let mut settings = schedule.get_build_settings();
            settings.shuffle_seed = Some(seed);
            schedule.set_build_settings(settings);
            shuffled += 1;
        }
        assert!(shuffled > 5, "{shuffled}");
        assert_eq!(crowd_in(sim), bits, "seed {seed}");
    }
}
