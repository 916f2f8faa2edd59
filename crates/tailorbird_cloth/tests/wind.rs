//! Zones of wind and turbulence.

#![cfg(test)]

use std::f32::consts::FRAC_PI_2;

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use proptest::prelude::*;
use tailorbird_cloth::{prelude::*, wind::ClothWindState};
use tailorbird_test::{Scene, Sheet};

/// A free sheet in still air, without gravity, as wide as it is high, in the plane z = 0 around the origin.
fn sheet(hz: f64) -> Sheet {
    Sheet::new(&Scene {
        size: Vec2::ONE,
        resolution: UVec2::splat(17),
        gravity: Vec3::ZERO,
        wind: ClothWind::default(),
        sleep: ClothSleep::default(),
        hz,
        ..Scene::default()
    })
}

fn blow(sheet: &mut Sheet, zone: ClothWindZone, at: Transform) -> Entity {
    sheet.sim.spawn((zone, at))
}

fn air(sheet: &Sheet, point: Vec3) -> Vec3 {
    sheet.sim.resource::<ClothWindState>().velocity_at(point)
}

/// Mean velocity of the particles whose x is on the given side of 0.
fn mean(sheet: &Sheet, right: bool) -> Vec3 {
    let particles = sheet.particles();
    let ours: Vec<usize> = (0..particles.len())
        .filter(|i| (particles.position(*i).x > 0.0) == right)
        .collect();
    ours.iter().map(|i| particles.velocity(*i)).sum::<Vec3>() / ours.len() as f32
}

fn swirling(speed: f32, seed: u32) -> ClothTurbulence {
    ClothTurbulence {
        speed,
        scale: 1.5,
        seed,
    }
}

#[test]
fn air_moves_in_the_zone_and_nowhere_else() {
    let mut sheet = sheet(60.0);
    // Its border is the plane x = 0.
    let zone = ClothWindZone::cuboid(Vec3::splat(4.0), Vec3::Z * 5.0);
    blow(&mut sheet, zone, Transform::from_xyz(2.0, 0.0, 0.0));
    sheet.step();
    assert_eq!(air(&sheet, Vec3::new(0.1, 0.5, 0.0)), Vec3::Z * 5.0);
    assert_eq!(air(&sheet, Vec3::new(-0.1, 0.5, 0.0)), Vec3::ZERO);
    let (left, right) = (mean(&sheet, false), mean(&sheet, true));
    assert!(right.z > 0.5 && left.z < 0.2 * right.z, "{left} {right}");
}

#[test]
fn the_border_of_a_zone_is_as_wide_as_it_is_told() {
    let mut sheet = sheet(60.0);
    let zone = ClothWindZone {
        falloff: 0.5,
        ..ClothWindZone::sphere(2.0, Vec3::X * 4.0)
    };
    blow(&mut sheet, zone, Transform::from_xyz(0.0, 0.0, 10.0));
    sheet.step();
    let speed = |distance: f32| air(&sheet, Vec3::new(0.0, distance, 10.0)).x;
    assert_eq!(speed(0.0), 4.0);
    assert_eq!(speed(1.5), 4.0);
    assert!((speed(1.75) - 2.0).abs() < 1e-4, "{}", speed(1.75));
    assert_eq!(speed(2.0), 0.0);
    assert_eq!(speed(3.0), 0.0);
    let steps = (0..100).map(|k| 1.5 + 0.005 * k as f32);
    for distance in steps {
        let change = speed(distance) - speed(distance + 0.005);
        assert!(
            (0.0..0.07).contains(&change),
            "{change} m/s at {distance} m"
        );
    }
}

#[test]
fn a_zone_turns_moves_and_grows_with_its_entity() {
    let mut sheet = sheet(60.0);
    let zone = ClothWindZone::cuboid(Vec3::new(1.0, 1.0, 4.0), Vec3::Z * 3.0);
    let at = Transform::from_xyz(10.0, 0.0, 0.0);
    let entity = blow(&mut sheet, zone, at);
    sheet.step();
    assert_eq!(air(&sheet, Vec3::new(10.0, 0.0, 1.9)), Vec3::Z * 3.0);
    let mut place = |at: Transform| {
        sheet.sim.move_to(entity, at);
        sheet.step();
        [
            Vec3::new(10.0, 0.0, 1.9),
            Vec3::new(11.9, 0.0, 0.0),
            Vec3::new(15.0, 0.0, 0.0),
        ]
        .map(|point| air(&sheet, point))
    };
    let mut turned = at;
    turned.rotate_y(FRAC_PI_2);
    let [before, beside, _] = place(turned);
    assert_eq!(before, Vec3::ZERO);
    assert!(beside.abs_diff_eq(Vec3::X * 3.0, 1e-5), "{beside}");
    assert_eq!(place(Transform::from_xyz(15.0, 0.0, 0.0))[2], Vec3::Z * 3.0);
    assert_eq!(place(at.with_scale(Vec3::splat(12.0)))[2], Vec3::Z * 3.0);
}

#[test]
fn zones_add_up_and_go_when_they_are_despawned() {
    let mut sheet = sheet(60.0);
    sheet.sim.app.insert_resource(ClothWind::steady(Vec3::X));
    let zone = blow(
        &mut sheet,
        ClothWindZone::sphere(1e4, Vec3::Y),
        Transform::default(),
    );
    blow(
        &mut sheet,
        ClothWindZone::sphere(1.0, Vec3::Z),
        Transform::default(),
    );
    sheet.step();
    assert_eq!(air(&sheet, Vec3::ZERO), Vec3::ONE);
    assert_eq!(air(&sheet, Vec3::Y * 2.0), Vec3::new(1.0, 1.0, 0.0));
    sheet.sim.despawn(zone);
    sheet.step();
    assert_eq!(air(&sheet, Vec3::ZERO), Vec3::new(1.0, 0.0, 1.0));
}

#[test]
fn a_sheet_drifts_with_a_steady_wind_that_is_in_a_zone_as_with_one_that_is_not() {
    let drift = |zone: Option<ClothWindZone>, wind: Vec3| {
        let mut sheet = sheet(60.0);
        sheet.sim.app.insert_resource(ClothWind::steady(wind));
        if let Some(zone) = zone {
            blow(&mut sheet, zone, Transform::default());
        }
        sheet.steps(30);
        sheet.particles().positions().collect::<Vec<_>>()
    };
    let wind = Vec3::new(1.0, 0.5, 3.0);
    let global = drift(None, wind);
    assert_eq!(
        global,
        drift(Some(ClothWindZone::sphere(1e4, wind)), Vec3::ZERO)
    );
    // Not whole: the way of places that differ.
    let cut = ClothWindZone {
        falloff: 1e-3,
        ..ClothWindZone::sphere(3.0, wind)
    };
    let far = drift(Some(cut), Vec3::ZERO);
    let differ = ClothWindZone {
        turbulence: swirling(1e-6, 1),
        ..ClothWindZone::sphere(1e4, wind)
    };
    let swirling = drift(Some(differ), Vec3::ZERO);
    for ((a, b), c) in global.iter().zip(&far).zip(&swirling) {
        assert!(
            a.distance(*b) < 1e-3 && a.distance(*c) < 1e-3,
            "{a} {b} {c}"
        );
    }
}

#[test]
fn turbulence_is_as_fast_as_it_is_told_and_without_divergence() {
    let mut sheet = sheet(60.0);
    let zone = ClothWindZone {
        turbulence: swirling(2.0, 7),
        ..ClothWindZone::sphere(1e4, Vec3::ZERO)
    };
    blow(&mut sheet, zone, Transform::default());
    sheet.steps(50);
    let (mut squares, mut sum, mut count) = (0.0, Vec3::ZERO, 0.0);
    let h = 0.01;
    for k in 0..20_000_u32 {
        let at = |n: u32| (k.wrapping_mul(n) >> 8) as f32 / (1 << 24) as f32 * 60.0 - 30.0;
        let p = Vec3::new(at(2_654_435_761), at(2_246_822_519), at(3_266_489_917));
        let u = air(&sheet, p);
        squares += u.length_squared();
        sum += u;
        count += 1.0;
        let slope =
            |axis: Vec3| (air(&sheet, p + axis * h) - air(&sheet, p - axis * h)) / (2.0 * h);
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(slope);
        let divergence = x.x + y.y + z.z;
        let size = x.length() + y.length() + z.length();
        assert!(
            divergence.abs() < 0.02 * size.max(10.0),
            "{divergence} of {size}"
        );
    }
    let rms = f32::sqrt(squares / count);
    assert!((rms / 2.0 - 1.0).abs() < 0.005, "{rms} m/s");
    assert!(sum.length() / count < 0.003, "{}", sum / count);
}

#[test]
fn turbulence_depends_on_time_and_seed_alone_and_is_smooth() {
    let wind = |hz: f64, seed: u32| {
        let mut sheet = sheet(hz);
        sheet.sim.app.insert_resource(ClothWind {
            gusts: ClothGusts {
                strength: 0.5,
                period: 2.0,
            },
            turbulence: swirling(2.0, seed),
            ..ClothWind::steady(Vec3::X * 3.0)
        });
        // Of the step that starts after 3 s.
        sheet.steps(3 * hz as u32 + 1);
        air(&sheet, Vec3::new(0.3, 0.2, 0.1))
    };
    let slow = wind(60.0, 1);
    assert!(slow.distance(wind(120.0, 1)) < 1e-4);
    assert_eq!(slow, wind(60.0, 1));
    assert!(slow.distance(wind(60.0, 2)) > 0.1);

    let mut sheet = sheet(240.0);
    sheet.sim.app.insert_resource(ClothWind {
        turbulence: swirling(2.0, 3),
        ..ClothWind::steady(Vec3::X * 3.0)
    });
    sheet.step();
    let mut before = air(&sheet, Vec3::ZERO);
    for _ in 0..500 {
        sheet.step();
        let now = air(&sheet, Vec3::ZERO);
        // The smallest eddies, 0.1 m, pass in 30 ms.
        assert!(now.distance(before) < 0.8, "{}", now.distance(before));
        before = now;
    }
}

#[test]
fn what_sleeps_wakes_when_a_zone_comes_and_not_for_one_elsewhere() {
    let mut sheet = sheet(60.0);
    sheet.steps(120);
    assert!(sheet.get::<ClothSleepState>().is_asleep());
    let zone = ClothWindZone {
        turbulence: swirling(1.0, 0),
        ..ClothWindZone::sphere(1.0, Vec3::Z)
    };
    let entity = blow(&mut sheet, zone, Transform::from_xyz(5.0, 0.0, 0.0));
    sheet.steps(10);
    assert!(sheet.get::<ClothSleepState>().is_asleep());
    let mut place = sheet
        .sim
        .app
        .world_mut()
        .get_mut::<Transform>(entity)
        .unwrap();
    place.translation.x = 1.0;
    sheet.step();
    assert!(!sheet.get::<ClothSleepState>().is_asleep());
}

#[test]
fn a_wrong_zone_is_reported_and_blows_not() {
    let right = ClothWindZone::sphere(1.0, Vec3::X);
    let wrong = [
        (
            "ClothWindZone.velocity",
            ClothWindZone {
                velocity: Vec3::NAN,
                ..right
            },
        ),
        (
            "ClothWindZone.falloff",
            ClothWindZone {
                falloff: -1.0,
                ..right
            },
        ),
        (
            "ClothWindZone.shape.radius",
            ClothWindZone::sphere(0.0, Vec3::X),
        ),
        (
            "ClothWindZone.shape.size",
            ClothWindZone::cuboid(Vec3::new(1.0, -1.0, 1.0), Vec3::X),
        ),
        (
            "ClothWindZone.turbulence.scale",
            ClothWindZone {
                turbulence: ClothTurbulence {
                    scale: 0.0,
                    ..ClothTurbulence::default()
                },
                ..right
            },
        ),
        (
            "ClothWindZone.gusts.period",
            ClothWindZone {
                gusts: ClothGusts {
                    period: f32::NAN,
                    ..ClothGusts::default()
                },
                ..right
            },
        ),
    ];
    for (field, zone) in wrong {
        let mut sheet = sheet(60.0);
        let entity = blow(&mut sheet, zone, Transform::default());
        sheet.steps(3);
        let status = sheet.sim.app.world().get::<ClothStatus>(entity).unwrap();
        let said = status.errors().map(ToString::to_string).collect::<String>();
        assert!(said.contains(field), "{field}: {said}");
        assert_eq!(air(&sheet, Vec3::ZERO), Vec3::ZERO);
        // Mended, it blows.
        *sheet
            .sim
            .app
            .world_mut()
            .get_mut::<ClothWindZone>(entity)
            .unwrap() = right;
        sheet.step();
        assert_eq!(air(&sheet, Vec3::ZERO), Vec3::X);
        let status = sheet.sim.app.world().get::<ClothStatus>(entity).unwrap();
        assert_eq!(status.errors().count(), 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn nobody_gets_faster_than_the_fastest_air(
        speed in 0.0_f32..20.0,
        scale in 0.05_f32..10.0,
        seed: u32,
        radius in 0.05_f32..3.0,
        falloff in 0.0_f32..2.0,
        x in -2.0_f32..2.0,
        mean in 0.0_f32..20.0,
    ) {
        let mut sheet = sheet(60.0);
        let zone = ClothWindZone {
            falloff,
            turbulence: ClothTurbulence { speed, scale, seed },
            ..ClothWindZone::sphere(radius, Vec3::new(0.5, 0.2, 1.0).normalize() * mean)
        };
        blow(&mut sheet, zone, Transform::from_xyz(x, 0.0, 0.0));
        sheet.steps(40);
        let particles = sheet.particles();
        prop_assert!(particles.positions().all(Vec3::is_finite));
        // All waves at their crests.
        let most = mean + 6.0 * speed + 0.1;
        let fastest = (0..particles.len()).map(|i| particles.velocity(i).length()).fold(0.0, f32::max);
        prop_assert!(fastest < most, "{fastest} of {most}");
    }
}
