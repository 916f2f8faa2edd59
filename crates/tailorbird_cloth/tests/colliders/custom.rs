//! Solids of a game's own, through the systems of a substep.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3, Vec3Swizzles};
use tailorbird_cloth::{collider::find_contacts, prelude::*};
use tailorbird_test::{G, Scene, Sheet};

/// A solid: where a point is with respect to its surface.
#[derive(Resource, Clone, Copy)]
struct Own(fn(Vec3) -> SubstepContact);

fn approach(own: Res<Own>, mut cloths: SubstepCloths) {
    for mut cloth in cloths.iter_mut() {
        cloth.approach(|p| Some((own.0)(p)));
    }
}

fn collide(own: Res<Own>, mut cloths: SubstepCloths) {
    for mut cloth in cloths.iter_mut() {
        cloth.collide(|p| Some((own.0)(p)));
    }
}

fn with(scene: &Scene, own: fn(Vec3) -> SubstepContact) -> Sheet {
    let mut sheet = Sheet::new(scene);
    sheet.sim.app.insert_resource(Own(own)).add_systems(
        ClothSubstep,
        (
            approach
                .in_set(ClothSubstepSystems::Approach)
                .after(find_contacts),
            collide.in_set(ClothSubstepSystems::Collide),
        ),
    );
    sheet
}

/// A torus about the z axis: radius of the ring, and of its tube \[m\].
const TORUS: [f32; 2] = [0.5, 0.2];

/// Its middle lies below the sheet \[m\].
const BELOW: f32 = 0.4;

fn torus(p: Vec3) -> SubstepContact {
    let p = p + Vec3::Z * BELOW;
    let ring = (p.xy().normalize_or(Vec2::X) * TORUS[0]).extend(0.0);
    let away = p - ring;
    let normal = away.normalize_or(Vec3::Z);
    SubstepContact::new(normal, TORUS[1] - away.length()).with_friction(0.5)
}

fn falling(size: f32) -> Scene {
    Scene {
        size: Vec2::splat(size),
        resolution: UVec2::splat(33),
        ..Scene::default()
    }
}

#[test]
fn a_sheet_that_falls_on_a_torus_stays_out_of_it_and_comes_to_rest() {
    let mut sheet = with(&falling(1.8), torus);
    let mut before = Vec::new();
    for step in 0..360 {
        sheet.steps(1);
        let now = sheet.world_positions();
        for p in &now {
            let depth = torus(*p).depth;
            assert!(depth < 5e-6, "{depth} m deep at {p} in step {step}");
        }
        before = now;
    }
    sheet.steps(1);
    let now = sheet.world_positions();
    let moved = now.iter().zip(&before).map(|(a, b)| a.distance(*b));
    let fastest = 60.0 * moved.fold(0.0, f32::max);
    assert!(fastest < 1.5e-4, "{fastest} m/s");
    let touching = now.iter().filter(|p| torus(**p).depth > -0.01).count();
    assert!(touching > 50, "{touching} particles touch it");
    // It sags into the hole and hangs over the outside.
    let lowest = now.iter().map(|p| p.z + BELOW).fold(f32::MAX, f32::min);
    assert!((-0.5..-0.4).contains(&lowest), "{lowest} m");
    let middle = now[33 * 16 + 16].z + BELOW;
    assert!((0.1..0.2).contains(&middle), "{middle} m");
}

/// A block that slides on a slope of a game's own stops where tan of its angle is below the friction, as on a half-space of this crate.
#[test]
fn friction_is_that_of_the_crates_own_solids() {
    fn slope<const MU: u32>(p: Vec3) -> SubstepContact {
        // Through (0, 0, −0.2), tilted by 0.3 rad about y.
        let normal = Vec3::new(0.3f32.sin(), 0.0, 0.3f32.cos());
        let height = normal.dot(p + Vec3::Z * 0.2) - 0.3;
        SubstepContact::new(normal, -height).with_friction(MU as f32 / 100.0)
    }
    let scene = Scene {
        size: Vec2::splat(0.4),
        resolution: UVec2::splat(9),
        material: ClothMaterial {
            friction: 1.0,
            damping: 0.0,
            ..ClothMaterial::leather()
        },
        ..Scene::default()
    };
    // The geometric mean with the material's 1: 0.05 and 0.6, where tan 0.3 = 0.31.
    let slides = |own: fn(Vec3) -> SubstepContact| {
        let mut sheet = with(&scene, own);
        let middle = |sheet: &Sheet| {
            let all = sheet.world_positions();
            all.iter().sum::<Vec3>() / all.len() as f32
        };
        sheet.steps(90);
        let start = middle(&sheet);
        sheet.steps(30);
        start.distance(middle(&sheet))
    };
    let smooth = slides(slope::<0>);
    // From rest after 1.5 s: (sin 0.3) g (1.5 · 0.5 + 0.5²/2) and less, as it fell on the slope at first.
    let free = 0.3f32.sin() * G * (1.5 * 0.5 + 0.125);
    assert!(
        (0.5 * free..1.1 * free).contains(&smooth),
        "{smooth} of {free} m"
    );
    let rough = slides(slope::<36>);
    assert!(rough < 1e-4, "{rough} m");
}

/// A moving surface takes along the cloth that lies on it.
#[test]
fn a_surface_that_moves_takes_cloth_along() {
    const SPEED: f32 = 0.5;
    fn belt(p: Vec3) -> SubstepContact {
        SubstepContact::new(Vec3::Z, -0.05 - p.z)
            .with_friction(1.0)
            .moving(Vec3::X * (SPEED / 60.0 / 8.0))
    }
    let scene = Scene {
        substeps: Some(8),
        material: ClothMaterial {
            friction: 1.0,
            damping: 0.0,
            ..ClothMaterial::cotton()
        },
        ..falling(0.5)
    };
    let mut sheet = with(&scene, belt);
    sheet.steps(90);
    let start = sheet.world_positions();
    sheet.steps(60);
    for (from, to) in start.iter().zip(sheet.world_positions()) {
        let displacement = to - *from;
        assert!(
            (displacement.x - SPEED).abs() < 1e-4 && displacement.y.abs() < 1e-4,
            "{displacement}"
        );
    }
}

#[test]
fn particles_that_are_held_and_places_that_are_none_stay() {
    #[derive(Resource, Default)]
    struct Moved(Vec<(usize, bool, bool)>);
    let mut sheet = Sheet::new(&Scene::hang(UVec2::splat(5)));
    sheet.sim.app.init_resource::<Moved>().add_systems(
        ClothSubstep,
        |mut moved: ResMut<Moved>, mut cloths: SubstepCloths| {
            for mut cloth in cloths.iter_mut() {
                for i in 0..cloth.len() {
                    let at = cloth.position(i);
                    let nowhere = cloth.set_position(i, Vec3::NAN);
                    let there = cloth.set_position(i, at);
                    assert_eq!(cloth.is_held(i), !there);
                    moved.0.push((i, nowhere, there));
                }
            }
        },
    );
    sheet.steps(2);
    let moved = &sheet.sim.resource::<Moved>().0;
    assert!(moved.len() >= 50);
    for (i, nowhere, there) in moved {
        assert!(!nowhere);
        assert_eq!(*there, *i != 0 && *i != 4, "{i}");
    }
    assert!(sheet.world_positions().iter().all(|p| p.is_finite()));
}

/// Moving position and previous position alike is a motion without speed.
#[test]
fn both_places_moved_alike_change_no_velocity() {
    let mut sheet = Sheet::new(&Scene {
        gravity: Vec3::ZERO,
        ..falling(1.0)
    });
    sheet.steps(1);
    sheet
        .sim
        .app
        .add_systems(ClothSubstep, |mut cloths: SubstepCloths| {
            for mut cloth in cloths.iter_mut() {
                for i in 0..cloth.len() {
                    let (at, before) = (cloth.position(i), cloth.previous_position(i));
                    cloth.set_position(i, at + Vec3::X * 1e-3);
                    cloth.set_previous_position(i, before + Vec3::X * 1e-3);
                }
            }
        });
    sheet.steps(10);
    let entity = sheet.entity;
    let particles = sheet
        .sim
        .app
        .world()
        .get::<ClothParticles>(entity)
        .expect("particles");
    assert!(particles.position(0).x > -0.5 + 0.05);
    for i in 0..particles.len() {
        let speed = particles.velocity(i).length();
        assert!(speed < 1.2e-5, "{speed} m/s");
    }
}
