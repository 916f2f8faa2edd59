//! Distances where they are known, and properties that hold everywhere.

mod curved;
mod sheet;

use super::*;
use crate::properties::*;
use bevy_math::Vec2;
use sheet::{Sheet, Split};

const OVER: f32 = 0.02;
const UNDER: f32 = 0.001;
/// Relative error between the two directions of a path, and where fronts meet, on meshes whose triangles are up to ten times as long as
/// wide.
const SLIVERS: f32 = 0.1;

fn flat(p: Vec2) -> Vec3 {
    p.extend(0.0)
}

/// The least and greatest relative error over the particles whose exact distance is not 0.
fn errors(found: &[f32], exact: impl Fn(usize) -> f32) -> [f32; 2] {
    let mut range = [0.0f32; 2];
    for (i, &d) in found.iter().enumerate() {
        let e = exact(i);
        if e > 0.0 {
            let error = d / e - 1.0;
            assert!(!error.is_nan());
            range = [range[0].min(error), range[1].max(error)];
        }
    }
    range
}

fn check_range(name: &str, range: [f32; 2]) {
    let [low, high] = range.map(|e| 100.0 * e);
    println!("{name}: {low:.4} % to {high:.4} %");
    assert!(range[0] >= -UNDER && range[1] <= OVER, "{name}: {range:?}");
}

fn check(name: &str, found: &[f32], exact: impl Fn(usize) -> f32) {
    check_range(name, errors(found, exact));
}

fn check_flat(name: &str, sheet: &Sheet) {
    let mesh = Geodesics::new(&sheet.positions(flat), &sheet.triangles);
    let particles = sheet.flat.len() as u32;
    let mut range = [0.0f32; 2];
    let places = [
        0,
        particles / 2 + sheet.columns / 2,
        sheet.columns / 3,
        particles - 1,
    ];
    for source in places {
        let p = sheet.flat[source as usize];
        let one = errors(&mesh.distances(&[source]), |i| p.distance(sheet.flat[i]));
        range = [range[0].min(one[0]), range[1].max(one[1])];
    }
    check_range(name, range);
}

#[test]
fn flat_sheets_are_measured_exactly() {
    use Split::*;
    for cell in [(1.0, 1.0), (1.0, 0.5), (0.3, 1.0), (1.0, 0.1)].map(Vec2::from) {
        for (split, jitter) in [
            (Same, 0.0),
            (Alternating, 0.0),
            (Same, 0.2),
            (Shorter, 0.3),
            (Random, 0.2),
            (Longer, 0.2),
        ] {
            for n in [6, 20, 100] {
                let sheet = Sheet::new(n, n, split, jitter, n, cell);
                check_flat(&format!("flat {split:?} {jitter} {n} {cell}"), &sheet);
            }
        }
    }
}

/// The length of the shortest path between two points of the plane around a box.
fn around_box(p: Vec2, q: Vec2, low: Vec2, high: Vec2) -> f32 {
    let corners = [
        low,
        Vec2::new(high.x, low.y),
        high,
        Vec2::new(low.x, high.y),
    ];
    let blocked = |p: Vec2, q: Vec2| {
        let [mut from, mut to] = [0.0f32, 1.0f32];
        for k in 0..2 {
            let (d, o) = (q[k] - p[k], p[k]);
            let [l, h] = [low[k] + 1e-3, high[k] - 1e-3];
            if d.abs() < 1e-6 {
                if o <= l || o >= h {
                    return false;
                }
            } else {
                let [s, t] = [(l - o) / d, (h - o) / d];
                from = from.max(s.min(t));
                to = to.min(s.max(t));
            }
        }
        from < to
    };
    if !blocked(p, q) {
        return p.distance(q);
    }
    let mut best = f32::INFINITY;
    for first in 0..4 {
        for step in [1, 3] {
            let mut length = 0.0;
            let mut at = p;
            for n in 0..3 {
                let corner = corners[(first + n * step) % 4];
                if blocked(at, corner) {
                    break;
                }
                length += at.distance(corner);
                at = corner;
                if !blocked(at, q) {
                    best = best.min(length + at.distance(q));
                    break;
                }
            }
        }
    }
    best
}

#[test]
fn paths_go_around_a_hole() {
    use Split::*;
    for split in [Same, Alternating, Random] {
        for n in [20, 100] {
            let [low, high] = [0.3, 0.6].map(|f| (Vec2::new(f, f * 0.9) * n as f32).round());
            let outside = |p: Vec2| (p - p.clamp(low, high)).length() > 0.0;
            let sheet = Sheet::new(n, n, split, 0.0, 5, Vec2::ONE).keep(outside);
            let mesh = Geodesics::new(&sheet.positions(flat), &sheet.triangles);
            for source in [0, (n + 1) * (n / 2) + n / 10, n / 2] {
                let p = sheet.flat[source as usize];
                let found = mesh.distances(&[source]);
                check(&format!("hole {split:?} {n} {source}"), &found, |i| {
                    if found[i].is_finite() {
                        around_box(p, sheet.flat[i], low, high)
                    } else {
                        0.0
                    }
                });
            }
        }
    }
}

#[test]
fn each_particle_belongs_to_the_nearest_source() {
    let sheet = Sheet::new(80, 80, Split::Shorter, 0.3, 9, Vec2::ONE);
    let mesh = Geodesics::new(&sheet.positions(flat), &sheet.triangles);
    let sources = [3, 2000, 6000, 3, 6400];
    let to = |k: usize, i: usize| sheet.flat[sources[k] as usize].distance(sheet.flat[i]);
    let (found, which) = mesh.nearest(&sources);
    check("sources", &found, |i| {
        (0..5).map(|k| to(k, i)).fold(f32::INFINITY, f32::min)
    });
    for (i, &k) in which.iter().enumerate() {
        assert!(to(k as usize, i) <= found[i] * (1.0 + UNDER) && k != 3);
    }
}

#[test]
fn what_cannot_be_reached_is_infinitely_far() {
    let positions = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::X * 2.0,
        Vec3::Y,
        Vec3::Z,
        Vec3::NAN,
        Vec3::ZERO,
    ];
    let triangles = [[0, 1, 2], [0, 0, 3], [1, 2, 9], [5, 1, 2], [0, 6, 1]];
    let mesh = Geodesics::new(&positions, &triangles);
    assert_eq!(mesh.distances(&[]), [f32::INFINITY; 7]);
    assert_eq!(mesh.distances(&[99]), [f32::INFINITY; 7]);
    let (found, which) = mesh.nearest(&[99, 0]);
    let far = f32::INFINITY;
    assert_eq!(found, [0.0, 1.0, 2.0, far, far, far, 0.0]);
    assert_eq!(which, [1, 1, 1, NONE, NONE, NONE, 1]);
    assert!(Geodesics::new(&[], &[]).distances(&[0]).is_empty());
}

#[test]
fn panels_sewn_back_to_front_are_measured() {
    let mut sheet = Sheet::new(40, 40, Split::Shorter, 0.3, 7, Vec2::ONE);
    for triangle in &mut sheet.triangles {
        if triangle.iter().all(|i| i % 41 < 20) {
            triangle.swap(0, 1);
        }
    }
    check_flat("panels", &sheet);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn distances_are_a_metric(
        seed in 0u32..1000,
        jitter in 0.0f32..0.3,
        bulge in 0.0f32..4.0,
        tall in 0.3f32..2.0,
        ends in prop::array::uniform2(0u32..625),
    ) {
        let sheet = Sheet::new(24, 24, Split::Random, jitter, seed, Vec2::new(1.0, tall))
            .keep(|p| (p / Vec2::new(1.0, tall)).distance(Vec2::new(9.0, 12.0)) > 4.0);
        let bulged = |p: Vec2| p.extend(bulge * (p.x * 0.3).sin() * (p.y * 0.2).cos());
        let positions = sheet.positions(bulged);
        let mesh = Geodesics::new(&positions, &sheet.triangles);
        let [from_a, from_b] = ends.map(|i| mesh.distances(&[i]));
        let [a, b] = ends.map(|i| i as usize);
        prop_assume!(from_a[b].is_finite());
        let ab = from_a[b];
        prop_assert!((from_b[a] - ab).abs() <= SLIVERS * ab, "{ab} there, {} back", from_b[a]);
        for (i, &p) in positions.iter().enumerate() {
            let [to_a, to_b] = [from_a[i], from_b[i]];
            prop_assert_eq!(to_a.is_finite(), to_b.is_finite());
            prop_assert!(to_a >= p.distance(positions[a]) * 0.9999);
            prop_assert!(!to_a.is_finite() || to_a <= (ab + to_b) * (1.0 + SLIVERS));
        }
        for &[i, j, k] in &sheet.triangles {
            for (i, j) in [(i, j), (j, k), (k, i)] {
                let edge = positions[i as usize].distance(positions[j as usize]);
                let [to_i, to_j] = [i, j].map(|i| from_a[i as usize]);
                prop_assert!(to_i == to_j || (to_i - to_j).abs() <= edge * 1.001);
            }
        }
        let (nearest, which) = mesh.nearest(&ends);
        for (i, &d) in nearest.iter().enumerate() {
            let least = from_a[i].min(from_b[i]);
            prop_assert!(d == least || (d / least - 1.0).abs() <= SLIVERS, "{d} not {least}");
            prop_assert_eq!(d.is_finite(), which[i] != NONE);
        }
    }
}

#[test]
fn anchors_lie_far_from_each_other() {
    let row: Vec<Vec3> = (0..11).map(|i| Vec3::X * i as f32).collect();
    let pins: Vec<u32> = (0..11).collect();
    assert_eq!(tether_anchors(&pins, &row, 4), [0, 10, 5, 2]);
    assert_eq!(tether_anchors(&[7, 3, 99], &row, 4), [7, 3]);
    assert!(tether_anchors(&[7, 3], &row, 0).is_empty());
    assert!(tether_anchors(&[], &row, 4).is_empty());
    assert_eq!(tether_anchors(&[4, 4, 4, 4, 4], &row, 4), [4]);
    let square = Sheet::new(8, 8, Split::Same, 0.0, 0, Vec2::ONE).positions(flat);
    let all: Vec<u32> = (0..81).collect();
    let mut corners = tether_anchors(&all, &square, 4);
    corners.sort();
    assert_eq!(corners, [0, 8, 72, 80]);
}
