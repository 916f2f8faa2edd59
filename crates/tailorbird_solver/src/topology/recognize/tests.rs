use crate::properties::*;

use super::*;
use crate::{
    shape::ClothShape,
    topology::{
        Topology,
        test_meshes::{grid, hash, shuffle},
    },
};

fn detect(positions: &[Vec3], triangles: &[[u32; 3]]) -> Option<Recognized> {
    let edges = MeshEdges::new(positions.len(), triangles);
    Recognized::detect(positions, triangles, &edges, None)
}

proptest! {
    #[test]
    fn a_shuffled_grid_cut_at_random_is_put_back_in_order(
        columns in 2usize..20,
        rows in 2usize..20,
        width in 0.2f32..5.0,
        seed in 0u64..1_000_000,
    ) {
        let (positions, triangles) =
            grid(columns, rows, [width, 1.0], |c, r| hash(c + 1000 * r, seed).is_multiple_of(2));
        let (shuffled, triangles) = shuffle(&positions, &triangles, seed);
        let lattice = detect(&shuffled, &triangles);
        let Some(lattice) = lattice else {
            return Err(TestCaseError::fail("not recognised"));
        };
        prop_assert_eq!((lattice.columns, lattice.rows), (columns, rows));
        let back: Vec<Vec3> = lattice.order.iter().map(|i| shuffled[*i as usize]).collect();
        prop_assert_eq!(back, positions);
    }

    #[test]
    fn any_triangles_get_an_answer(
        corners in prop::collection::vec((0u32..12, 0u32..12, 0u32..12), 0..40),
        on_grid in prop::bool::ANY,
    ) {
        let positions: Vec<Vec3> = (0..12)
            .map(|i| if on_grid {
                Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0)
            } else {
                Vec3::splat(f32::NAN)
            })
            .collect();
        let triangles: Vec<[u32; 3]> = corners
            .into_iter()
            .map(|(a, b, c)| [a, b, c])
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        if let Some(lattice) = detect(&positions, &triangles) {
            prop_assert_eq!(lattice.columns * lattice.rows, positions.len());
            prop_assert_eq!(triangles.len(), 2 * (lattice.columns - 1) * (lattice.rows - 1));
        }
    }

    #[test]
    fn one_change_makes_it_no_grid(seed in 0u64..100_000, change in 0usize..6) {
        let (mut positions, mut triangles) = grid(6, 5, [0.1, 0.12], |c, r| (c + r).is_multiple_of(2));
        let t = hash(0, seed) as usize % triangles.len();
        match change {
            0 => { triangles.remove(t); }
            1 => triangles[t].swap(0, 1),
            2 => positions.push(Vec3::ONE),
            3 => positions[hash(1, seed) as usize % 30].x += 0.001,
            4 => {
                let [a, b, _] = triangles[t];
                positions.push(positions[a as usize] + Vec3::Z * 0.1);
                triangles.push([b, a, 30]);
            }
            _ => {
                let cell = t / 2 * 2;
                triangles.drain(cell..cell + 2);
            }
        }
        let (positions, triangles) = shuffle(&positions, &triangles, seed);
        prop_assert_eq!(detect(&positions, &triangles), None);
    }
}

#[test]
fn a_rolled_up_sheet_is_a_grid_and_a_closed_tube_is_none() {
    let (mut positions, mut triangles) = grid(12, 9, [1.0, 0.4], |c, _| c < 6);
    for p in &mut positions {
        let (sin, cos) = (p.x * std::f32::consts::TAU / 13.0).sin_cos();
        *p = Vec3::new(2.0 * sin, p.y, 2.0 * cos);
    }
    let (shuffled, cut) = shuffle(&positions, &triangles, 7);
    let lattice = detect(&shuffled, &cut).expect("a grid");
    assert_eq!((lattice.columns, lattice.rows), (12, 9));
    let back: Vec<Vec3> = lattice
        .order
        .iter()
        .map(|i| shuffled[*i as usize])
        .collect();
    assert_eq!(back, positions);

    for row in 0..9 {
        let (sin, cos) = (12.0 * std::f32::consts::TAU / 13.0).sin_cos();
        positions.push(Vec3::new(2.0 * sin, -0.4 * row as f32, 2.0 * cos));
    }
    let at = |column: u32, row: u32| match column {
        12 => 108 + row,
        13 => row * 12,
        _ => row * 12 + column,
    };
    for row in 0..8 {
        for column in 11..13 {
            let [a, b, c, d] = [
                at(column, row),
                at(column, row + 1),
                at(column + 1, row + 1),
                at(column + 1, row),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    assert_eq!(detect(&positions, &triangles), None);
}

#[test]
fn rows_follow_v() {
    let (positions, triangles) = grid(4, 3, [1.0, 1.0], |_, _| false);
    let edges = MeshEdges::new(positions.len(), &triangles);
    let with = |uv: fn(Vec3) -> Vec2| {
        let uvs: Vec<[Vec2; 3]> = triangles
            .iter()
            .map(|t| t.map(|i| uv(positions[i as usize])))
            .collect();
        Recognized::detect(&positions, &triangles, &edges, Some(&uvs))
    };
    let upright: Vec<u32> = (0..12).collect();
    assert_eq!(
        with(|p| Vec2::new(p.x, -p.y)).expect("a grid").order,
        upright
    );
    let constant = with(|_| Vec2::ZERO).expect("a grid");
    assert_eq!(constant.order, upright);
    let turned = with(|p| Vec2::new(p.y, p.x)).expect("a grid");
    assert_eq!((turned.columns, turned.rows), (3, 4));
    assert_eq!(turned.order[..4], [8, 4, 0, 9]);
    assert_eq!(with(|p| Vec2::new(p.x + p.y, p.x - p.y)), None);
}

/// With a seam of the texture, whose vertices are there twice, and a triangle that is turned around.
#[test]
fn a_shape_gives_rows_its_uvs() {
    let (positions, mut triangles) = grid(4, 3, [1.0, 1.0], |_, _| false);
    triangles[5].swap(0, 2);
    let seam = positions.len() as u32;
    let mut twice = positions.clone();
    twice.extend(&positions);
    for triangle in &mut triangles[6..] {
        *triangle = triangle.map(|i| i + seam);
    }
    let with = |uv: fn(Vec3) -> Vec2| {
        let uvs = twice.iter().enumerate();
        let shift = |i: usize| Vec2::splat(if i < positions.len() { 0.0 } else { 5.0 });
        let shape = ClothShape::Mesh {
            positions: twice.clone(),
            indices: triangles.as_flattened().to_vec(),
            uvs: uvs.map(|(i, p)| uv(*p) + shift(i)).collect(),
            weld_distance: 1e-5,
        };
        Topology::build(&shape, Vec3::ONE).expect("valid")
    };
    let size = |topology: &Topology| topology.lattice().map(|l| (l.columns, l.rows));
    let upright = with(|p| Vec2::new(p.x, -p.y));
    assert_eq!(size(&upright), Some((4, 3)));
    let turned = with(|p| Vec2::new(p.y, p.x));
    assert_eq!(size(&turned), Some((3, 4)));
    assert_eq!(turned.report.turned.count, 1);
    assert_eq!(size(&with(|_| Vec2::NAN)), Some((4, 3)));
    let askew = with(|p| Vec2::new(p.x + p.y, p.x - p.y));
    assert_eq!(size(&askew), None);
    assert_ne!(askew.revision, upright.revision);
}

#[test]
fn a_horizontal_sheet_has_its_rows_along_z() {
    let (positions, triangles) = grid(5, 3, [1.0, 2.0], |_, _| true);
    let flat: Vec<Vec3> = positions
        .iter()
        .map(|p| Vec3::new(p.x, 0.0, -p.y))
        .collect();
    let (shuffled, triangles) = shuffle(&flat, &triangles, 3);
    let lattice = detect(&shuffled, &triangles).expect("a grid");
    let back: Vec<Vec3> = lattice
        .order
        .iter()
        .map(|i| shuffled[*i as usize])
        .collect();
    assert_eq!(back, flat);
}

#[test]
fn sheared_and_equilateral_cells_are_no_grid() {
    let (mut positions, triangles) = grid(5, 5, [1.0, 1.0], |_, _| false);
    for p in &mut positions {
        p.x += 0.5 * p.y;
    }
    assert_eq!(detect(&positions, &triangles), None);
    for p in &mut positions {
        p.y *= 0.75f32.sqrt();
    }
    assert_eq!(detect(&positions, &triangles), None);
    assert_eq!(detect(&[], &[]), None);
}
