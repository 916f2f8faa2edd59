//! Sheets as triangle meshes that are no grids.

use bevy_math::{Vec2, Vec3};
use tailorbird_cloth::{prelude::*, tethers::ClothTethers};
use tailorbird_test::{Scene, Sheet, unit};

/// A sheet around the origin, columns along +x and rows along −y, whose inner vertices are moved by up to a quarter of a cell
/// each way and whose cells are cut along their shorter diagonals. Vertices of the first `still` rows are moved along x alone.
pub fn irregular(size: Vec2, [columns, rows]: [usize; 2], still: usize, seed: u64) -> Cloth {
    let cell = size / Vec2::new((columns - 1) as f32, (rows - 1) as f32);
    let moved = |i: usize, axis: u64| 0.25 * unit(i as u64 ^ (4 * seed + axis) << 40);
    let mut positions = Vec::with_capacity(columns * rows);
    for i in 0..columns * rows {
        let (row, column) = (i / columns, i % columns);
        let (mut x, mut y) = (column as f32, row as f32);
        if column > 0 && column + 1 < columns {
            x += moved(i, 1);
        }
        if row >= still.max(1) && row + 1 < rows {
            y += moved(i, 2);
        }
        positions.push(Vec3::new(
            x * cell.x - 0.5 * size.x,
            0.5 * size.y - y * cell.y,
            0.0,
        ));
    }
    let mut triangles = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let a = row * columns + column;
            let [a, b, c, d] = [a, a + columns, a + columns + 1, a + 1];
            let falling =
                positions[a].distance(positions[c]) <= positions[b].distance(positions[d]);
            triangles.extend(if falling {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [d, b, c]]
            });
        }
    }
    mesh(positions, &triangles)
}

/// A strip cut at 45° to the threads, upright, its upper end at y = 0: `length` by `width`, threads `spacing` apart.
pub fn bias_strip(length: f32, width: f32, spacing: f32) -> Cloth {
    let half = spacing * std::f32::consts::FRAC_1_SQRT_2;
    let (down, aside) = (
        (length / half).round() as i32,
        (0.5 * width / half).round() as i32,
    );
    // Vertex (k, s): k half diagonals down, s aside, of the same parity.
    let mut number = std::collections::HashMap::new();
    let mut positions = Vec::new();
    for k in 0..=down {
        for s in -aside..=aside {
            if (k + s) % 2 == 0 {
                number.insert((k, s), positions.len());
                positions.push(Vec3::new(s as f32 * half, -k as f32 * half, 0.0));
            }
        }
    }
    let mut triangles = Vec::new();
    for (&(k, s), &top) in &number {
        let at = |k, s| number.get(&(k, s)).copied();
        let (left, right, bottom) = (at(k + 1, s - 1), at(k + 1, s + 1), at(k + 2, s));
        match (left, right, bottom) {
            // The diagonals alternate.
            (Some(l), Some(r), Some(b)) if (k + s) % 4 == 0 => {
                triangles.extend([[top, l, r], [r, l, b]]);
            }
            (Some(l), Some(r), Some(b)) => triangles.extend([[top, l, b], [top, b, r]]),
            (Some(l), Some(r), None) => triangles.push([top, l, r]),
            (Some(l), None, Some(b)) => triangles.push([top, l, b]),
            (None, Some(r), Some(b)) => triangles.push([top, b, r]),
            _ => (),
        }
    }
    // At the upper end, halves of cells.
    for s in -aside..=aside {
        if let (Some(&l), Some(&r), Some(&b)) = (
            number.get(&(0, s)),
            number.get(&(0, s + 2)),
            number.get(&(1, s + 1)),
        ) {
            triangles.push([l, b, r]);
        }
    }
    triangles.sort_unstable();
    mesh(positions, &triangles)
}

fn mesh(positions: Vec<Vec3>, triangles: &[[usize; 3]]) -> Cloth {
    let indices: Vec<u32> = triangles.iter().flatten().map(|&i| i as u32).collect();
    Cloth::mesh(positions, indices)
}

#[test]
fn pins_that_change_on_a_large_mesh_cost_no_step_its_time() {
    let sheet = |pins: [u32; 2]| {
        Sheet::new(&Scene {
            cloth: Some(irregular(Vec2::ONE, [100, 100], 0, 5)),
            pins: ClothPins::particles(pins),
            ..Scene::default()
        })
    };
    let tethers = |sheet: &Sheet| {
        let tethers = sheet.get::<ClothTethers>();
        let pins: Vec<u32> = tethers.pins().collect();
        let lengths = (0..10_000)
            .flat_map(|i| tethers.lengths(i))
            .collect::<Vec<_>>();
        (pins, lengths)
    };
    let (before, after) = ([0, 99], [0, 9_999]);
    let run = || {
        let mut sheet = sheet(before);
        sheet.steps(3);
        let [old, _] = tethers(&sheet).0[..] else {
            panic!("two pins")
        };
        let mut kept = 0;
        sheet.change(|pins: &mut ClothPins| *pins = ClothPins::particles(after));
        // 20,000 ways, 4000 in a step.
        for step in 0..6 {
            sheet.step();
            let (pins, lengths) = tethers(&sheet);
            if step < 5 {
                assert_eq!(
                    (pins.as_slice(), lengths.len()),
                    (&[old][..], 10_000),
                    "step {step}"
                );
                kept += 1;
            }
        }
        assert_eq!(kept, 5);
        sheet
    };
    let mut changed = run();
    let mut made = sheet(after);
    made.step();
    assert_eq!(tethers(&changed), tethers(&made));
    changed.steps(20);
    let mut again = run();
    again.steps(20);
    assert_eq!(changed.hash(), again.hash());
}
