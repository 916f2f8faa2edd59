//! Vectors between two steps, written into interleaved vertices: p (1 − f) + q f.

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{Factor, V3, Window, each_window};
use crate::{
    points::Points,
    vertices::{Interleaved, SheetVertices},
};

/// The vectors of the last two steps.
#[derive(Clone, Copy)]
pub(crate) struct Between<'a> {
    /// After the step before, and after the last one.
    pub ends: [&'a Points; 2],
    /// The part of the way, 0 to 1.
    pub fraction: f32,
    /// What is added.
    pub offsets: Option<&'a Points>,
    /// What is done to the sum.
    pub last: Last,
}

/// What is done to a vector before it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Last {
    /// Each coordinate by its factor.
    Scale(Vec3),
    /// Made as long as 1; where that cannot be, the vector after the last step is written.
    Unit,
}

impl Between<'_> {
    /// Several vectors side by side: those of a window, `first` further on.
    #[inline(always)]
    fn side_by_side<S: Simd>(&self, simd: S, window: Window, first: usize) -> V3<S> {
        let (late, early) = (
            Factor(S::f32s::splat(simd, self.fraction)),
            Factor(S::f32s::splat(simd, 1.0 - self.fraction)),
        );
        let end: V3<S> = self.ends[1].window(simd, window, first);
        let mut v = early * self.ends[0].window(simd, window, first) + late * end;
        if let Some(offsets) = self.offsets {
            v = v + offsets.window(simd, window, first);
        }
        match self.last {
            Last::Scale(factors) => {
                v.x *= factors.x;
                v.y *= factors.y;
                v.z *= factors.z;
                v
            }
            Last::Unit => {
                let inverse = one_over_length(simd, v);
                let known = inverse.simd_gt(S::f32s::splat(simd, 0.0));
                (Factor(inverse) * v).select(known, end)
            }
        }
    }

    fn one(&self, i: usize) -> Vec3 {
        let [from, to] = self.ends.map(|points| points.get(i));
        let mut v = from * (1.0 - self.fraction) + to * self.fraction;
        if let Some(offsets) = self.offsets {
            v += offsets.get(i);
        }
        match self.last {
            Last::Scale(factors) => v * factors,
            Last::Unit => v.normalize_or(to),
        }
    }
}

/// Writes the vectors from `first` on into vertices, as many as there are vertices.
///
/// # Panics
/// When there are more vertices than vectors.
pub(crate) fn interleave(level: Level, between: Between, first: usize, to: Interleaved) {
    dispatch!(level, simd => interleave_with(simd, between, first, to));
}

/// Writes the vectors with these numbers into vertices.
///
/// # Panics
/// When a number is not below that of the vectors.
pub(crate) fn interleave_listed(between: Between, list: &[u32], to: Interleaved) {
    for (vertex, &i) in to.words.chunks_exact_mut(to.stride).zip(list) {
        vertex[to.offset..to.offset + 3].copy_from_slice(&between.one(i as usize).to_array());
    }
}

/// Writes whole vertices of a sheet: those of the rows from `first_row` on, as many as there are. The tangent of a vertex points from its
/// left to its right neighbour, orthogonal to its normal.
///
/// # Panics
/// When there are more vertices than vectors.
pub(crate) fn interleave_sheet(
    level: Level,
    [positions, normals]: [Between; 2],
    first_row: usize,
    to: SheetVertices,
) {
    dispatch!(level, simd => interleave_sheet_with(simd, [positions, normals], first_row, to));
}

#[inline(always)]
fn interleave_sheet_with<S: Simd>(
    simd: S,
    [positions, normals]: [Between; 2],
    first_row: usize,
    to: SheetVertices,
) {
    let SheetVertices {
        words,
        stride,
        columns,
        places,
        handedness,
    } = to;
    for (row, vertices) in words.chunks_exact_mut(columns * stride).enumerate() {
        let start = (first_row + row) * columns;
        // The ends of the row one by one.
        for column in [0, columns - 1] {
            let [left, right] = [column.saturating_sub(1), (column + 1).min(columns - 1)];
            let along = positions.one(start + right) - positions.one(start + left);
            let normal = normals.one(start + column);
            let vertex = &mut vertices[column * stride..(column + 1) * stride];
            set(vertex, places[0], positions.one(start + column));
            set(vertex, places[1], normal);
            set(vertex, places[2], across(along, normal));
            vertex[places[2] + 3] = handedness;
        }
        if columns < 3 {
            continue;
        }
        let inner = &mut vertices[stride..(columns - 1) * stride];
        each_window(
            simd,
            0..columns - 2,
            #[inline(always)]
            |window| {
                let at = start + 1;
                let place = positions.side_by_side(simd, window, at);
                let normal = normals.side_by_side(simd, window, at);
                let left = positions.side_by_side(simd, window, at - 1);
                let along = positions.side_by_side(simd, window, at + 1) - left;
                let along = along - Factor(normal.dot(along)) * normal;
                let tangent = Factor(one_over_length(simd, along)) * along;
                let lanes = S::f32s::LEN.min(columns - 2 - window.at);
                let vertices = inner[window.at * stride..].chunks_exact_mut(stride);
                for (k, vertex) in vertices.take(lanes).enumerate() {
                    set(vertex, places[0], lane(place, k));
                    set(vertex, places[1], lane(normal, k));
                    let mut tangent = lane(tangent, k);
                    if tangent == Vec3::ZERO {
                        tangent = lane(normal, k).any_orthonormal_vector();
                    }
                    set(vertex, places[2], tangent);
                    vertex[places[2] + 3] = handedness;
                }
            },
        );
    }
}

/// 1/|v|; 0 where that is not finite.
#[inline(always)]
fn one_over_length<S: Simd>(simd: S, v: V3<S>) -> S::f32s {
    let one = S::f32s::splat(simd, 1.0);
    let zero = S::f32s::splat(simd, 0.0);
    let inverse = one / v.dot(v).sqrt();
    let finite = inverse.simd_gt(zero) & inverse.simd_lt(one / zero);
    finite.select(inverse, zero)
}

/// The direction of a vector across a unit normal.
fn across(v: Vec3, normal: Vec3) -> Vec3 {
    let v = (v - normal * normal.dot(v)).normalize_or_zero();
    if v == Vec3::ZERO {
        normal.any_orthonormal_vector()
    } else {
        v
    }
}

#[inline(always)]
fn set(vertex: &mut [f32], place: usize, v: Vec3) {
    let place = &mut vertex[place..place + 3];
    place[0] = v.x;
    place[1] = v.y;
    place[2] = v.z;
}

#[inline(always)]
fn lane<S: Simd>(v: V3<S>, k: usize) -> Vec3 {
    Vec3::new(v.x.as_slice()[k], v.y.as_slice()[k], v.z.as_slice()[k])
}

#[inline(always)]
fn interleave_with<S: Simd>(simd: S, between: Between, first: usize, to: Interleaved) {
    let Interleaved {
        words,
        stride,
        offset,
    } = to;
    let count = words.len() / stride;
    each_window(
        simd,
        0..count,
        #[inline(always)]
        |window| {
            let v = between.side_by_side(simd, window, first);
            let lanes = S::f32s::LEN.min(count - window.at);
            let vertices = words[window.at * stride..].chunks_exact_mut(stride);
            for (k, vertex) in vertices.take(lanes).enumerate() {
                set(vertex, offset, lane(v, k));
            }
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::kernels::lanes::levels;

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
}
