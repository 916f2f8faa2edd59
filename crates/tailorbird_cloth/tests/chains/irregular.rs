//! Cloths that are triangle meshes, in a whole app.

use std::time::Duration;

use bevy_app::{App, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use tailorbird_cloth::prelude::*;

use crate::test_meshes::{delaunay, grid, hash, shuffle};

/// An app with one cloth in a vacuum, built, in which each update is a step of a sixtieth of a second.
fn app(cloth: Cloth, pins: ClothPins) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        ClothPlugin::default(),
    ));
    let fixed = Time::<Fixed>::from_hz(60.0);
    let step = fixed.timestep();
    app.insert_resource(fixed)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .insert_resource(ClothWind::vacuum());
    let entity = app.world_mut().spawn((cloth, pins)).id();
    app.update();
    app.world_mut().run_schedule(bevy_app::FixedPostUpdate);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    (app, entity)
}

fn run(app: &mut App, steps: usize) {
    for _ in 0..steps {
        app.update();
    }
}

fn particles(app: &App, cloth: Entity) -> &ClothParticles {
    app.world().get(cloth).expect("part of a cloth")
}

fn topology(app: &App, cloth: Entity) -> &ClothTopology {
    app.world().get(cloth).expect("part of a cloth")
}

const SIDE: usize = 24;

/// A horizontal sheet of side 1, cut at random, in random order.
fn shuffled() -> Cloth {
    let spacing = [1.0 / (SIDE - 1) as f32; 2];
    let (positions, triangles) = grid(SIDE, SIDE, spacing, |c, r| {
        hash(c + 1000 * r, 3).is_multiple_of(2)
    });
    let (positions, triangles) = shuffle(&positions, &triangles, 11);
    Cloth::mesh(positions, triangles.concat())
}

fn upper_corners() -> ClothPins {
    let within = |center| {
        ClothPin::new(ClothSelection::Within {
            center,
            radius: 1e-3,
        })
    };
    ClothPins::default()
        .with(within(Vec3::ZERO))
        .with(within(Vec3::X))
}

/// Pulls the lower edge towards the viewer, so that the sheet swings.
fn push(app: &mut App, cloth: Entity, which: impl Fn(Vec3) -> bool) {
    let rest = app
        .world()
        .get::<Cloth>(cloth)
        .expect("a cloth")
        .rest_positions();
    let mut forces = app
        .world_mut()
        .get_mut::<ClothForces>(cloth)
        .expect("part of a cloth");
    for (i, p) in rest.into_iter().enumerate() {
        if which(p) {
            forces.add_acceleration(i as u32, Vec3::Z * 300.0);
        }
    }
}

#[test]
fn a_shuffled_sheet_moves_as_the_grid_that_it_is() {
    let sheet = Cloth::grid(Vec2::ONE, UVec2::splat(SIDE as u32));
    let (mut a, of_a) = app(sheet, ClothPins::corners(ClothCorner::TOP));
    let (mut b, of_b) = app(shuffled(), upper_corners());
    assert!(topology(&b, of_b).lattice().is_some());
    assert!(topology(&b, of_b).grid().is_none());
    for (app, cloth) in [(&mut a, of_a), (&mut b, of_b)] {
        push(app, cloth, |p| p.y < -0.99);
        run(app, 60);
    }
    let rest = a.world().get::<Cloth>(of_a).expect("a").rest_positions();
    let other = b.world().get::<Cloth>(of_b).expect("b").rest_positions();
    let mut furthest = 0.0f32;
    for (i, p) in rest.iter().enumerate() {
        let (j, _) = other
            .iter()
            .enumerate()
            .min_by(|x, y| x.1.distance(*p).total_cmp(&y.1.distance(*p)))
            .expect("not empty");
        let [x, y] = [
            particles(&a, of_a).position(i),
            particles(&b, of_b).position(j),
        ];
        furthest = furthest.max(x.distance(y));
    }
    // Their rest lengths differ by rounding, which grows in the fall: an eighth of the spacing at most.
    assert!(furthest < 5e-3, "{furthest} m");
    let moved = particles(&a, of_a).position(SIDE * (SIDE - 1)).z.abs();
    assert!(moved > 1e-3, "{moved} m");
    let [x, y] = [
        particles(&a, of_a).stretch(topology(&a, of_a)),
        particles(&b, of_b).stretch(topology(&b, of_b)),
    ];
    assert!((x.mean - y.mean).abs() < 1e-5, "{x:?} {y:?}");
}

#[test]
fn users_keep_their_numbers() {
    for cloth in [shuffled(), irregular()] {
        let rest = cloth.rest_positions();
        let pinned = [5u32, 77, 300];
        let (mut app, cloth) = app(cloth, ClothPins::particles(pinned));
        let at_start: Vec<Vec3> = particles(&app, cloth).positions().collect();
        assert_eq!(at_start, rest);
        let found = particles(&app, cloth).pinned().collect::<Vec<_>>();
        assert_eq!(found, pinned.map(|i| i as usize));

        let pushed = 123usize;
        app.world_mut()
            .get_mut::<ClothForces>(cloth)
            .expect("part of a cloth")
            .add_acceleration(pushed as u32, Vec3::Z * 50.0);
        run(&mut app, 1);
        let particles = particles(&app, cloth);
        let fastest = (0..particles.len())
            .max_by(|&i, &j| {
                let speed = |i| particles.velocity(i).z.abs();
                speed(i).total_cmp(&speed(j))
            })
            .expect("not empty");
        assert_eq!(fastest, pushed);
        for i in pinned {
            assert!(particles.is_pinned(i as usize));
            assert_eq!(particles.position(i as usize), rest[i as usize]);
        }
        assert_eq!(particles.closest_particle(rest[77]).map(|c| c.0), Some(77));
        let stored = |vertex: usize| topology(&app, cloth).particle_of_vertex(vertex) as usize;
        for vertex in [0, 9, 250] {
            let drawn = particles.interpolated(stored(vertex), 1.0);
            assert_eq!(drawn, particles.position(vertex));
        }
    }
}

/// A square of side 1 with upper corners at (0, 0) and (1, 0).
fn irregular() -> Cloth {
    let (positions, triangles) = delaunay(SIDE, 5);
    let positions: Vec<Vec3> = positions.iter().map(|p| *p - Vec3::Y).collect();
    let (positions, triangles) = shuffle(&positions, &triangles, 2);
    Cloth::mesh(positions, triangles.concat())
}

#[test]
fn an_irregular_sheet_hangs_without_stretching() {
    let (mut app, cloth) = app(irregular(), upper_corners());
    assert!(topology(&app, cloth).fabric().is_some());
    push(&mut app, cloth, |p| p.y < -0.9);
    let mut worst = ClothStretch::default();
    for _ in 0..180 {
        run(&mut app, 1);
        let stretch = particles(&app, cloth).stretch(topology(&app, cloth));
        worst.mean = worst.mean.max(stretch.mean);
        worst.p99 = worst.p99.max(stretch.p99);
    }
    let end = particles(&app, cloth).stretch(topology(&app, cloth));
    assert!(
        end.mean < 0.005 && end.p99 < 0.03,
        "{end:?}, worst {worst:?}"
    );
    let lowest = particles(&app, cloth)
        .positions()
        .map(|p| p.y)
        .fold(0.0, f32::min);
    assert!((-1.2..-0.8).contains(&lowest), "{lowest} m");
    let energy = particles(&app, cloth).kinetic_energy();
    assert!(energy < 0.2, "{energy} J");
}

#[test]
fn viscosity_keeps_the_momentum_of_a_free_mesh() {
    let (mut app, cloth) = app(irregular(), ClothPins::default());
    push(&mut app, cloth, |p| p.y < -0.9);
    app.world_mut()
        .get_mut::<ClothMaterial>(cloth)
        .expect("part of a cloth")
        .damping = 0.0;
    app.world_mut().resource_mut::<ClothSettings>().gravity = Vec3::ZERO;
    run(&mut app, 1);
    let before = particles(&app, cloth).momentum();
    run(&mut app, 30);
    let after = particles(&app, cloth).momentum();
    assert!(before.z > 1e-3);
    assert!(
        after.distance(before) < 0.01 * before.length(),
        "{before} {after}"
    );
}

#[test]
fn what_is_no_surface_stays_finite() {
    // Three fins on one edge, a bow tie, a sliver, a vertex that nothing uses.
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.5, -1.0, 0.0],
        [0.5, 1.0, 0.0],
        [0.5, 0.0, 1.0],
        [2.0, -1.0, 0.0],
        [2.0, 1.0, 0.0],
        [0.5, -1.004, 0.0],
        [5.0, 5.0, 5.0],
    ]
    .map(Vec3::from_array);
    let indices = [0, 1, 2, 0, 1, 3, 0, 1, 4, 1, 5, 6, 0, 7, 2, 0, 1, 1];
    for pins in [ClothPins::default(), ClothPins::particles([0, 3])] {
        let (mut app, cloth) = app(Cloth::mesh(positions, indices), pins);
        run(&mut app, 60);
        let particles = particles(&app, cloth);
        assert_eq!(particles.len(), positions.len() - 1);
        assert!(
            particles
                .positions()
                .all(|p| p.is_finite() && p.length() < 50.0)
        );
        let status = app
            .world()
            .get::<ClothStatus>(cloth)
            .expect("part of a cloth");
        let errors: Vec<String> = status.errors().map(ToString::to_string).collect();
        assert_eq!(errors.len(), 1, "{errors:?}");
    }
}

#[test]
fn a_rolled_sheet_keeps_its_shape_in_free_flight() {
    let n = 13;
    let (flat, triangles) = grid(n, n, [0.1, 0.1], |c, r| (c + r) % 2 == 0);
    let roll = |p: &Vec3| {
        let (sin, cos) = (p.x * 2.0).sin_cos();
        Vec3::new(0.5 * sin, p.y, 0.5 * cos)
    };
    let positions: Vec<Vec3> = flat.iter().map(roll).collect();
    let (mut app, cloth) = app(
        Cloth::mesh(positions.clone(), triangles.concat()),
        ClothPins::default(),
    );
    assert!(topology(&app, cloth).lattice().is_some());
    assert!(!topology(&app, cloth).flat);
    app.world_mut().resource_mut::<ClothSettings>().gravity = Vec3::ZERO;
    run(&mut app, 60);
    for (i, p) in positions.iter().enumerate() {
        let moved = particles(&app, cloth).position(i).distance(*p);
        assert!(moved < 1e-3, "{i}: {moved} m");
    }
}
