//! Sheets that fall on things, and things that fly into sheets.

use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, rigid};

use crate::shapes::{self, Case};

fn falling(resolution: u32, speed: f32) -> (Sheet, f32) {
    let scene = Scene {
        size: Vec2::splat(1.6),
        resolution: UVec2::splat(resolution),
        ..Scene::default()
    };
    let thickness = rigid().thickness;
    let mut sheet = Sheet::new(&scene);
    if speed > 0.0 {
        // Within the first step.
        sheet.change(|forces: &mut ClothForces| {
            for i in 0..resolution * resolution {
                forces.add_acceleration(i, Vec3::NEG_Z * speed * 60.0);
            }
        });
    }
    (sheet, thickness)
}

/// The place of each particle relative to a collider.
fn around(sheet: &Sheet, at: Transform) -> Vec<Vec3> {
    let local = |p: Vec3| at.rotation.inverse() * (p - at.translation);
    sheet.world_positions().into_iter().map(local).collect()
}

fn lands_on(case: &Case, rotation: Quat, speed: f32, steps: u32) {
    let (mut sheet, thickness) = falling(33, speed);
    let at = Transform::from_xyz(0.0, 0.0, -0.9).with_rotation(rotation);
    sheet.sim.app.world_mut().spawn((case.collider.clone(), at));
    let name = case.name;
    let mut touched = false;
    for step in 0..steps {
        sheet.steps(1);
        for p in around(&sheet, at) {
            assert!(p.is_finite(), "{name}: {p} in step {step}");
            let distance = (case.distance)(p);
            assert!(
                distance > 0.002,
                "{name}: {distance} in step {step}, at {p}"
            );
            touched |= distance < 2.0 * thickness;
        }
    }
    assert!(touched, "{name} was not met");
    // It hangs on the shape, it did not fall past it.
    let below = around(&sheet, at)
        .iter()
        .filter(|p| (rotation * **p).z < -1.2)
        .count();
    assert_eq!(below, 0, "{name}: fell past");
}

#[test]
fn a_sheet_lands_on_every_shape_and_none_of_it_inside() {
    let tilted = Quat::from_euler(bevy_math::EulerRot::XYZ, 1.2, 0.3, 0.4);
    for case in shapes::all() {
        lands_on(&case, tilted, 0.0, 60);
    }
}

#[test]
fn a_sheet_at_20_metres_a_second_does_not_tunnel() {
    let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    for case in shapes::all() {
        lands_on(&case, upright, 20.0, 12);
    }
}

#[test]
fn a_thin_plate_at_20_metres_a_second_takes_the_sheet_along() {
    let mut sheet = Sheet::new(&Scene {
        resolution: UVec2::splat(33),
        gravity: Vec3::ZERO,
        ..Scene::default()
    });
    let corners: Vec<Vec3> = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        .map(|[x, y]| 0.3 * Vec3::new(x as f32, y as f32, 0.0))
        .to_vec();
    let open = ClothCollider::trimesh(corners, [[0, 1, 2], [0, 2, 3]]).expect("a square");
    for collider in [open, ClothCollider::cuboid(0.6, 0.6, 0.02)] {
        let mut z = -0.5f32;
        let plate = sheet
            .sim
            .spawn((collider, Transform::from_xyz(0.0, 0.0, z)));
        sheet.steps(1);
        for _ in 0..6 {
            z += 20.0 / 60.0;
            sheet.sim.move_to(plate, Transform::from_xyz(0.0, 0.0, z));
            sheet.steps(1);
        }
        let middle = 16 * 33 + 16;
        let particles = sheet.particles();
        let at = particles.position(middle).z;
        assert!(at > z, "the middle is at {at}, the plate at {z}");
        sheet.sim.despawn(plate);
        sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(33),
            gravity: Vec3::ZERO,
            ..Scene::default()
        });
    }
}

#[test]
fn terrain_carries_a_sheet_and_a_margin_lifts_it() {
    let height = |x: f32, z: f32| 0.1 * (3.0 * x).sin() * (2.0 * z).cos();
    let n = 41u32;
    let at = |k: u32| 4.0 * (k as f32 / (n - 1) as f32 - 0.5);
    let heights: Vec<f32> = (0..n * n).map(|k| height(at(k % n), at(k / n))).collect();
    let terrain = ClothCollider::height_field(heights, n, Vec2::splat(4.0)).expect("terrain");
    for margin in [0.0, 0.05] {
        let (mut sheet, thickness) = falling(33, 0.0);
        // Its y is up, which is the scene's z.
        let place = Transform::from_xyz(0.0, 0.0, -0.4)
            .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
        let terrain = terrain.clone().with_margin(margin);
        sheet.sim.app.world_mut().spawn((terrain, place));
        sheet.steps(120);
        let points = around(&sheet, place);
        let above = points.iter().map(|p| p.y - height(p.x, p.z));
        let lowest = above.clone().fold(f32::MAX, f32::min);
        let mean = above.sum::<f32>() / points.len() as f32;
        assert!(lowest > margin + 0.002, "{margin}: {lowest}");
        let wanted = margin + thickness;
        assert!(mean < wanted + 0.0015, "{margin}: {mean} above on average");
    }
}

#[test]
fn layers_keep_apart_what_does_not_want_to_meet() {
    let bottom = |cloth: ClothLayers, collider: ClothLayers| {
        let (mut sheet, _) = falling(9, 0.0);
        sheet.insert(cloth);
        let at = Transform::from_xyz(0.0, 0.0, -0.3);
        sheet
            .sim
            .app
            .world_mut()
            .spawn((ClothCollider::cuboid(4.0, 4.0, 0.2), at, collider));
        sheet.steps(60);
        let points = around(&sheet, Transform::IDENTITY);
        points.iter().map(|p| p.z).fold(f32::MAX, f32::min)
    };
    assert!(bottom(ClothLayers::ALL, ClothLayers::ALL) > -0.1951);
    assert!(bottom(ClothLayers::new(1, 2), ClothLayers::new(2, 1)) > -0.1951);
    assert!(bottom(ClothLayers::new(1, 2), ClothLayers::new(4, 1)) < -4.0);
    assert!(bottom(ClothLayers::new(1, 2), ClothLayers::new(2, 4)) < -4.0);
}

#[test]
fn scale_counts_along_the_axes_of_a_box_and_of_points() {
    let cube: Vec<Vec3> = (0..8)
        .map(|k| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) - 0.5)
        .collect();
    let hull = ClothCollider::convex_hull(&cube).expect("a cube");
    for collider in [ClothCollider::cuboid(1.0, 1.0, 1.0), hull] {
        let (mut sheet, thickness) = falling(17, 0.0);
        let at = Transform::from_xyz(0.0, 0.0, -0.5).with_scale(Vec3::new(4.0, 4.0, 0.4));
        sheet.sim.app.world_mut().spawn((collider, at));
        sheet.steps(90);
        for p in around(&sheet, Transform::IDENTITY) {
            assert!((p.z - (-0.3 + thickness)).abs() < 1e-5, "{p}");
        }
    }
}
