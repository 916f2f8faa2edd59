//! Garments that are put on: rings that are held altogether, and pins that stand elsewhere than where the cloth is at rest.

use std::f32::consts::{PI, TAU};

use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_transform::prelude::Transform;
use tailorbird_cloth::prelude::*;

use crate::world::{square, vacuum};

/// Particles around the skirt, and rows that are held.
const AROUND: u32 = 112;
const BAND: u32 = 3;

/// A cone below a waistband, all around.
fn skirt() -> Cloth {
    const ROWS: u32 = 38;
    const FLARE: f32 = 0.72;
    let at = |i: u32| {
        let (row, column) = (i / AROUND, i % AROUND);
        let down = if row < BAND {
            0.045 * (row as f32 / BAND as f32 - 1.0)
        } else {
            0.55 * (row - BAND) as f32 / (ROWS - 1 - BAND) as f32
        };
        let (sin, cos) = (TAU * column as f32 / AROUND as f32).sin_cos();
        let out = FLARE * down.max(0.0);
        let steep = (1.0 - FLARE * FLARE).sqrt();
        let y = down.min(0.0) + steep * down.max(0.0);
        Vec3::new((0.165 + out) * cos, -y, (0.125 + out) * sin)
    };
    let corners = (0..(ROWS - 1) * AROUND).flat_map(|i| {
        let (row, column) = (i / AROUND, i % AROUND);
        let corner = |r: u32, c: u32| (row + r) * AROUND + (column + c) % AROUND;
        let [a, b, c, d] = [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
        [a, b, d, a, d, c]
    });
    let vertices = (0..AROUND * ROWS).map(at).collect::<Vec<_>>();
    Cloth::mesh(vertices, corners.collect::<Vec<u32>>())
}

/// The cone stands by its rings until they fold; as chains that are cut somewhere they were 2.6 times as long there.
#[test]
fn a_skirt_has_no_seam_and_asks_for_nothing() {
    let mut world = vacuum();
    let skirt = world.spawn((
        skirt(),
        ClothMaterial::cotton(),
        ClothPins::particles(0..BAND * AROUND),
        Transform::default(),
    ));
    for step in 0..120 {
        world.steps(1);
        let stretch = world.stretch(skirt);
        let status = world.get::<ClothStatus>(skirt);
        assert!(status.is_ok() && status.strained() == 0.0, "{status:?}");
        assert!(stretch.max < 0.18, "step {step}: {stretch:?}");
        if step >= 30 {
            assert_eq!(status.stretched(), 0.0, "step {step}");
            assert!(stretch.max < 0.08, "step {step}: {stretch:?}");
        }
    }
}

/// A collar in pleats: half as wide as the cape's upper edge.
fn collar(columns: u32, turn: Quat) -> ClothPins {
    const HALF: Vec2 = Vec2::new(0.215, 0.155);
    let pins = (0..columns).map(|column| {
        let part = column as f32 / (columns - 1) as f32;
        let angle = 1.15 * PI * (part - 0.5);
        let out = 1.0 + 0.09 * (TAU * 9.0 * part).sin();
        let (sin, cos) = angle.sin_cos();
        let place = Vec3::new(-HALF.x * sin * out, 0.03 * cos, -HALF.y * cos * out);
        ClothPin::at(column, turn.inverse() * place)
    });
    ClothPins {
        pins: pins.collect(),
    }
}

/// Its upper edge is elsewhere at once. What that draws out comes back within a tenth of a second, and the few edges in the pleats that do not
/// have it slow nothing but themselves.
#[test]
fn a_cape_whose_collar_is_narrower_falls_as_it_would_without() {
    let lying = Quat::from_rotation_x(1.2);
    let lying_sideways = Quat::from_rotation_z(0.5 * PI);
    let mut world = vacuum();
    for (radius, length, place) in [
        (0.125, 0.22, Transform::from_xyz(0.0, -0.06, 0.0)),
        (
            0.075,
            0.24,
            Transform::from_xyz(0.0, 0.15, 0.0).with_rotation(lying_sideways),
        ),
    ] {
        world.spawn((ClothCollider::capsule(radius, length), place));
    }
    let (size, resolution) = (Vec2::new(1.1, 1.15), UVec2::new(122, 128));
    let cape = world.spawn((
        Cloth::grid(size, resolution).with_origin(Vec2::new(0.5, 0.0)),
        ClothMaterial::cotton(),
        collar(resolution.x, lying),
        Transform::from_xyz(0.0, 0.21, 0.0).with_rotation(lying),
    ));
    for step in 0..60 {
        world.steps(1);
        // What is so for a moment is not told.
        let strained = world.get::<ClothStatus>(cape).strained();
        assert_eq!(strained, 0.0, "step {step}");
        if step == 5 {
            let stretch = world.stretch(cape);
            assert!(stretch.mean < 0.02 && stretch.p99 < 0.09, "{stretch:?}");
        }
        if step == 32 {
            // A plate on a hinge would hang after 0.44 s.
            let all = world.positions(cape);
            let middle = all.iter().sum::<Vec3>() / all.len() as f32;
            assert!(middle.y < 0.21 - 0.8 * 0.5 * size.y, "{middle}");
        }
    }
}

/// Clips that are put a fifth farther apart: what waits for a change hears of it once, though the part is another one in each step.
#[test]
fn a_demand_is_told_when_it_begins() {
    let mut world = vacuum();
    let sheet = world.spawn((
        square(9),
        ClothPins::edges([ClothEdge::Left, ClothEdge::Right]),
    ));
    world.steps(1);
    let held = (0..81).filter(|i| i % 9 == 0 || i % 9 == 8);
    let pins: Vec<ClothPin> = held
        .map(|i| {
            let place = world.particles(sheet).position(i as usize);
            ClothPin::at(i, place * Vec3::new(1.2, 1.0, 1.0))
        })
        .collect();
    world.edit::<ClothPins>(sheet, |held| held.pins = pins.clone());
    let (mut told, mut changes) = (0, 0);
    for _ in 0..180 {
        let before = world.changed::<ClothStatus>(sheet);
        world.steps(1);
        changes += u32::from(world.changed::<ClothStatus>(sheet) != before);
        told += u32::from(world.get::<ClothStatus>(sheet).strained() > 0.3);
    }
    assert!(told > 60, "{told}");
    assert!((1..=3).contains(&changes), "{changes}");
}
