//! A step of a cloth that has moved for a while allocates nothing.

#![cfg(test)]
#![expect(unsafe_code, reason = "a global allocator")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicU64, Ordering},
};

#[path = "chains/scene.rs"]
#[expect(dead_code, reason = "shared with the test `chains`")]
mod scene;

use bevy_app::FixedUpdate;
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec3};
use bevy_transform::components::Transform;
use scene::{Scene, Sheet};
use tailorbird_cloth::prelude::*;

/// Counts what is asked of it.
struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);

// SAFETY: the system's allocator does the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps to the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps to the contract.
        unsafe { System.realloc(old, layout, size) }
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps to the contract.
        unsafe { System.dealloc(old, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const STEPS: u32 = 60;

/// Allocations in [`STEPS`] updates, after as many; the schedules of the ECS have some of their own.
fn allocations(sheet: &mut Sheet) -> u64 {
    sheet.steps(STEPS);
    let before = COUNT.load(Ordering::Relaxed);
    sheet.steps(STEPS);
    COUNT.load(Ordering::Relaxed) - before
}

// A single test, as the counter is everybody's.
#[test]
fn cloth_adds_no_allocation_to_an_update() {
    let mut empty = Sheet::new(&Scene::default());
    empty.app.world_mut().despawn(empty.entity);
    let without = allocations(&mut empty);
    // A schedule with a system in it allocates as well.
    empty
        .app
        .add_systems(FixedUpdate, |_: Query<&mut Transform>| ());
    let with_a_system = allocations(&mut empty);
    println!("without cloth: {without} in {STEPS} updates");

    let hang = Scene::hang(UVec2::splat(24));
    let wind = Scene {
        wind: Wind::steady(Vec3::new(8.0, 0.0, 2.0)),
        ..hang.clone()
    };
    for (name, base) in [
        ("hang", hang),
        ("wind", wind),
        ("drape", Scene::drape(UVec2::splat(24))),
    ] {
        for (substeps, side) in [(1, 24), (16, 24), (4, 64)] {
            let with = allocations(&mut Sheet::new(&Scene {
                substeps: Some(substeps),
                resolution: UVec2::splat(side),
                ..base.clone()
            }));
            println!("{name}, {side}², {substeps} substeps: {with}");
            // Threads of the pool make for a few more or less, not for one in each update.
            assert!(
                with < without + u64::from(STEPS),
                "{name}, {side}², {substeps} substeps: {with}, not {without}"
            );
        }
    }

    let mut held = Sheet::new(&Scene {
        substeps: Some(8),
        resolution: UVec2::splat(24),
        ..Scene::default()
    });
    let (cloth, world) = (held.entity, held.app.world_mut());
    let hand = world.spawn(Transform::default()).id();
    let edge = ClothAttachment::edge(GridEdge::Top);
    let soft = ClothAttachment::edge(GridEdge::Left).with_compliance(0.01);
    for attachment in [edge, soft] {
        world.spawn((attachment.to(hand), AttachmentOf(cloth)));
    }
    let targets = ClothMotionTargets::in_space(TargetSpace::World);
    let limits = ClothMotionConstraints::within(0.2).with_backstop(0.1, 1.0);
    world
        .entity_mut(cloth)
        .insert((limits, targets, ClothPinForces::default()));
    let rest = world
        .get::<Cloth>(cloth)
        .map(Cloth::rest_positions)
        .unwrap_or_default();
    let mut time = 0.0;
    held.app.add_systems(
        FixedUpdate,
        move |mut targets: Single<&mut ClothMotionTargets>, mut at: Query<&mut Transform>| {
            time += 0.01;
            targets.set_positions(rest.iter().map(|p| *p + Vec3::Y * time));
            if let Ok(mut at) = at.get_mut(hand) {
                at.translation.y = time;
            }
        },
    );
    let with = allocations(&mut held);
    println!("held: {with}");
    assert!(
        with < with_a_system + u64::from(STEPS),
        "held: {with}, not {with_a_system}"
    );
}
