use crate::properties::*;

use super::*;
use crate::topology::test_meshes::{delaunay, grid, hash, random, shuffle};

fn weave(positions: &[Vec3], triangles: &[[u32; 3]]) -> Weave {
    let edges = MeshEdges::new(positions.len(), triangles);
    Weave::new(positions, triangles, &edges, None)
}

fn count(weave: &Weave, family: EdgeFamily) -> usize {
    weave.family.iter().filter(|f| **f == family).count()
}

/// Family of an edge of a grid in the x-y plane.
fn expected(a: Vec3, b: Vec3) -> EdgeFamily {
    let d = (b - a).abs();
    match (d.x > 1e-4, d.y > 1e-4) {
        (false, _) => EdgeFamily::Warp,
        (_, false) => EdgeFamily::Weft,
        _ => EdgeFamily::Shear,
    }
}

proptest! {
    #[test]
    fn the_threads_of_a_grid_follow_its_edges(
        columns in 2usize..12,
        rows in 2usize..12,
        width in 0.1f32..10.0,
        seed in 0u64..1_000_000,
    ) {
        let (positions, triangles) =
            grid(columns, rows, [width, 1.0], |c, r| hash(c + 1000 * r, seed).is_multiple_of(2));
        let (positions, triangles) = shuffle(&positions, &triangles, seed);
        let weave = weave(&positions, &triangles);
        for (&[a, b], family) in weave.ends.iter().zip(&weave.family) {
            prop_assert_eq!(*family, expected(positions[a as usize], positions[b as usize]));
        }
        for warp in &weave.warp {
            prop_assert!(warp.dot(Vec3::Y).abs() > 0.9999);
        }
    }

    #[test]
    fn a_jittered_grid_keeps_its_families(seed in 0u64..1_000_000) {
        let (mut positions, triangles) =
            grid(12, 9, [1.0, 1.0], |c, r| hash(c + 1000 * r, seed).is_multiple_of(2));
        let regular = positions.clone();
        for (i, p) in positions.iter_mut().enumerate() {
            p.x += 0.15 * (random(2 * i, seed) - 0.5);
            p.y += 0.15 * (random(2 * i + 1, seed) - 0.5);
        }
        let weave = weave(&positions, &triangles);
        for (&[a, b], family) in weave.ends.iter().zip(&weave.family) {
            prop_assert_eq!(*family, expected(regular[a as usize], regular[b as usize]));
        }
    }

    #[test]
    fn any_triangles_get_threads(
        corners in prop::collection::vec((0u32..12, 0u32..12, 0u32..12), 0..40),
        seed in 0u64..1000,
    ) {
        let positions: Vec<Vec3> = (0..12)
            .map(|i| Vec3::new(random(3 * i, seed), random(3 * i + 1, seed), random(3 * i + 2, seed)))
            .collect();
        let triangles: Vec<[u32; 3]> = corners
            .into_iter()
            .map(|(a, b, c)| [a, b, c])
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        let weave = weave(&positions, &triangles);
        prop_assert_eq!(weave.family.len(), weave.ends.len());
        for (warp, t) in weave.warp.iter().zip(&triangles) {
            let [a, b, c] = t.map(|i| positions[i as usize]);
            prop_assert!((warp.length() - 1.0).abs() < 1e-3);
            prop_assert!(warp.dot((b - a).cross(c - a).normalize()).abs() < 1e-2);
        }
    }
}

#[test]
fn the_springs_of_a_family_hold_the_whole_membrane() {
    let (positions, triangles) = grid(5, 4, [0.5, 0.25], |_, _| false);
    let weave = weave(&positions, &triangles);
    let area = 4.0 * 3.0 * 0.125;
    let mut covered = [0.0; 3];
    for ((ends, family), scale) in weave.ends.iter().zip(&weave.family).zip(&weave.scale) {
        let [a, b] = ends.map(|i| positions[i as usize]);
        covered[*family as usize] += a.distance_squared(b) / scale;
    }
    for covered in covered {
        assert!((covered - area).abs() < 1e-5, "{covered}");
    }
}

#[test]
fn a_rolled_up_sheet_has_the_threads_of_the_flat_one() {
    let (flat, triangles) = grid(24, 9, [1.0, 1.0], |c, r| (c + r) % 2 == 0);
    let rolled: Vec<Vec3> = flat
        .iter()
        .map(|p| {
            let (sin, cos) = (p.x * 0.25).sin_cos();
            Vec3::new(4.0 * sin, p.y, 4.0 * cos)
        })
        .collect();
    let (flat, rolled) = (weave(&flat, &triangles), weave(&rolled, &triangles));
    assert_eq!(flat.family, rolled.family);
}

#[test]
fn threads_follow_the_texture() {
    let (positions, triangles) = grid(6, 6, [1.0, 1.0], |_, _| false);
    let edges = MeshEdges::new(positions.len(), &triangles);
    let with = |uv: fn(Vec3) -> Vec2| {
        let uvs: Vec<[Vec2; 3]> = triangles
            .iter()
            .map(|t| t.map(|i| uv(positions[i as usize])))
            .collect();
        Weave::new(&positions, &triangles, &edges, Some(&uvs))
    };
    let turned = with(|p| Vec2::new(p.y, p.x));
    for (ends, family) in turned.ends.iter().zip(&turned.family) {
        let [a, b] = ends.map(|i| positions[i as usize]);
        let other = match expected(a, b) {
            EdgeFamily::Warp => EdgeFamily::Weft,
            EdgeFamily::Weft => EdgeFamily::Warp,
            EdgeFamily::Shear => EdgeFamily::Shear,
        };
        assert_eq!(*family, other);
    }
    // On the bias the diagonals, which fall to the right, are the warp, and the former warp and weft are shear.
    let bias = with(|p| Vec2::new(p.x + p.y, p.x - p.y));
    assert_eq!(count(&bias, EdgeFamily::Warp), 25);
    assert_eq!(count(&bias, EdgeFamily::Shear), 60);
    let patchy = with(|p| {
        if p.x < 2.5 {
            Vec2::new(p.x, p.y)
        } else {
            Vec2::NAN
        }
    });
    assert_eq!(patchy.family, weave(&positions, &triangles).family);
}

#[test]
fn a_curved_mesh_of_quads_has_its_threads_along_their_sides() {
    let n = 24;
    let (mut positions, triangles) = grid(n, n, [1.0, 1.0], |c, r| {
        hash(c + 99 * r, 5).is_multiple_of(2)
    });
    let half = (n - 1) as f32 / 2.0;
    for p in &mut positions {
        let (x, y) = (p.x / half - 1.0, p.y / half + 1.0);
        *p = Vec3::new(x, y, 1.0).normalize();
    }
    let (flat, _) = grid(n, n, [1.0, 1.0], |_, _| false);
    let weave = weave(&positions, &triangles);
    let wrong = weave
        .ends
        .iter()
        .zip(&weave.family)
        .filter(|([a, b], family)| **family != expected(flat[*a as usize], flat[*b as usize]))
        .count();
    assert!(wrong * 50 < weave.ends.len(), "{wrong}");
}

#[test]
fn an_irregular_square_has_its_threads_along_its_borders() {
    let (positions, triangles) = delaunay(24, 3);
    let area: f32 = triangles
        .iter()
        .map(|t| t.map(|i| positions[i as usize]))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z)
        .sum();
    assert!((area - 1.0).abs() < 1e-3, "{area}");
    let weave = weave(&positions, &triangles);
    for warp in &weave.warp {
        assert!(warp.y.abs() > 0.99);
    }
    for family in [EdgeFamily::Warp, EdgeFamily::Weft, EdgeFamily::Shear] {
        let part = count(&weave, family) as f32 / weave.ends.len() as f32;
        assert!((0.25..0.45).contains(&part), "{family:?} {part}");
    }
}
