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

use bevy_math::{UVec2, Vec3};
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
}
