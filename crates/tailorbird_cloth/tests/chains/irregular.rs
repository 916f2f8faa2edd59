//! Cloths that are triangle meshes, in a whole app.

use bevy_math::{UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::{attachment::ClothAttachedParticles, prelude::*, topology::order::Given};
use tailorbird_test::{G, Scene, Sheet, Sim};

use crate::test_meshes::{delaunay, grid, hash, shuffle};

/// A cloth of cotton, as it is spawned by a game, in a vacuum.
fn sheet(cloth: Cloth, pins: ClothPins) -> Sheet {
    Sheet::new(&Scene {
        cloth: Some(cloth),
        material: ClothMaterial::default(),
        pins,
        gravity: Vec3::NEG_Y * G,
        sleep: ClothSleep::default(),
        ..Scene::default()
    })
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
fn push(sheet: &mut Sheet, which: impl Fn(Vec3) -> bool) {
    let rest = sheet.get::<Cloth>().rest_positions();
    sheet.change(|forces: &mut ClothForces| {
        for (i, p) in rest.into_iter().enumerate() {
            if which(p) {
                forces.add_acceleration(i as u32, Vec3::Z * 300.0);
            }
        }
    });
}

#[test]
fn a_shuffled_sheet_moves_as_the_grid_that_it_is() {
    let flat = Cloth::grid(Vec2::ONE, UVec2::splat(SIDE as u32));
    let mut a = sheet(flat, ClothPins::corners(ClothCorner::TOP));
    let mut b = sheet(shuffled(), upper_corners());
    assert!(b.get::<ClothTopology>().lattice().is_some());
    assert!(b.get::<ClothTopology>().grid().is_none());
    for sheet in [&mut a, &mut b] {
        push(sheet, |p| p.y < -0.99);
        sheet.steps(60);
    }
    let rest = a.get::<Cloth>().rest_positions();
    let other = b.get::<Cloth>().rest_positions();
    let mut furthest = 0.0f32;
    for (i, p) in rest.iter().enumerate() {
        let (j, _) = other
            .iter()
            .enumerate()
            .min_by(|x, y| x.1.distance(*p).total_cmp(&y.1.distance(*p)))
            .expect("not empty");
        let [x, y] = [a.particles().position(i), b.particles().position(j)];
        furthest = furthest.max(x.distance(y));
    }
    // Their rest lengths differ by rounding, which grows in the fall: an eighth of the spacing at most.
    assert!(furthest < 5e-3, "{furthest} m");
    let moved = a.particles().position(SIDE * (SIDE - 1)).z.abs();
    assert!(moved > 1e-3, "{moved} m");
    let [x, y] = [a.stretch(), b.stretch()];
    assert!((x.mean - y.mean).abs() < 3e-7, "{x:?} {y:?}");
}

#[test]
fn users_keep_their_numbers() {
    for cloth in [shuffled(), irregular()] {
        let rest = cloth.rest_positions();
        let pinned = [5u32, 77, 300];
        let mut sheet = sheet(cloth, ClothPins::particles(pinned));
        let at_start: Vec<Vec3> = sheet.particles().positions().collect();
        assert_eq!(at_start, rest);
        let found = sheet.particles().pinned().collect::<Vec<_>>();
        assert_eq!(found, pinned.map(|i| i as usize));

        let pushed = 123usize;
        sheet.change(|forces: &mut ClothForces| {
            forces.add_acceleration(pushed as u32, Vec3::Z * 50.0);
        });
        sheet.steps(1);
        let particles = sheet.particles();
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
        let stored = |vertex| sheet.get::<ClothTopology>().particle_of_vertex(vertex);
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
fn an_irregular_sheet_hangs_and_hardly_stretches() {
    let mut sheet = sheet(irregular(), upper_corners());
    assert!(sheet.get::<ClothTopology>().fabric().is_some());
    push(&mut sheet, |p| p.y < -0.9);
    let mut worst = ClothStretch::default();
    for _ in 0..180 {
        sheet.steps(1);
        let stretch = sheet.stretch();
        worst.mean = worst.mean.max(stretch.mean);
        worst.p99 = worst.p99.max(stretch.p99);
    }
    let end = sheet.stretch();
    assert!(
        end.mean < 0.003 && end.p99 < 0.018,
        "{end:?}, worst {worst:?}"
    );
    let lowest = sheet
        .particles()
        .positions()
        .map(|p| p.y)
        .fold(0.0, f32::min);
    assert!((-1.0..-0.95).contains(&lowest), "{lowest} m");
    let energy = sheet.particles().kinetic_energy();
    assert!(energy < 6e-4, "{energy} J");
}

#[test]
fn viscosity_keeps_the_momentum_of_a_free_mesh() {
    let mut sheet = sheet(irregular(), ClothPins::default());
    push(&mut sheet, |p| p.y < -0.9);
    sheet.change(|material: &mut ClothMaterial| material.damping = 0.0);
    sheet.settings(|settings| settings.gravity = Vec3::ZERO);
    sheet.steps(1);
    let before = sheet.particles().momentum();
    sheet.steps(30);
    let after = sheet.particles().momentum();
    assert!(before.z > 1e-3);
    assert!(
        after.distance(before) < 2e-4 * before.length(),
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
        let mut sheet = sheet(Cloth::mesh(positions, indices), pins);
        sheet.steps(60);
        let particles = sheet.particles();
        assert_eq!(particles.len(), positions.len() - 1);
        assert!(
            particles
                .positions()
                .all(|p| p.is_finite() && p.length() < 50.0)
        );
        let status = sheet.get::<ClothStatus>();
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
    let mut sheet = sheet(
        Cloth::mesh(positions.clone(), triangles.concat()),
        ClothPins::default(),
    );
    assert!(sheet.get::<ClothTopology>().lattice().is_some());
    assert!(!sheet.get::<ClothTopology>().flat);
    sheet.settings(|settings| settings.gravity = Vec3::ZERO);
    sheet.steps(60);
    for (i, p) in positions.iter().enumerate() {
        let moved = sheet.particles().position(i).distance(*p);
        assert!(moved < 1e-6, "{i}: {moved} m");
    }
}

/// Threads are found anew, in another order, where a scale is another along warp and weft.
#[test]
fn attached_particles_of_a_mesh_that_grows_keep_their_own_points() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn(irregular());
    let hand = sim.spawn(Transform::default());
    let band = ClothSelection::Within {
        center: Vec3::new(0.5, 0.0, 0.0),
        radius: 0.5,
    };
    sim.attach(cloth, hand, ClothAttachment::new(band));
    sim.steps(1);
    let order = |sim: &Sim| {
        let order = sim.particles(cloth).order().clone();
        (0..SIDE * SIDE).map(move |i| order.stored(Given(i as u32)))
    };
    let (before, order_before) = (sim.positions(cloth), order(&sim));
    let held: Vec<usize> = sim
        .get::<ClothAttachedParticles>(cloth)
        .rigid()
        .map(|point| point.particle as usize)
        .collect();
    let ratio = Vec3::new(1.0, 1.5, 1.0);
    sim.edit::<Transform>(cloth, |place| place.scale = ratio);
    sim.steps(1);
    assert!(!order_before.eq(order(&sim)), "threads in another order");
    let about = held.iter().map(|i| before[*i]).sum::<Vec3>() / held.len() as f32;
    for i in held {
        let expected = about + ratio * (before[i] - about);
        let at = sim.at(cloth, i);
        assert!(at.distance(expected) < 1e-5, "{i}: {at} {expected}");
    }
}
