//! Sheets that are rolled, folded and bulged.

use std::collections::HashMap;

use super::*;

#[test]
fn a_rolled_sheet_is_measured_around_both_sides() {
    let columns = 40;
    let angle = 2.0 * PI / columns as f32;
    // Chords of unit length: the prism unrolls to the sheet.
    let radius = 0.5 / (angle / 2.0).sin();
    for (split, jitter) in [(Split::Same, 0.0), (Split::Alternating, 0.0)] {
        let mut sheet = Sheet::new(columns, 60, split, jitter, 1, Vec2::ONE);
        for i in sheet.triangles.as_flattened_mut() {
            *i -= if *i % sheet.columns == columns {
                columns
            } else {
                0
            };
        }
        let roll = |p: Vec2| {
            let (sin, cos) = (p.x * angle).sin_cos();
            Vec3::new(radius * cos, radius * sin, p.y)
        };
        let mesh = Geodesics::new(&sheet.positions(roll), &sheet.triangles);
        for source in [7, 30 * sheet.columns + 11] {
            let p = sheet.flat[source as usize];
            let found = mesh.distances(&[source]);
            let turn = columns as f32;
            check(&format!("cylinder {split:?}"), &found, |i| {
                let q = sheet.flat[i];
                let length = |x: f32| p.distance(Vec2::new(x, q.y));
                let exact = length(q.x).min(length(q.x - turn)).min(length(q.x + turn));
                if found[i].is_finite() { exact } else { 0.0 }
            });
        }
    }
}

#[test]
fn a_folded_sheet_keeps_its_distances() {
    for split in [Split::Same, Split::Alternating, Split::Random] {
        let sheet = Sheet::new(30, 30, split, 0.0, 3, Vec2::new(1.0, 0.7));
        let pleats = |p: Vec2| {
            let run = p.x.min(10.0) + (p.x - 20.0).max(0.0);
            Vec3::new(run, p.y, (p.x - 10.0).clamp(0.0, 10.0))
        };
        let mesh = Geodesics::new(&sheet.positions(pleats), &sheet.triangles);
        for source in [0, 31 * 15 + 4, 31 * 7 + 15] {
            let p = sheet.flat[source as usize];
            check(
                &format!("fold {split:?}"),
                &mesh.distances(&[source]),
                |i| p.distance(sheet.flat[i]),
            );
        }
    }
}

#[test]
fn a_cap_of_a_sphere_is_measured_along_great_circles() {
    let n = 60;
    for split in [Split::Same, Split::Alternating] {
        let sheet = Sheet::new(n, n, split, 0.1, 2, Vec2::ONE);
        let dome = |p: Vec2| {
            let p = (p / n as f32 - 0.5) * 2.0;
            let (sin, cos) = p.length().sin_cos();
            (p.normalize_or_zero() * sin).extend(cos)
        };
        // A disc around the pole is convex, the square is not.
        let inside = |p: Vec2, radius: f32| (p / n as f32 - 0.5).length() < radius;
        let sheet = sheet.keep(|p| inside(p, 0.5));
        let positions = sheet.positions(dome);
        let mesh = Geodesics::new(&positions, &sheet.triangles);
        for source in [30 * 61 + 30, 30 * 61 + 4, 17 * 61 + 17] {
            let found = mesh.distances(&[source]);
            let [low, high] = errors(&found, |i| {
                let chord = positions[source as usize].distance(positions[i]);
                let arc = 2.0 * (chord / 2.0).asin();
                if inside(sheet.flat[i], 0.45) {
                    arc
                } else {
                    0.0
                }
            });
            println!(
                "sphere {split:?}: {:.4} % to {:.4} %",
                100.0 * low,
                100.0 * high
            );
            // Flat images: the error is in proportion to the length of the edges.
            assert!(low > -0.003 && high < OVER, "{low} {high}");
        }
    }
}

#[test]
fn a_cone_bends_no_path_and_a_saddle_does() {
    // Sectors of 60° around one particle, 4 (a cone) or 8 of them (a saddle), each an equilateral fan.
    for (sectors, opposite) in [(4, 3.0f32.sqrt()), (8, 2.0)] {
        let ring = (0..sectors).map(|k| {
            let (sin, cos) = (2.0 * PI * k as f32 / sectors as f32).sin_cos();
            let radius = 0.5 / (PI / sectors as f32).sin();
            match sectors {
                4 => Vec3::new(cos, sin, 0.0) * radius,
                _ => {
                    let z = if k % 2 == 0 { 0.5 } else { -0.5 };
                    let out = 0.75f32.sqrt();
                    Vec3::new(cos * out, sin * out, z)
                }
            }
        });
        let apex = if sectors == 4 {
            Vec3::Z * 0.5f32.sqrt()
        } else {
            Vec3::ZERO
        };
        let positions: Vec<Vec3> = std::iter::once(apex).chain(ring).collect();
        let triangles: Vec<[u32; 3]> = (0..sectors)
            .map(|k| [0, k + 1, (k + 1) % sectors + 1])
            .collect();
        let mesh = Geodesics::new(&positions, &triangles);
        let found = mesh.distances(&[1])[1 + sectors as usize / 2];
        assert!((found / opposite - 1.0).abs() < 1e-3, "{sectors}: {found}");
    }
}

/// Cuts each triangle into four: the same surface.
fn subdivide(positions: &mut Vec<Vec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut smaller = Vec::new();
    for &[a, b, c] in triangles {
        let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                let middle = positions[i as usize].midpoint(positions[j as usize]);
                positions.push(middle);
                positions.len() as u32 - 1
            })
        });
        smaller.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
    }
    smaller
}

#[test]
fn smaller_triangles_of_the_same_surface_change_little() {
    for (seed, bulge, sources) in [
        (232, 3.0, vec![60, 500, 320]),
        (232, 2.0, vec![456]),
        (5, 4.0, vec![0]),
    ] {
        let sheet = Sheet::new(24, 24, Split::Random, 0.1, seed, Vec2::ONE)
            .keep(|p| p.distance(Vec2::new(9.0, 12.0)) > 4.0);
        let bulged = |p: Vec2| p.extend(bulge * (p.x * 0.3).sin() * (p.y * 0.2).cos());
        let mut positions = sheet.positions(bulged);
        let coarse = Geodesics::new(&positions, &sheet.triangles).distances(&sources);
        let mut triangles = sheet.triangles;
        for _ in 0..3 {
            triangles = subdivide(&mut positions, &triangles);
        }
        let fine = Geodesics::new(&positions, &triangles).distances(&sources);
        let [low, high] = errors(&coarse, |i| if fine[i].is_finite() { fine[i] } else { 0.0 });
        println!(
            "bulge {bulge}: {:.4} % to {:.4} %",
            100.0 * low,
            100.0 * high
        );
        assert!(low > -0.01 && high < 0.01, "{low} {high}");
    }
}
