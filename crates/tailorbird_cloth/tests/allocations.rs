//! A step of a cloth that has moved for a while allocates nothing.

#![cfg(test)]
#![expect(unsafe_code, reason = "a global allocator")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicU64, Ordering},
};

use bevy_app::FixedUpdate;
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, external};

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
    empty.sim.despawn(empty.entity);
    let without = allocations(&mut empty);
    // A schedule with a system in it allocates as well.
    empty
        .sim
        .app
        .add_systems(FixedUpdate, |_: Query<&mut Transform>| ());
    let with_a_system = allocations(&mut empty);
    println!("without cloth: {without} in {STEPS} updates");

    let hang = Scene::hang(UVec2::splat(24));
    let wind = Scene {
        wind: ClothWind::steady(Vec3::new(8.0, 0.0, 2.0)),
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
    let (cloth, world) = (held.entity, held.sim.app.world_mut());
    let hand = world.spawn(Transform::default()).id();
    let edge = ClothAttachment::edge(ClothEdge::Top);
    let soft = ClothAttachment::edge(ClothEdge::Left).with_compliance(0.01);
    for attachment in [edge, soft] {
        world.spawn((attachment.to(hand), ClothAttachmentOf(cloth)));
    }
    let targets = ClothMotionTargets::in_space(ClothTargetSpace::World);
    let limits = ClothMotionConstraints::at_most(0.2).with_backstop(0.1, 1.0);
    world
        .entity_mut(cloth)
        .insert((limits, targets, ClothPinForces::default()));
    let rest = world
        .get::<Cloth>(cloth)
        .map(Cloth::rest_positions)
        .unwrap_or_default();
    let mut time = 0.0;
    held.sim.app.add_systems(
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

    for (substeps, solver) in [
        (1, ClothSolver::Chains),
        (16, ClothSolver::Chains),
        (4, ClothSolver::GaussSeidel),
    ] {
        let mut among = among_colliders(substeps);
        among.insert(solver);
        let with = allocations(&mut among);
        println!("among colliders, {substeps} substeps of {solver:?}: {with}");
        let pushed = among.sim.resource::<ClothReactions>().iter().count();
        assert!(pushed > 5, "{pushed} bodies are pushed");
        assert!(
            with < with_a_system + u64::from(STEPS),
            "among colliders, {substeps} substeps of {solver:?}: {with}, not {with_a_system}"
        );
    }
}

/// Every kind of collider, each once that stands and once that moves about.
fn kinds() -> Vec<ClothCollider> {
    let ball = ClothColliderShape::Sphere { radius: 0.1 };
    let capsule = ClothColliderShape::Capsule {
        radius: 0.05,
        half_length: 0.1,
    };
    let aside = Isometry3d::new(Vec3::X * 0.1, Quat::from_rotation_z(1.0));
    let corners: Vec<Vec3> = (0..8)
        .map(|k| 0.2 * Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) - 0.1)
        .collect();
    let wave = |k: u32| 0.02 * (k as f32).sin();
    let heights = (0..25).map(wave).collect();
    let hills =
        |k: u32| Vec3::new((k % 9) as f32 - 4.0, wave(k) * 20.0, (k / 9) as f32 - 4.0) * 0.04;
    let cells = (0..72u32).filter(|k| k % 9 < 8);
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|k| [[k, k + 9, k + 1], [k + 1, k + 9, k + 10]])
        .collect();
    vec![
        ClothCollider::sphere(0.15),
        ClothCollider::capsule(0.1, 0.2),
        ClothCollider::tapered_capsule(0.1, 0.05, 0.2),
        ClothCollider::cuboid(0.3, 0.2, 0.3),
        ClothCollider::cylinder(0.1, 0.2),
        ClothCollider::convex_hull(&corners).expect("a cube"),
        ClothCollider::height_field(heights, 5, Vec2::splat(0.3)).expect("terrain"),
        ClothCollider::trimesh((0..81).map(hills).collect::<Vec<_>>(), triangles).expect("a mesh"),
        ClothCollider::compound([(aside, ball), (Isometry3d::IDENTITY, capsule)]).expect("two"),
    ]
}

/// A sheet that lies on the ground among colliders of every kind that turn and shake, and as many bodies.
fn among_colliders(substeps: u32) -> Sheet {
    let mut sheet = Sheet::new(&Scene {
        substeps: Some(substeps),
        resolution: UVec2::splat(40),
        ..Scene::default()
    });
    let up = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let world = sheet.sim.app.world_mut();
    let ground = Transform::from_xyz(0.0, 0.0, -0.4).with_rotation(up);
    world.spawn((ClothCollider::half_space(), ground));
    let place = |k: usize| {
        let (column, row) = (k % 5, k / 5);
        Vec3::new(0.4 * column as f32 - 0.8, 0.4 * row as f32 - 0.8, -0.3)
    };
    let mut moving = Vec::new();
    for (k, collider) in kinds().into_iter().enumerate() {
        let at = Transform::from_translation(place(k)).with_rotation(up);
        world.spawn((collider.clone(), at));
        moving.push(
            world
                .spawn((
                    collider,
                    Transform::from_translation(place(k + 9)).with_rotation(up),
                ))
                .id(),
        );
    }
    // More than a sort does without memory.
    let bodies: Vec<_> = (0..40).map(|_| world.spawn_empty().id()).collect();
    let shapes: Vec<_> = kinds().into_iter().map(|kind| kind.shape).collect();
    let mut time = 0.0f32;
    sheet.sim.app.add_systems(
        FixedUpdate,
        move |mut places: Query<&mut Transform>, mut colliders: ResMut<ClothExternalColliders>| {
            time += 1.0 / 60.0;
            for (k, entity) in moving.iter().enumerate() {
                if let Ok(mut at) = places.get_mut(*entity) {
                    at.translation = place(k + 9) + 0.03 * (7.0 * time).sin();
                    at.rotation = up * Quat::from_rotation_y(3.0 * time);
                }
            }
            for (k, body) in bodies.iter().enumerate() {
                let at = |time: f32| {
                    let shake = 0.02 * (5.0 * time + k as f32).sin();
                    Isometry3d::new(0.9 * place(k % 25) + Vec3::new(0.1, 0.1, shake), up)
                };
                colliders.push(external(
                    *body,
                    shapes[k % shapes.len()].clone(),
                    [at(time - 1.0 / 60.0), at(time)],
                    Some(ClothColliderBody {
                        body: *body,
                        inv_mass: Vec3::splat(2.0),
                        inv_inertia: Mat3::IDENTITY * 100.0,
                        center_of_mass: at(time).translation.into(),
                        linear_velocity: Vec3::ZERO,
                        angular_velocity: Vec3::ZERO,
                    }),
                ));
            }
        },
    );
    sheet
}
