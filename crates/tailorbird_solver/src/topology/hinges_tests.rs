use std::{
    collections::HashSet,
    f32::consts::{FRAC_PI_4, TAU},
};

use crate::properties::*;
use bevy_math::{Quat, Vec2};

use super::*;

/// Vertices and triangles of a square of side 1 with `n` × `n` cells; `flip` says which cells are cut along the
/// rising diagonal. Inner vertices are moved by up to `jitter` cells.
fn sheet(n: u32, jitter: f32, flip: impl Fn(u32, u32) -> bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let side = n + 1;
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let positions = (0..side * side)
        .map(|i| {
            let (column, row) = (i % side, i / side);
            let inner = column % n != 0 && row % n != 0;
            let moved = if inner { jitter } else { 0.0 } * Vec2::new(random(), random());
            ((Vec2::new(column as f32, row as f32) + moved) / n as f32).extend(0.0)
        })
        .collect();
    let triangles = (0..n * n)
        .flat_map(|cell| {
            let (column, row) = (cell % n, cell / n);
            let a = row * side + column;
            let (b, c, d) = (a + 1, a + side, a + side + 1);
            if flip(column, row) {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, b, d], [a, d, c]]
            }
        })
        .collect();
    (positions, triangles)
}

/// Energy of a sheet rolled along the direction `angle` around a cylinder of `radius`, over what a developable surface of
/// its area has, for B = 1.
fn rolled(positions: &[Vec3], triangles: &[[u32; 3]], angle: f32, radius: f32) -> f32 {
    let hinges = HingeConstraints::new(triangles, positions);
    let along = Vec2::from_angle(angle);
    let onto = |p: Vec3| {
        let (u, v) = (p.truncate().dot(along), p.truncate().perp_dot(along));
        radius * Vec3::new((u / radius).sin(), v / radius, (u / radius).cos())
    };
    // Half of the area along the border belongs to no hinge: what counts is the share of the hinges.
    let (mut energy, mut area) = (0.0, 0.0);
    for (k, particles) in hinges.particles.iter().enumerate() {
        let corners = particles.map(|i| positions[i as usize]);
        let middle = corners.iter().sum::<Vec3>() / 4.0;
        if (middle - Vec3::new(0.5, 0.5, 0.0)).abs().max_element() > 0.3 {
            continue;
        }
        let [a, b, c, d] = corners;
        area += ((b - a).cross(c - a).length() + (b - a).cross(d - a).length()) / 6.0;
        energy += bending(&hinges, k, &corners.map(onto)).length_squared() / hinges.areas[k];
    }
    energy * radius * radius / area
}

fn bending(hinges: &HingeConstraints, k: usize, corners: &[Vec3; 4]) -> Vec3 {
    let [_, k1, k2, k3] = hinges.coefficients[k];
    let [x0, x1, x2, x3] = *corners;
    k1 * (x1 - x0) + k2 * (x2 - x0) + k3 * (x3 - x0)
}

#[test]
fn a_rolled_sheet_has_the_energy_of_its_rigidity() {
    let regular = sheet(40, 0.0, |_, _| false);
    let zigzag = sheet(40, 0.0, |_, row| row % 2 == 0);
    let alternating = sheet(40, 0.0, |column, row| (column + row) % 2 == 0);
    for angle in [0.0, 2.0 * FRAC_PI_4] {
        for (positions, triangles) in [&regular, &zigzag, &alternating] {
            let ratio = rolled(positions, triangles, angle, 2.0);
            assert!((ratio - 1.0).abs() < 0.03, "{angle}: {ratio}");
        }
    }
    for k in 0..8 {
        let angle = TAU * k as f32 / 8.0;
        let ratio = rolled(&alternating.0, &alternating.1, angle, 2.0);
        assert!((ratio - 1.0).abs() < 0.03, "{angle}: {ratio}");
    }
}

#[test]
fn an_irregular_sheet_is_about_as_stiff_in_every_direction() {
    let (positions, triangles) = sheet(40, 0.3, |column, row| (column * 7 + row * 13) % 5 < 2);
    for k in 0..8 {
        let angle = TAU * k as f32 / 8.0;
        let ratio = rolled(&positions, &triangles, angle, 2.0);
        assert!((0.85..1.25).contains(&ratio), "{angle}: {ratio}");
    }
}

#[test]
fn stretched_cells_with_alternating_diagonals_are_right_in_every_direction() {
    let (mut positions, triangles) = sheet(40, 0.0, |column, row| (column + row) % 2 == 0);
    for p in &mut positions {
        p.y = 0.5 + 2.0 * (p.y - 0.5);
    }
    for k in 0..8 {
        let angle = TAU * k as f32 / 8.0;
        let ratio = rolled(&positions, &triangles, angle, 4.0);
        assert!((ratio - 1.0).abs() < 0.05, "{angle}: {ratio}");
    }
}

#[test]
fn equilateral_triangles_are_right_in_every_direction() {
    let (mut positions, triangles) = sheet(40, 0.0, |_, _| true);
    for p in &mut positions {
        *p = Vec3::new(p.x + 0.5 * p.y - 0.25, 0.75f32.sqrt() * p.y, 0.0);
    }
    for k in 0..8 {
        let angle = TAU * k as f32 / 8.0;
        let ratio = rolled(&positions, &triangles, angle, 2.0);
        assert!((ratio - 1.0).abs() < 0.03, "{angle}: {ratio}");
    }
}

#[test]
fn every_inner_edge_is_a_hinge_and_batches_share_no_particle() {
    let n = 9;
    let (positions, triangles) = sheet(n, 0.2, |column, row| (column + row) % 3 == 0);
    let hinges = HingeConstraints::new(&triangles, &positions);
    assert_eq!(hinges.len() as u32, 2 * n * (n - 1) + n * n);
    let mut end = 0;
    for batch in &hinges.batches {
        assert_eq!(batch.range.start, end);
        end = batch.range.end;
        let particles = &hinges.particles[batch.range.clone()];
        let distinct: HashSet<u32> = particles.iter().flatten().copied().collect();
        assert_eq!(distinct.len(), 4 * particles.len());
        assert!(particles.is_sorted_by_key(|particles| particles.iter().min().copied()));
        assert!(batch.flat);
    }
    assert_eq!(end, hinges.len());
    assert!(hinges.batches.len() <= 20, "{}", hinges.batches.len());
}

#[test]
fn degenerate_triangles_borders_and_edges_of_three_triangles_have_no_hinges() {
    let positions = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::ONE,
        Vec3::X * 2.0,
        Vec3::NAN,
    ];
    let hinges = |triangles: &[[u32; 3]]| HingeConstraints::new(triangles, &positions).len();
    assert_eq!(hinges(&[]), 0);
    assert_eq!(hinges(&[[0, 1, 2]]), 0);
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 3]]), 1);
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 4]]), 0);
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 2]]), 0);
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 5]]), 0);
    assert_eq!(hinges(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), 0);
    assert_eq!(hinges(&[[0, 0, 1], [0, 0, 2]]), 0);
}

#[test]
fn a_fold_is_remembered_with_its_side() {
    for angle in [0.5f32, -0.5] {
        let (sin, cos) = angle.sin_cos();
        let positions = [Vec3::ZERO, Vec3::Y, Vec3::NEG_X, Vec3::new(cos, 0.0, sin)];
        let hinges = HingeConstraints::new(&[[0, 1, 2], [1, 0, 3]], &positions);
        assert!(!hinges.batches[0].flat);
        let expected = 2.0 * (0.5 * angle).sin().abs();
        assert!((hinges.rest_lengths[0].abs() - expected).abs() < 1e-6);
        assert_eq!(hinges.rest_lengths[0] < 0.0, angle < 0.0);
    }
}

proptest! {
    #[test]
    fn what_is_flat_stays_unbent_under_rigid_motion(
        left in (0.05f32..1.0, -1.0f32..1.0), right in (0.05f32..1.0, -1.0f32..1.0),
        axis in (-1.0f32..1.0, -1.0f32..1.0, 0.1f32..1.0), angle in 0.0f32..TAU, shift in -10.0f32..10.0,
    ) {
        let corners = [
            Vec3::ZERO,
            Vec3::Y,
            Vec3::new(-left.0, left.1, 0.0),
            Vec3::new(right.0, right.1, 0.0),
        ];
        let turn = Quat::from_axis_angle(Vec3::from(axis).normalize(), angle);
        let hinges = HingeConstraints::new(&[[0, 1, 2], [1, 0, 3]], &corners);
        for (k, particles) in hinges.particles.iter().enumerate() {
            let largest = hinges.coefficients[k].iter().fold(0.0f32, |most, c| most.max(c.abs()));
            let sum: f32 = hinges.coefficients[k].iter().sum();
            prop_assert!(sum.abs() <= 1e-6 * largest);
            prop_assert!(hinges.areas[k] > 0.0 && hinges.areas[k].is_finite());
            prop_assert_eq!(hinges.rest_lengths[k], 0.0);
            let moved = particles.map(|i| turn * corners[i as usize] + shift);
            let d = bending(&hinges, k, &moved);
            prop_assert!(d.length() < 3e-6 * largest * (1.0 + shift.abs()), "{d}");
        }
    }
}

#[test]
fn a_sheet_with_a_fin_bends_as_if_the_fin_were_not_there() {
    // A square of two triangles over its diagonal, and a third triangle that stands on that.
    let positions = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::Y,
        Vec3::new(0.5, 0.5, 1.0),
        Vec3::new(0.5, 0.5, -1.0),
    ];
    let (sheet, fin, other) = ([[0, 1, 2], [0, 2, 3]], [2, 0, 4], [0, 2, 5]);
    let alone = HingeConstraints::new(&sheet, &positions);
    for k in 0..3 {
        let mut triangles = sheet.to_vec();
        triangles.insert(k, fin);
        let hinges = HingeConstraints::new(&triangles, &positions);
        assert_eq!(hinges.particles, alone.particles);
        assert_eq!(hinges.coefficients, alone.coefficients);
    }
    // Two sheets that cross.
    let crossed = HingeConstraints::new(&[sheet[0], fin, sheet[1], other], &positions);
    assert_eq!(crossed.len(), 2);
    assert!(crossed.particles.contains(&[0, 2, 4, 5]));
}
