//! Vertices hold what they are to hold, whatever the instructions.

use bevy_math::Vec3;
use tailorbird_solver::{instruction_set::levels, points::Points};

use super::interleave::*;

#[test]
fn vectors_come_to_their_vertices_whatever_the_instructions() {
    let vector = |seed: f32| move |i: usize| Vec3::new(seed, 0.1 * i as f32, -(i as f32)).cos();
    let points = |seed: f32| (0..70).map(vector(seed)).collect::<Points>();
    let (mut from, mut to, offsets) = (points(0.1), points(0.9), points(2.0));
    from.set(5, Vec3::ZERO);
    to.set(5, Vec3::ZERO);
    for last in [Last::Unit, Last::Scale(Vec3::new(2.0, 1.0, 0.5))] {
        for offsets in [None, Some(&offsets)] {
            for fraction in [0.0, 0.3, 1.0] {
                let between = Between {
                    ends: [&from, &to],
                    fraction,
                    offsets,
                    last,
                };
                for (first, count) in [(0, 70), (3, 60), (0, 5), (64, 1)] {
                    let (stride, offset) = (7, 2);
                    let start = vec![9.0; count * stride];
                    let mut listed = start.clone();
                    let list: Vec<u32> = (first as u32..).take(count).collect();
                    let words = &mut listed;
                    let place = Interleaved {
                        words,
                        stride,
                        offset,
                    };
                    interleave_listed(between, &list, place);
                    for level in levels() {
                        let mut all = start.clone();
                        let words = &mut all;
                        let place = Interleaved {
                            words,
                            stride,
                            offset,
                        };
                        interleave(level, between, first, place);
                        for (k, (a, b)) in all.iter().zip(&listed).enumerate() {
                            let own = (2..5).contains(&(k % 7));
                            let right = if own { (a - b).abs() < 1e-6 } else { *a == 9.0 };
                            assert!(right, "{k}: {a} {b}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_sheet_gets_the_same_vertices_and_tangents_along_its_rows() {
    for (columns, rows) in [(2, 3), (3, 2), (8, 4), (19, 3), (40, 2)] {
        let n = columns * rows;
        let vector = |seed: f32| {
            move |i: usize| {
                let at = Vec3::new((i % columns) as f32, (i / columns) as f32, 0.0);
                at + 0.3 * Vec3::new(seed, 0.1 * i as f32, -(i as f32)).cos()
            }
        };
        let points = |seed: f32| (0..n).map(vector(seed)).collect::<Points>();
        let all = [points(0.1), points(0.9), points(2.0), points(3.0)];
        let positions = Between {
            ends: [&all[0], &all[1]],
            fraction: 0.4,
            offsets: None,
            last: Last::Scale(Vec3::splat(1.5)),
        };
        let normals = Between {
            ends: [&all[2], &all[3]],
            last: Last::Unit,
            ..positions
        };
        let stride = 12;
        for level in levels() {
            let mut words = vec![9.0; (n - columns) * stride];
            let vertices = SheetVertices {
                words: &mut words,
                stride,
                columns,
                places: [0, 3, 8],
                handedness: -1.0,
            };
            interleave_sheet(level, [positions, normals], 1, vertices);
            for (k, vertex) in words.chunks(stride).enumerate() {
                let (i, column) = (k + columns, k % columns);
                let at = |place: usize| Vec3::from_slice(&vertex[place..]);
                let [left, right] = [column.min(1), (columns - 1 - column).min(1)];
                let along = positions.one(i + right) - positions.one(i - left);
                let normal = normals.one(i);
                assert!(at(0).distance(positions.one(i)) < 1e-5);
                assert!(at(3).distance(normal) < 1e-5);
                assert!(at(8).distance(across(along, normal)) < 1e-4, "{k}");
                assert!((at(8).length() - 1.0).abs() < 1e-5);
                assert_eq!([vertex[6], vertex[7], vertex[11]], [9.0, 9.0, -1.0]);
            }
        }
    }
}
